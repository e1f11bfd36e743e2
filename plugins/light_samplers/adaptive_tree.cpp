// SPDX-License-Identifier: Apache-2.0
/// adaptive_tree: one light from each of as many parts of a light tree as a point needs.
///
/// Adaptive tree splitting (Conty Estevez and Kulla 2018). A cluster of N lights of
/// energies e, whose sphere of radius r is d away, so that 1 / distance² = g is anywhere between
/// 1 / (d + r)² and 1 / (d − r)², is divided while
///
///   (1 / (1 + σ))^¼ < splitting_threshold,   σ² = N² (V[e] V[g] + V[e] E[g]² + E[e]² V[g])
///   E[g] = 1 / (d² − r²),   V[g] / E[g]² = 4 r² / 3 (d² − r²)
///
/// and always around a point that is inside of the sphere. The paper's σ depends on units of length
/// and power. Here it is relative to what the point gets: σ = C √((1 + V[e] / E[e]²) (1 + V[g] /
/// E[g]²) − 1) / Σ C, with the contributions C of light_cut.h in place of N E[e] E[g], summed over
/// all parts. Clusters of the largest σ come first, as the number of parts is limited.
#include "plugins/light_samplers/cut_light_sampler.h"

namespace lucerna {

namespace {

class AdaptiveSplitting {
public:
    explicit AdaptiveSplitting(const Params& params) {
        const float threshold = params.real(
            "splitting_threshold", 0.98, unit_interval,
            "from which parts of the tree are not divided: 0 divides none, 1 as many as it may");
        tolerance_ = 1 / sqr(sqr(threshold)) - 1;
    }

    void prepare(const LightBVH& tree);
    std::size_t bytes() const { return energy_spread_.capacity() * sizeof(float); }

    float tolerance() const { return tolerance_; }
    CutNode judge(const LightBVH& tree, std::uint32_t index, const Receiver& at) const {
        const LightBVH::Node& node = tree[index];
        const LightBVH::View seen = tree.view(node, at);
        const float r2 = sqr(node.radius);
        const float value = seen.power / std::max(seen.distance2, 0.25f * r2);
        const float product = seen.distance2 - r2;  // (d + r) (d − r)
        const float place_spread = product > 0 ? 4 * r2 / (3 * product) : infinity;
        const float spread = (1 + energy_spread_[index]) * (1 + place_spread) - 1;
        return {index, value, node.leaf ? 0.0f : value * std::sqrt(spread)};
    }
    LightBVH::Children children(const LightBVH& tree, std::uint32_t node,
                                const Receiver& at) const {
        return children_by_contribution(tree, node, at);
    }

private:
    float tolerance_ = 0;               ///< of σ, relative
    std::vector<float> energy_spread_;  ///< of each node, V[e] / E[e]²
};

void AdaptiveSplitting::prepare(const LightBVH& tree) {
    struct Sum {
        double count = 1, energy = 0, square = 0;
    };
    std::vector<Sum> sums(tree.size());
    energy_spread_.assign(tree.size(), 0.0f);
    for (std::uint32_t i = tree.size(); i-- > 0;) {
        const auto power = static_cast<double>(tree[i].power);
        if (tree[i].leaf) {
            sums[i] = {1, power, sqr(power)};
            continue;
        }
        const Sum &a = sums[i + 1], &b = sums[tree[i].link];
        sums[i] = {a.count + b.count, a.energy + b.energy, a.square + b.square};
        const double mean_square = sums[i].square / sums[i].count;
        const double squared_mean = sqr(sums[i].energy / sums[i].count);
        energy_spread_[i] = static_cast<float>(std::max(mean_square / squared_mean - 1, 0.0));
    }
}

}  // namespace

const PluginInfo plugin = describe<CutLightSampler<AdaptiveSplitting>>(
    "splits a light tree as far as a point needs, and draws a light of each part");

}  // namespace lucerna
