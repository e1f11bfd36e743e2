// SPDX-License-Identifier: Apache-2.0
/// bvh: a light down a binary tree, at each node in proportion to a bound of what the children
/// contribute.
///
/// The light tree of pbrt (4e, 12.6.3), after Conty Estevez and Kulla 2018: the state of practice,
/// and the baseline of other samplers. For a cluster of power Φ, box centre c and normal cone θo,
/// seen from x with normal n along ω at distance d, where θb is the angle that the sphere around
/// the box subtends,
///
///   I = Φ cos θ' |cos θi'| / max(d², r),   θ' = max(0, θω − θo − θb),   θi' = max(0, θi − θb)
///
/// and 0 if θ' exceeds the angle of emission; r is the radius of that sphere, a length, so that
/// probabilities depend on the unit. Lights at infinity share n∞ / (n∞ + 1) of the draws. Bounds
/// are rounded as pbrt's are (compact_bounds.h). Other than in pbrt, trees may be 64 deep, and a
/// cosine is at least 10⁻⁵, so that rounding makes no light impossible.
#include "core/interfaces/light_sampler.h"
#include "core/scene/scene.h"
#include "plugins/light_samplers/compact_bounds.h"
#include "plugins/light_samplers/fine_bits.h"
#include "plugins/light_samplers/light_groups.h"
#include "plugins/light_samplers/light_tree.h"

namespace lucerna {

namespace {

class BVHLightSampler final : public LightSampler {
public:
    explicit BVHLightSampler(const Params& params)
        : draws_(static_cast<std::uint32_t>(params.int32(
              "light_samples", 1, {.min = 1, .max = 1024}, "lights chosen at each point"))) {}

    void prepare(const Scene& scene) override;
    std::uint32_t draws() const override {
        return tree_.empty() && groups_.infinite() == 0 ? 0 : draws_;
    }
    std::optional<LightChoice> sample(const Receiver& at, std::uint32_t draw,
                                      float u) const override;
    float pmf(const Receiver& at, std::uint32_t light) const override;
    std::size_t bytes() const override {
        return tree_.size() * sizeof(Node) + paths_.capacity() * sizeof(std::uint64_t);
    }

private:
    static constexpr std::uint64_t no_path = ~std::uint64_t{0};

    /// A node of the tree, in the order of LightTree.
    struct Node {
        explicit Node(const LightTree::Node& node, const Bounds3& all);

        Vector3 center{0};
        float radius = 0;
        Vector3 axis{0};
        float cos_normals = 1, sin_normals = 0, cos_emission = 0, power = 0;
        std::uint32_t link = 0;  ///< the second child; of a leaf, the light
        bool leaf = false, two_sided = false;
    };

    float importance(const Node& node, const Receiver& at) const;

    /// Draws at each point that go to lights at infinity.
    float infinite_share() const {
        const auto n = static_cast<float>(groups_.infinite());
        return n / (n + (tree_.empty() ? 0.0f : 1.0f));
    }

    std::uint32_t draws_;
    std::vector<Node> tree_;
    float least_distance2_ = 1e-37f;  ///< of a point to a light
    LightGroups groups_;
    std::vector<std::uint64_t> paths_;  ///< of each light of the scene
};

BVHLightSampler::Node::Node(const LightTree::Node& node, const Bounds3& all)
    : link(node.link), leaf(node.leaf), two_sided(node.cluster.two_sided) {
    const LightCluster cluster = compact(node.cluster, all);
    center = cluster.box.center();
    radius = cluster.box.radius();
    axis = cluster.axis;
    cos_normals = cluster.cos_normals;
    sin_normals = safe_sqrt(1 - sqr(cos_normals));
    cos_emission = cluster.cos_emission;
    power = cluster.power;
}

/// pbrt counts a spot as if it shone in all directions as it does along its axis.
float pbrt_power(const Light& light, const LightBounds& bounds) {
    double power = bounds.power;
    if (light.emitter->delta()) {
        const double beam = std::acos(static_cast<double>(bounds.cos_normals));
        const double edge = std::acos(static_cast<double>(bounds.cos_emission));
        const double cutoff = bounds.cos_normals > -1 ? beam + 0.5 * edge : std::numbers::pi;
        power *= 1 / std::max(sqr(std::sin(0.5 * cutoff)), 1e-12);
    }
    return static_cast<float>(power);
}

void BVHLightSampler::prepare(const Scene& scene) {
    std::vector<TreeLight> lights;
    paths_.assign(scene.lights().size(), no_path);
    groups_ = LightGroups(scene);
    double largest = 0;
    for (const Light& light : scene.lights()) {
        if (!light.emitter->infinite()) {
            largest = std::max(largest, light.emitter->bounds(light).power);
        }
    }
    for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
        const Light& light = scene.lights()[i];
        LightBounds bounds = light.emitter->bounds(light);
        if (!(bounds.power > 0) || light.emitter->infinite()) continue;
        bounds.power = std::max(bounds.power / largest, 1e-30);
        lights.push_back({.cluster = {.box = bounds.box,
                                      .axis = bounds.axis,
                                      .cos_normals = std::max(bounds.cos_normals, -1.0f),
                                      .cos_emission = bounds.cos_emission - 1e-5f,
                                      .power = pbrt_power(light, bounds),
                                      .two_sided = bounds.two_sided},
                          .light = i});
    }
    const LightTree tree(std::move(lights), Workers(scene.threads()));
    tree_.clear();
    tree_.reserve(tree.size());
    for (std::uint32_t i = 0; i < tree.size(); ++i)
        tree_.emplace_back(tree[i], tree[0].cluster.box);
    const float size = tree_.empty() ? 0.0f : tree_[0].radius;
    least_distance2_ = std::max(sqr(1e-7f * size), 1e-37f);
    tree.for_each_path([&](std::uint32_t light, std::uint64_t path) { paths_[light] = path; });
}

/// cos and sin of max(0, a − b).
float cos_of_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
    return cos_a > cos_b ? 1.0f : cos_a * cos_b + sin_a * sin_b;
}
float sin_of_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
    return cos_a > cos_b ? 0.0f : sin_a * cos_b - cos_a * sin_b;
}

