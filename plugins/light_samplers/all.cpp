// SPDX-License-Identifier: Apache-2.0
/// all: every light at every point: the plain ray tracer that other samplers are measured against.
///
/// No variance from the choice of lights, and a cost that grows with their number. An environment
/// map counts as one.
#include "plugins/light_samplers/light_groups.h"

#include <limits>

namespace lucerna {

namespace {

class AllLights final : public LightSampler {
public:
    explicit AllLights(const Params& params)
        : samples_(
              static_cast<std::uint32_t>(params.int32("light_samples", 1, {.min = 1, .max = 1024},
                                                      "samples on each light at each point"))) {}

    void prepare(const Scene& scene) override {
        groups_ = LightGroups(scene);
        if (groups_.size() > std::numeric_limits<std::uint32_t>::max() / samples_) {
            throw Error("light sampler \"all\" cannot visit so many lights: use \"power\"");
        }
    }

    std::uint32_t draws() const override {
        return static_cast<std::uint32_t>(groups_.size()) * samples_;
    }

    std::optional<LightChoice> sample(const Receiver&, std::uint32_t draw, float u) const override {
        // Stratified over the samples of a group.
        const double place = (draw % samples_ + static_cast<double>(u)) / samples_;
        LightChoice choice = groups_.draw(draw / samples_, place);
        choice.pmf *= static_cast<float>(samples_);
        return choice;
    }

    float pmf(const Receiver&, std::uint32_t light) const override {
        return static_cast<float>(samples_) * groups_.pmf(light);
    }

private:
    std::uint32_t samples_;
    LightGroups groups_;
};

}  // namespace

const PluginInfo plugin = describe<AllLights>("samples every light at every point");

}  // namespace lucerna
