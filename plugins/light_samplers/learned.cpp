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
#include "plugins/light_samplers/learning/pilot_paths.h"
#include "plugins/light_samplers/learning/region_study.h"
#include "plugins/light_samplers/lights/infinite_share.h"
#include "plugins/light_samplers/lights/light_groups.h"
#include "plugins/light_samplers/memory/cell_points.h"

namespace lucerna {

namespace {

class LearnedLightSampler final : public LightSampler {
public:
    explicit LearnedLightSampler(const Params& params);

    void prepare(const Scene& scene) override;

    struct Distribution {
        std::optional<LightChoice> sample(double u) const;
        float pmf(std::uint32_t light) const;
        /// Probability of all lights below a cluster.
        float share(std::size_t cluster) const {
            return (1 - sampler->infinite_share_) * (weights[cluster] / total);
        }

        const LearnedLightSampler* sampler;
        Receiver receiver;
        const LightRegion* region;
        float total;
        float weights[most_cut_nodes];  ///< of the clusters of the region
    };
    Distribution at(const Receiver& receiver) const;

    std::size_t bytes() const override {
        std::size_t sum = tree_.bytes() + grid_.bytes();
        for (const LightRegion& r : regions_) {
            sum += sizeof(r) + r.clusters.capacity() * sizeof(std::uint32_t) +
                   r.strengths.capacity() * sizeof(float);
        }
        return sum;
    }

private:
    LightBVH::Children children(std::uint32_t node, const Receiver& at) const {
        return children_by_contribution(tree_, node, at);
    }

    std::size_t clusters_;
    int rays_;
    float cell_size_;
    PilotPaths pilots_;
    LightBVH tree_;
    LightGroups groups_;
    float infinite_share_ = 0;
    CellGrid grid_;
    std::vector<LightRegion> regions_;
    LightRegion everywhere_;  ///< where nothing is learnt
};

LearnedLightSampler::LearnedLightSampler(const Params& params) {
    clusters_ = static_cast<std::size_t>(
        params.int32("clusters", 64, {.min = 1, .max = static_cast<double>(most_cut_nodes)},
                     "of lights that a region knows"));
    rays_ = params.int32("rays_per_cluster", 4, {.min = 0, .max = 1024},
                         "shadow rays that a region learns from, for each of those");
    cell_size_ = params.real("cell_size", 1.0 / 32, {.min = 1e-4, .max = 100},
                             "edge of a region, relative to its distance to the camera");
    pilots_ = pilot_paths(params, 1 << 16);
}

void LearnedLightSampler::prepare(const Scene& scene) {
    groups_ = LightGroups(scene);
    tree_ = LightBVH(scene);
    infinite_share_ = infinite_share(groups_.infinite(), !tree_.empty());
    everywhere_ = {};
    if (!tree_.empty()) everywhere_ = {{0}, {1}};
    regions_.clear();
    grid_ = {};
    if (tree_.size() <= 1 || scene.integrator().light_bounces() < 0) return;
    const Workers workers(scene.threads());
    const std::vector<Receiver> points = pilot_receivers(scene, pilots_.within(scene), workers);
    Cells made = make_cells(scene, points, cell_size_, 1, points.size(), true);
    grid_ = std::move(made.grid);
    const CellPoints& cells = made.points;
    regions_.resize(cells.keys.size());
    workers.run(static_cast<std::int64_t>(regions_.size()), [&](std::int64_t index) {
        const auto i = static_cast<std::size_t>(index);
        const RegionStudy study(scene, tree_, cells.inside(points, i));
        regions_[i] = study.learn(clusters_, rays_, cells.keys[i]);
    });
}

LearnedLightSampler::Distribution LearnedLightSampler::at(const Receiver& receiver) const {
    const std::uint32_t found = grid_.find(grid_.key(receiver.p, receiver));
    Distribution result{
        this, receiver, found == CellGrid::none ? &everywhere_ : &regions_[found], 0, {}};
    const LightRegion& region = *result.region;
    for (std::size_t i = 0; i < region.clusters.size(); ++i) {
        result.weights[i] = region.strengths[i] * contribution(tree_, region.clusters[i], receiver);
        result.total += result.weights[i];
    }
    return result;
}

std::optional<LightChoice> LearnedLightSampler::Distribution::sample(double u) const {
    const auto infinite = static_cast<double>(sampler->infinite_share_);
    if (u < infinite) {
        return sampler->groups_.draw_infinite(u / infinite, sampler->infinite_share_);
    }
    if (!(total > 0)) return {};
    const double place = (u - infinite) / (1 - infinite) * static_cast<double>(total);
    double start = 0, end = 0;
    std::size_t chosen = 0;
    for (std::size_t i = 0; i < region->clusters.size(); ++i) {
        if (!(weights[i] > 0)) continue;
        if (end > 0 && place < end) break;
        chosen = i;
        start = end;
        end += static_cast<double>(weights[i]);
    }
    const double rest = (place - start) / static_cast<double>(weights[chosen]);
    return sampler->tree_.descend(
        region->clusters[chosen], std::clamp(rest, 0.0, 1 - 0x1p-53), share(chosen),
        [&](std::uint32_t node) { return sampler->children(node, receiver); });
}

float LearnedLightSampler::Distribution::pmf(std::uint32_t light) const {
    if (sampler->groups_.at_infinity(light)) {
        return sampler->groups_.infinite_pmf(light, sampler->infinite_share_);
    }
    if (!(total > 0) || !sampler->tree_.holds(light)) return 0;
    const std::vector<std::uint32_t>& clusters = region->clusters;
    const auto scale = [&](std::uint32_t node) {
        const auto found = std::lower_bound(clusters.begin(), clusters.end(), node);
        if (found == clusters.end() || *found != node) return 0.0f;
        return share(static_cast<std::size_t>(found - clusters.begin()));
    };
    return sampler->tree_.pmf_of_descent(
        light, scale, [&](std::uint32_t node) { return sampler->children(node, receiver); });
}

}  // namespace

const PluginInfo plugin = describe<LearnedLightSampler>(
    "clusters of lights, weighed by what shadow rays of the region have told of them");

}  // namespace lucerna