float BVHLightSampler::importance(const Node& node, const Receiver& at) const {
    const Vector3 d = at.p - node.center;
    const float distance2 = glm::dot(d, d);
    const float radius = node.radius + 4 * at.error;
    const Vector3 w = distance2 > 0 ? d / std::sqrt(distance2) : node.axis;
    const bool inside = distance2 <= sqr(radius);
    const float cos_b = inside ? -1.0f : safe_sqrt(1 - sqr(radius) / distance2);
    const float sin_b = inside ? 0.0f : radius / std::sqrt(distance2);

    float cos_w = std::clamp(glm::dot(node.axis, w), -1.0f, 1.0f);
    if (node.two_sided) cos_w = std::abs(cos_w);
    const float sin_w = safe_sqrt(1 - sqr(cos_w));
    const float cos_x = cos_of_difference(sin_w, cos_w, node.sin_normals, node.cos_normals);
    const float sin_x = sin_of_difference(sin_w, cos_w, node.sin_normals, node.cos_normals);
    const float cos_emitted = inside ? 1.0f : cos_of_difference(sin_x, cos_x, sin_b, cos_b);
    if (cos_emitted <= node.cos_emission) return 0;

    const float cos_i = std::min(std::abs(glm::dot(w, at.ns)), 1.0f);
    const float cos_incident =
        inside || !at.has_normal()
            ? 1.0f
            : cos_of_difference(safe_sqrt(1 - sqr(cos_i)), cos_i, sin_b, cos_b);
    // Grazing light is weak, but rounding must not make it impossible.
    return node.power * std::max(cos_emitted, 1e-5f) * std::max(cos_incident, 1e-5f) /
           std::max({distance2, node.radius, least_distance2_});
}

std::optional<LightChoice> BVHLightSampler::sample(const Receiver& at, std::uint32_t draw,
                                                   float u) const {
    double place = fine_number(at, draw, draws_, u);
    const auto scale = static_cast<float>(draws_);
    const float infinite = infinite_share();
    if (place < static_cast<double>(infinite)) {
        const auto count = static_cast<double>(groups_.infinite());
        place *= count / static_cast<double>(infinite);
        const double group = std::min(std::floor(place), count - 1);
        LightChoice choice = groups_.draw(static_cast<std::size_t>(group), place - group);
        choice.pmf *= scale * infinite / static_cast<float>(count);
        return choice;
    }
    if (tree_.empty()) return {};
    place = (place - static_cast<double>(infinite)) / (1 - static_cast<double>(infinite));
    float pmf = scale * (1 - infinite);
    std::uint32_t node = 0;
    while (!tree_[node].leaf) {
        const float first = importance(tree_[node + 1], at);
        const float second = importance(tree_[tree_[node].link], at);
        if (!(first + second > 0)) return {};
        const float p = first / (first + second);
        const bool take_second = !(place < static_cast<double>(p));
        if (take_second) {
            const float q = second / (first + second);
            if (!(q > 0)) return {};
            place = (place - static_cast<double>(p)) / (1 - static_cast<double>(p));
            pmf *= q;
            node = tree_[node].link;
        } else {
            place /= static_cast<double>(p);
            pmf *= p;
            node = node + 1;
        }
        place = std::min(place, 1 - 0x1p-53);
    }
    if (node == 0 && !(importance(tree_[0], at) > 0)) return {};
    return LightChoice{tree_[node].link, pmf};
}

float BVHLightSampler::pmf(const Receiver& at, std::uint32_t light) const {
    const auto scale = static_cast<float>(draws_);
    const float infinite = infinite_share();
    if (groups_.at_infinity(light)) {
        return scale * infinite / static_cast<float>(groups_.infinite()) * groups_.pmf(light);
    }
    std::uint64_t path = paths_[light];
    if (path == no_path) return 0;
    float pmf = scale * (1 - infinite);
    std::uint32_t node = 0;
    while (!tree_[node].leaf) {
        const float first = importance(tree_[node + 1], at);
        const float second = importance(tree_[tree_[node].link], at);
        if (!(first + second > 0)) return 0;
        const bool take_second = path & 1;
        pmf *= (take_second ? second : first) / (first + second);
        node = take_second ? tree_[node].link : node + 1;
        path >>= 1;
    }
    if (node == 0 && !(importance(tree_[0], at) > 0)) return 0;
    return pmf;
}

}  // namespace

const PluginInfo plugin =
    describe<BVHLightSampler>("descends a light tree by bounds of the contribution");

}  // namespace lucerna
