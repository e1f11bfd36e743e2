// SPDX-License-Identifier: Apache-2.0
/// bvh: a light down a binary tree, at each node in proportion to a bound of what the children
/// contribute.
///
/// The light tree of pbrt (4e, 12.6.3), after Conty Estevez and Kulla 2018: the state of practice,
/// and the baseline of other samplers. The tree is split, nodes are weighed (light_bvh.h) and
/// bounds are rounded (compact_bounds.h) as there; lights at infinity share n∞ / (n∞ + 1) of the
/// draws. Other than in pbrt, power is luminance, not the largest value of the spectrum; trees may
/// be 64 deep; a cosine is at least 10⁻⁵; and normals that are opposite up to rounding make a cone
/// of all directions.
#include "plugins/light_samplers/lights/infinite_share.h"
#include "plugins/light_samplers/lights/light_bvh.h"
#include "plugins/light_samplers/lights/light_groups.h"

namespace lucerna {

namespace {

class BVHLightSampler final : public LightSampler {
public:
    explicit BVHLightSampler(const Params&) {}

    void prepare(const Scene& scene) override {
        groups_ = LightGroups(scene);
        tree_ = LightBVH(scene);
        infinite_share_ = infinite_share(groups_.infinite(), !tree_.empty());
    }

    struct Distribution {
        std::optional<LightChoice> sample(double u) const;
        float pmf(std::uint32_t light) const;

        const BVHLightSampler* sampler;
        Receiver receiver;
        bool reached;  ///< by lights of the tree
    };
    Distribution at(const Receiver& receiver) const {
        return {this, receiver, !tree_.empty() && tree_.reaches(receiver)};
    }
    std::size_t bytes() const override { return tree_.bytes(); }

private:
    LightBVH tree_;
    LightGroups groups_;
    float infinite_share_ = 0;
};

std::optional<LightChoice> BVHLightSampler::Distribution::sample(double u) const {
    const float infinite = sampler->infinite_share_;
    const auto share = static_cast<double>(infinite);
    if (u < share) return sampler->groups_.draw_infinite(u / share, infinite);
    if (!reached) return {};
    return sampler->tree_.sample(receiver, (u - share) / (1 - share), 1 - infinite);
}

float BVHLightSampler::Distribution::pmf(std::uint32_t light) const {
    const float infinite = sampler->infinite_share_;
    if (sampler->groups_.at_infinity(light)) return sampler->groups_.infinite_pmf(light, infinite);
    if (!reached || !sampler->tree_.holds(light)) return 0;
    return sampler->tree_.pmf(receiver, light, 1 - infinite);
}

}  // namespace

const PluginInfo plugin =
    describe<BVHLightSampler>("descends a light tree by bounds of the contribution");

}  // namespace lucerna
