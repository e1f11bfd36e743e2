// SPDX-License-Identifier: Apache-2.0
/// learned: clusters of lights in proportion to what shadow rays have told of them.
///
///   pilot paths ─▶ regions (cell_grid.h) ─▶ for each, clusters: a cut of the light tree
///     ─▶ shadow rays to lights of each cluster c: y, what arrives relative to C_c, without shadows
///   x ─▶ region of x ─▶ P(l | x) = s_c C_c(x) / Σ s C(x) · P_tree(l | x, c),   s_c = √E[y²]
///
/// After Vévoda, Kondapaneni and Křivánek 2018, whose regression is that of region_study.h. The
/// paper learns from the rays of the render itself, and refines regions as it goes on; here rays
/// are traced before, so that an image does not depend on the order of its samples. C is that of
/// light_cut.h. Lights at infinity share n∞ / (n∞ + 1) of the draws, as in `bvh`.
#include "plugins/light_samplers/cell_points.h"
#include "plugins/light_samplers/light_groups.h"
#include "plugins/light_samplers/pilot_paths.h"
#include "plugins/light_samplers/point_memory.h"
#include "plugins/light_samplers/region_study.h"

#include <numeric>

namespace lucerna {

namespace {

/// Weights of the clusters at a point.
struct ClusterWeights {
    const LightRegion* region = nullptr;
    std::vector<float> weights;
    float total = 0;
};

class LearnedLightSampler final : public LightSampler {
public:
    explicit LearnedLightSampler(const Params& params);

    void prepare(const Scene& scene) override;
    std::uint32_t draws() const override {
        return tree_.empty() && groups_.infinite() == 0 ? 0 : draws_;
    }
    std::optional<LightChoice> sample(const Receiver& at, std::uint32_t draw,
                                      float u) const override;
    float pmf(const Receiver& at, std::uint32_t light) const override;
    std::size_t bytes() const override {
        std::size_t sum = tree_.bytes() + grid_.bytes();
        for (const LightRegion& r : regions_) {
            sum += sizeof(r) + r.clusters.capacity() * sizeof(std::uint32_t) +
                   r.strengths.capacity() * sizeof(float);
        }
        return sum;
    }

private:
    const ClusterWeights& weights(const Receiver& at) const;
    /// Draws at each point that go to lights at infinity.
    float infinite_share() const {
        const auto n = static_cast<float>(groups_.infinite());
        return n / (n + (tree_.empty() ? 0.0f : 1.0f));
    }
    float infinite_draws() const { return static_cast<float>(draws_) * infinite_share(); }
    /// Expected draws below a cluster.
    float scale_of(const ClusterWeights& shares, std::size_t cluster) const {
        return static_cast<float>(draws_) * (1 - infinite_share()) *
               (shares.weights[cluster] / shares.total);
    }
    LightBVH::Children children(std::uint32_t node, const Receiver& at) const {
        return children_by_contribution(tree_, node, at);
    }

