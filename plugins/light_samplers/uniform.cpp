// SPDX-License-Identifier: Apache-2.0
/// uniform: every light with the same probability, P(l) = 1 / n.
///
/// The simplest sampler, best for one light or a few equal ones; its variance grows with the
/// number of lights.
#include "core/interfaces/light_sampler.h"
#include "core/scene/scene.h"

namespace lucerna {

namespace {

class UniformLightSampler final : public LightSampler {
public:
    explicit UniformLightSampler(const Params& params)
        : draws_(static_cast<std::uint32_t>(params.int32(
              "light_samples", 1, {.min = 1, .max = 1024}, "lights chosen at each point"))) {}

    void prepare(const Scene& scene) override {
        lights_ = static_cast<std::uint32_t>(scene.lights().size());
    }

    std::uint32_t draws() const override { return lights_ > 0 ? draws_ : 0; }

    std::optional<LightChoice> sample(const Receiver& at, std::uint32_t draw,
                                      float u) const override {
        // Stratified over the draws: together they cover [0, 1).
        const double place = (draw + static_cast<double>(u)) / draws_;
        const auto light = static_cast<std::uint32_t>(place * lights_);
        return LightChoice{std::min(light, lights_ - 1), pmf(at, light)};
    }

    float pmf(const Receiver&, std::uint32_t) const override {
        return static_cast<float>(draws_) / static_cast<float>(lights_);
    }

private:
    std::uint32_t draws_;
    std::uint32_t lights_ = 0;
};

}  // namespace

const PluginInfo plugin =
    describe<UniformLightSampler>("chooses every light with the same probability");

}  // namespace lucerna
