// SPDX-License-Identifier: Apache-2.0
/// A binary light tree whose nodes have an importance at a point: a bound of what their lights
/// contribute there.
///
/// For a cluster of power Φ, box centre c and normal cone θo, seen from x with normal n along ω at
/// distance d, where θb is the angle that the sphere around the box subtends (Conty Estevez and
/// Kulla 2018, section 4.3; pbrt 4e, 12.6.3),
///
///   I = Φ cos θ' |cos θi'| / d²,   θ' = max(0, θω − θo − θb),   θi' = max(0, θi − θb)
///
/// and 0 if θ' exceeds the angle of emission. As in pbrt, d² is no less than the radius r of that
/// sphere, so that probabilities depend on the unit of length. A cosine is at least 10⁻⁵, so that
/// rounding makes no light impossible.
#pragma once

#include "core/interfaces/light_sampler.h"
#include "core/scene/scene.h"
#include "plugins/light_samplers/lights/compact_bounds.h"
#include "plugins/light_samplers/lights/light_tree.h"

namespace lucerna {

class LightBVH {
public:
    /// A node, in the order of LightTree: the first child is the next node.
    struct Node {
        Vector3 center{0};
        float radius = 0;
        Vector3 axis{0};
        float cos_normals = 1, sin_normals = 0, cos_emission = 0, power = 0;
        std::uint32_t link = 0;  ///< the second child; of a leaf, the light
        bool leaf = false, two_sided = false;
    };

    LightBVH() = default;
    explicit LightBVH(const Scene& scene);
    /// Over lights whose indices in the scene are below `light_count`.
    LightBVH(std::vector<TreeLight> lights, std::size_t light_count, const Workers& workers);

    bool empty() const { return nodes_.empty(); }
    std::uint32_t size() const { return static_cast<std::uint32_t>(nodes_.size()); }
    const Node& operator[](std::uint32_t i) const { return nodes_[i]; }
    std::size_t bytes() const {
        return nodes_.size() * sizeof(Node) + paths_.capacity() * sizeof(std::uint64_t);
    }
    bool holds(std::uint32_t light) const { return paths_[light] != no_path; }
    /// False if no light can reach the point. The root is weighed only if it is a light: others
    /// are found dark on the way.
    bool reaches(const Receiver& at) const {
        return !empty() && (!nodes_[0].leaf || importance(nodes_[0], at) > 0);
    }

    /// Draws a light; u in [0, 1). `pmf` of the result begins with `scale`.
    std::optional<LightChoice> sample(const Receiver& at, double u, float scale) const {
        return descend(0, u, scale, [&](std::uint32_t node) { return children(node, at); });
    }
    /// The number that `sample` reports for a light.
    float pmf(const Receiver& at, std::uint32_t light, float scale) const {
        return pmf_of_descent(
            light, [&](std::uint32_t) { return scale; },
            [&](std::uint32_t node) { return children(node, at); });
    }

    /// What a point can get from the lights below a node, before it is divided by a distance.
    struct View {
        float power = 0;      ///< Φ cos θ' |cos θi'|; zero: no light can reach the point
        float distance2 = 0;  ///< to the centre, squared, never zero
    };
    View view(const Node& node, const Receiver& at) const;

    /// The probabilities with which a walk down the tree takes the children of a node.
    struct Children {
        float first = 0, second = 0;  ///< both zero: no light below can reach the point

        static Children in_proportion(float first, float second) {
            const float sum = first + second;
            return sum > 0 ? Children{first / sum, second / sum} : Children{};
        }
    };
    /// As `sample`, for a walk that begins at a node and takes children as `children(node)` says.
    template <typename Choose>
    std::optional<LightChoice> descend(std::uint32_t node, double u, float scale,
                                       const Choose& children) const;
    /// The number that `descend` reports for a light of the tree, from the first node on the way to
    /// it for which `scale(node)` is not zero; zero if there is none.
    template <typename Scale, typename Choose>
    float pmf_of_descent(std::uint32_t light, const Scale& scale, const Choose& children) const;

private:
    static constexpr std::uint64_t no_path = ~std::uint64_t{0};

    float importance(const Node& node, const Receiver& at) const {
        const View seen = view(node, at);
        return seen.power / std::max(seen.distance2, node.radius);
    }
    Children children(std::uint32_t node, const Receiver& at) const {
        return Children::in_proportion(importance(nodes_[node + 1], at),
                                       importance(nodes_[nodes_[node].link], at));
    }

    static Node make_node(const LightTree::Node& node, const LightCluster& cluster);

