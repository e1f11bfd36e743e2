// SPDX-License-Identifier: Apache-2.0
/// ris: of a few candidates that another light sampler draws, one in proportion to what it
/// contributes.
///
/// Resampled importance sampling (Talbot, Cline and Egbert 2005). With M candidates l_i, drawn with
/// probabilities p, and their contributions û without shadows (light_lanes.h),
///
///   w_i = û(l_i) / p(l_i),     P(choose i) = w_i / Σ w,     weight = Σ w / (M û(l_i))
///
/// The weight is an unbiased estimate of one over the probability of a choice, which is not known.
/// In its place the weights of multiple importance sampling use p: any function of point and light
/// serves there. The candidates are stratified in the numbers that they are drawn with.
#include "core/interfaces/light_sampler.h"
#include "core/math/sequences.h"
#include "plugins/light_samplers/lights/scene_lanes.h"

#include <bit>

namespace lucerna {

namespace {

class ResampledLights final : public LightSampler {
public:
    explicit ResampledLights(const Params& params)
        : candidates_(params.int32("candidates", 8, {.min = 1, .max = 1024},
                                   "lights of which one is chosen")),
          source_(params.nested_or<LightSampler>("power", "what draws the candidates")) {}

    void prepare(const Scene& scene) override { lights_ = SceneLanes(scene); }

    struct Distribution {
        std::optional<LightChoice> sample(double u) const;
        float pmf(std::uint32_t light) const { return sampler->source_.at(receiver).pmf(light); }

        const ResampledLights* sampler;
        Receiver receiver;
    };
    Distribution at(const Receiver& receiver) const { return {this, receiver}; }
    std::size_t bytes() const override { return lights_.bytes() + source_.bytes(); }

private:
    int candidates_;
    const LightSampler& source_;
    SceneLanes lights_;
};

std::optional<LightChoice> ResampledLights::Distribution::sample(double u) const {
    const LightDistribution source = sampler->source_.at(receiver);
    const ReceiverRegion at(receiver);
    Rng rng(std::bit_cast<std::uint64_t>(u));
    const int count = sampler->candidates_;
    double sum = 0;
    float contribution = 0;
    std::optional<LightChoice> chosen;
    for (int i = 0; i < count; ++i) {
        const double u_candidate = std::min((i + rng.next_double()) / count, 1 - 0x1p-53);
        const double u_keep = rng.next_double();
        const auto candidate = source.sample(u_candidate);
        if (!candidate) continue;
        const float here = sampler->lights_.contribution(candidate->light, at);
        const double w = static_cast<double>(here) * static_cast<double>(candidate->weight);
        if (!(w > 0)) continue;
        sum += w;
        if (!(u_keep * sum < w)) continue;
        chosen = candidate;
        contribution = here;
    }
    if (chosen) {
        chosen->weight = static_cast<float>(sum / count / static_cast<double>(contribution));
    }
    return chosen;
}

}  // namespace

const PluginInfo plugin = describe<ResampledLights>(
    "chooses from a few candidates of another light sampler by their contributions");

}  // namespace lucerna
