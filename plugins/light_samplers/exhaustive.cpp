// SPDX-License-Identifier: Apache-2.0
/// exhaustive: every light in proportion to what it would contribute without shadows.
///
/// P(l | x) = u_l(x) / Σ u, with the bounds u of light_lanes.h evaluated for all lights at each
/// point: slow, and the best that can be done without knowing what is visible. A reference for
/// other samplers. The light of an environment counts as if it came from everywhere alike.
#include "core/interfaces/light_sampler.h"
#include "plugins/light_samplers/lights/scene_lanes.h"

namespace lucerna {

namespace {

class ExhaustiveLightSampler final : public LightSampler {
public:
    explicit ExhaustiveLightSampler(const Params&) {}

    void prepare(const Scene& scene) override { lights_ = SceneLanes(scene); }

    struct Distribution {
        std::optional<LightChoice> sample(double u) const;
        float pmf(std::uint32_t light) const {
            return total > 0 ? probability(lights->contribution(light, at)) : 0.0f;
        }
        float probability(float contribution) const {
            return static_cast<float>(static_cast<double>(contribution) / total);
        }

        const SceneLanes* lights;
        ReceiverRegion at;
        double total;  ///< contribution of all lights
    };
    Distribution at(const Receiver& receiver) const {
        Distribution result{&lights_, ReceiverRegion(receiver), 0};
        lights_.for_each_block(result.at, [&](std::size_t, const float* weights) {
            for (std::size_t k = 0; k < SceneLanes::width; ++k) {
                result.total += static_cast<double>(weights[k]);
            }
            return true;
        });
        return result;
    }
    std::size_t bytes() const override { return lights_.bytes(); }

private:
    SceneLanes lights_;
};

std::optional<LightChoice> ExhaustiveLightSampler::Distribution::sample(double u) const {
    if (!(total > 0)) return {};
    const double place = u * total;
    double end = 0;
    std::optional<LightChoice> chosen;
    lights->for_each_block(at, [&](std::size_t first, const float* weights) {
        for (std::size_t k = 0; k < SceneLanes::width; ++k) {
            if (!(weights[k] > 0)) continue;
            if (chosen && place < end) return false;
            chosen = {lights->light(first + k), probability(weights[k])};
            end += static_cast<double>(weights[k]);
        }
        return true;
    });
    return chosen;
}

}  // namespace

const PluginInfo plugin = describe<ExhaustiveLightSampler>(
    "weighs all lights at each point by their contribution without shadows");

}  // namespace lucerna