    std::vector<Node> nodes_;
    float least_distance2_ = 1e-37f;  ///< at which a node is weighed
    /// From the root to each light of the scene, a bit a level: 1 is the second child.
    std::vector<std::uint64_t> paths_;
};

inline LightBVH::Node LightBVH::make_node(const LightTree::Node& node,
                                          const LightCluster& cluster) {
    return {.center = cluster.box.center(),
            .radius = cluster.box.radius(),
            .axis = cluster.axis,
            .cos_normals = cluster.cos_normals,
            .sin_normals = safe_sqrt(1 - sqr(cluster.cos_normals)),
            .cos_emission = cluster.cos_emission,
            .power = cluster.power,
            .link = node.link,
            .leaf = node.leaf,
            .two_sided = cluster.two_sided};
}

/// pbrt counts a spot as if it shone in all directions as it does along its axis.
inline float pbrt_power(const Light& light, const LightBounds& bounds) {
    double power = bounds.power;
    if (light.emitter->delta()) {
        const double beam = std::acos(static_cast<double>(bounds.cos_normals));
        const double edge = std::acos(static_cast<double>(bounds.cos_emission));
        const double cutoff = bounds.cos_normals > -1 ? beam + 0.5 * edge : std::numbers::pi;
        power *= 1 / std::max(sqr(std::sin(0.5 * cutoff)), 1e-12);
    }
    return static_cast<float>(power);
}

/// The lights of a scene that are somewhere; powers are relative to the largest.
inline std::vector<TreeLight> lights_by_power(const Scene& scene) {
    std::vector<TreeLight> lights;
    double largest = 0;
    for (const Light& light : scene.lights()) {
        if (light.emitter->infinite()) continue;
        largest = std::max(largest, light.emitter->bounds(light).power);
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
    return lights;
}

inline LightBVH::LightBVH(const Scene& scene)
    : LightBVH(lights_by_power(scene), scene.lights().size(), Workers(scene.threads())) {}

inline LightBVH::LightBVH(std::vector<TreeLight> lights, std::size_t light_count,
                          const Workers& workers)
    : paths_(light_count, no_path) {
    const LightTree tree(std::move(lights), workers, pbrt_rules);
    nodes_.reserve(tree.size());
    for (std::uint32_t i = 0; i < tree.size(); ++i) {
        const LightCluster& cluster = tree[i].cluster;
        nodes_.push_back(make_node(tree[i], compact(cluster, tree[0].cluster.box)));
    }
    const float size = nodes_.empty() ? 0.0f : nodes_[0].radius;
    least_distance2_ = std::max(sqr(1e-7f * size), 1e-37f);
    std::vector<std::pair<std::uint64_t, int>> ways(tree.size());  // to each node: path and depth
    for (std::uint32_t i = 0; i < tree.size(); ++i) {
        const auto [path, depth] = ways[i];
        if (tree[i].leaf) {
            paths_[tree[i].link] = path;
        } else {
            ways[i + 1] = {path, depth + 1};
            ways[tree[i].link] = {path | std::uint64_t{1} << depth, depth + 1};
        }
    }
}

/// cos and sin of max(0, a − b).
inline float cos_of_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
    return cos_a > cos_b ? 1.0f : cos_a * cos_b + sin_a * sin_b;
}
inline float sin_of_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
    return cos_a > cos_b ? 0.0f : sin_a * cos_b - cos_a * sin_b;
}

inline LightBVH::View LightBVH::view(const Node& node, const Receiver& at) const {
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
    View seen{.distance2 = std::max(distance2, least_distance2_)};
    if (cos_emitted <= node.cos_emission) return seen;

    const float cos_i = std::min(std::abs(glm::dot(w, at.ns)), 1.0f);
    const float cos_incident =
        inside || !at.has_normal()
            ? 1.0f
            : cos_of_difference(safe_sqrt(1 - sqr(cos_i)), cos_i, sin_b, cos_b);
    // Grazing light is weak, but rounding must not make it impossible.
    seen.power = node.power * std::max(cos_emitted, 1e-5f) * std::max(cos_incident, 1e-5f);
    return seen;
}

template <typename Choose>
std::optional<LightChoice> LightBVH::descend(std::uint32_t node, double u, float scale,
                                             const Choose& children) const {
    float pmf = scale;
    while (!nodes_[node].leaf) {
        const Children p = children(node);
        const auto first = static_cast<double>(p.first);
        const bool second = !(u < first);
        if (second && !(p.second > 0)) return {};
        u = second ? (u - first) / (1 - first) : u / first;
        u = std::min(u, 1 - 0x1p-53);
        pmf *= second ? p.second : p.first;
        node = second ? nodes_[node].link : node + 1;
    }
    return LightChoice{nodes_[node].link, pmf};
}

template <typename Scale, typename Choose>
float LightBVH::pmf_of_descent(std::uint32_t light, const Scale& scale,
                               const Choose& children) const {
    std::uint64_t path = paths_[light];
    std::uint32_t node = 0;
    const auto child = [&](bool second) { return second ? nodes_[node].link : node + 1; };
    float pmf = scale(node);
    for (; pmf == 0 && !nodes_[node].leaf; path >>= 1) {
        node = child(path & 1);
        pmf = scale(node);
    }
    for (; !nodes_[node].leaf; path >>= 1) {
        const Children p = children(node);
        const bool second = path & 1;
        pmf *= second ? p.second : p.first;
        node = child(second);
    }
    return pmf;
}

}  // namespace lucerna
