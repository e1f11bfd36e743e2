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
#include "plugins/light_samplers/fine_bits.h"
#include "plugins/light_samplers/light_bvh.h"
#include "plugins/light_samplers/light_groups.h"

namespace lucerna {

namespace {

class BVHLightSampler final : public LightSampler {
public:
    explicit BVHLightSampler(const Params& params)
        : draws_(static_cast<std::uint32_t>(params.int32(
              "light_samples", 1, {.min = 1, .max = 1024}, "lights chosen at each point"))) {}

    void prepare(const Scene& scene) override {
        groups_ = LightGroups(scene);
        tree_ = LightBVH(scene);
    }
    std::uint32_t draws() const override {
        return tree_.empty() && groups_.infinite() == 0 ? 0 : draws_;
    }
    std::optional<LightChoice> sample(const Receiver& at, std::uint32_t draw,
                                      float u) const override;
    float pmf(const Receiver& at, std::uint32_t light) const override;
    std::size_t bytes() const override { return tree_.bytes(); }

private:
    /// Draws at each point that go to lights at infinity.
    float infinite_share() const {
        const auto n = static_cast<float>(groups_.infinite());
        return n / (n + (tree_.empty() ? 0.0f : 1.0f));
    }

    std::uint32_t draws_;
    LightBVH tree_;
    LightGroups groups_;
};

std::optional<LightChoice> BVHLightSampler::sample(const Receiver& at, std::uint32_t draw,
                                                   float u) const {
    double place = fine_number(at, draw, draws_, u);
    const auto scale = static_cast<float>(draws_);
    const float infinite = infinite_share();
    if (place < static_cast<double>(infinite)) {
        const auto count = static_cast<double>(groups_.infinite());
        return groups_.draw_infinite(place * (count / static_cast<double>(infinite)),
                                     scale * infinite);
    }
    if (!tree_.reaches(at)) return {};
    place = (place - static_cast<double>(infinite)) / (1 - static_cast<double>(infinite));
    return tree_.sample(at, place, scale * (1 - infinite));
}

float BVHLightSampler::pmf(const Receiver& at, std::uint32_t light) const {
    const auto scale = static_cast<float>(draws_);
    const float infinite = infinite_share();
    if (groups_.at_infinity(light)) {
        return groups_.infinite_pmf(light, scale * infinite);
    }
    if (!tree_.holds(light) || !tree_.reaches(at)) return 0;
    return tree_.pmf(at, light, scale * (1 - infinite));
}

}  // namespace

const PluginInfo plugin =
    describe<BVHLightSampler>("descends a light tree by bounds of the contribution");

}  // namespace lucerna