    std::uint32_t draws_;
    std::size_t clusters_;
    int rays_;
    float cell_size_;
    PilotPaths pilots_;
    LightBVH tree_;
    LightGroups groups_;
    CellGrid grid_;
    std::vector<LightRegion> regions_;
    LightRegion everywhere_;  ///< where nothing is learnt
    PointMemory<ClusterWeights> memory_;
};

LearnedLightSampler::LearnedLightSampler(const Params& params) {
    draws_ = static_cast<std::uint32_t>(
        params.int32("light_samples", 1, {.min = 1, .max = 1024}, "lights chosen at each point"));
    clusters_ = static_cast<std::size_t>(
        params.int32("clusters", 64, {.min = 1, .max = 4096}, "of lights that a region knows"));
    rays_ = params.int32("rays_per_cluster", 4, {.min = 0, .max = 1024},
                         "shadow rays that a region learns from, for each of those");
    cell_size_ = params.real("cell_size", 1.0 / 32, {.min = 1e-4, .max = 100},
                             "edge of a region, relative to its distance to the camera");
    pilots_.count = static_cast<std::uint32_t>(
        params.int32("paths", 1 << 16, {.min = 1, .max = 1 << 24},
                     "most paths from the camera that find regions; one for two pixels"));
    pilots_.bounces =
        params.int32("bounces", 2, {.min = 0, .max = 16}, "after which those paths end");
}

void LearnedLightSampler::prepare(const Scene& scene) {
    groups_ = LightGroups(scene);
    tree_ = LightBVH(scene);
    memory_.clear();
    everywhere_ = {};
    if (!tree_.empty()) everywhere_ = {{0}, {1}};
    regions_.clear();
    grid_ = {};
    if (tree_.size() <= 1 || scene.integrator().light_bounces() < 0) return;
    const Workers workers(scene.threads());
    const std::vector<Receiver> points = pilot_receivers(scene, pilots_.within(scene), workers);
    grid_ = CellGrid(eye_of(scene), scene.bounds(), cell_size_);
    const CellPoints cells(grid_, points, 1);
    grid_.index(cells.keys);
    regions_.resize(cells.keys.size());
    workers.run(static_cast<std::int64_t>(regions_.size()), [&](std::int64_t index) {
        const auto i = static_cast<std::size_t>(index);
        const RegionStudy study(scene, tree_, cells.inside(points, i));
        regions_[i] = study.learn(clusters_, rays_, cells.keys[i]);
    });
}

const ClusterWeights& LearnedLightSampler::weights(const Receiver& at) const {
    return memory_.at(at, [&](const Receiver& place, ClusterWeights& result) {
        const std::uint32_t found = grid_.find(grid_.key(place.p, place));
        result.region = found == CellGrid::none ? &everywhere_ : &regions_[found];
        result.weights.clear();
        for (std::size_t i = 0; i < result.region->clusters.size(); ++i) {
            result.weights.push_back(result.region->strengths[i] *
                                     contribution(tree_, result.region->clusters[i], place));
        }
        result.total = std::accumulate(result.weights.begin(), result.weights.end(), 0.0f);
    });
}

std::optional<LightChoice> LearnedLightSampler::sample(const Receiver& at, std::uint32_t draw,
                                                       float u) const {
    double place = fine_number(at, draw, draws_, u);
    const auto infinite = static_cast<double>(infinite_share());
    if (place < infinite) {
        const auto count = static_cast<double>(groups_.infinite());
        return groups_.draw_infinite(place * (count / infinite), infinite_draws());
    }
    const ClusterWeights& shares = weights(at);
    if (!(shares.total > 0)) return {};
    place = (place - infinite) / (1 - infinite) * static_cast<double>(shares.total);
    double before = 0;
    std::size_t chosen = shares.weights.size();
    for (std::size_t i = 0; i < shares.weights.size(); ++i) {
        if (!(shares.weights[i] > 0)) continue;
        if (chosen != shares.weights.size()) {
            const double end = before + static_cast<double>(shares.weights[chosen]);
            if (place < end) break;
            before = end;
        }
        chosen = i;
    }
    const double rest = (place - before) / static_cast<double>(shares.weights[chosen]);
    return tree_.descend(shares.region->clusters[chosen], std::clamp(rest, 0.0, 1 - 0x1p-53),
                         scale_of(shares, chosen),
                         [&](std::uint32_t node) { return children(node, at); });
}

float LearnedLightSampler::pmf(const Receiver& at, std::uint32_t light) const {
    if (groups_.at_infinity(light)) {
        return groups_.infinite_pmf(light, infinite_draws());
    }
    if (!tree_.holds(light)) return 0;
    const ClusterWeights& shares = weights(at);
    if (!(shares.total > 0)) return 0;
    const std::vector<std::uint32_t>& clusters = shares.region->clusters;
    const auto scale = [&](std::uint32_t node) {
        const auto found = std::lower_bound(clusters.begin(), clusters.end(), node);
        if (found == clusters.end() || *found != node) return 0.0f;
        return scale_of(shares, static_cast<std::size_t>(found - clusters.begin()));
    };
    return tree_.pmf_of_descent(light, scale,
                                [&](std::uint32_t node) { return children(node, at); });
}

}  // namespace

const PluginInfo plugin = describe<LearnedLightSampler>(
    "clusters of lights, weighed by what shadow rays of the region have told of them");

}  // namespace lucerna
