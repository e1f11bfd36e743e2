// SPDX-License-Identifier: Apache-2.0
/// all: every light at every point: the plain ray tracer that other samplers are measured against.
///
/// No variance from the choice of lights, and a cost that grows with their number.
#include "core/interfaces/light_sampler.h"
#include "core/scene/scene.h"

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
        if (scene.lights().size() > std::numeric_limits<std::uint32_t>::max() / samples_) {
            throw Error("light sampler \"all\" cannot visit so many lights: use \"power\"");
        }
        draws_ = static_cast<std::uint32_t>(scene.lights().size()) * samples_;
    }

    std::uint32_t draws() const override { return draws_; }

    std::optional<LightChoice> sample(const Receiver& at, std::uint32_t draw,
                                      float) const override {
        const std::uint32_t light = draw / samples_;
        return LightChoice{light, pmf(at, light)};
    }

    float pmf(const Receiver&, std::uint32_t) const override {
        return static_cast<float>(samples_);
    }

private:
    std::uint32_t samples_;
    std::uint32_t draws_ = 0;
};

}  // namespace

const PluginInfo plugin = describe<AllLights>("samples every light at every point");

}  // namespace lucerna
