// SPDX-License-Identifier: Apache-2.0
/// power: lights in proportion to the flux they emit, P(l) = Φ_l / Σ Φ.
///
/// Good where all lights are seen alike; it knows nothing of distance, direction or occlusion.
/// Constant time: alias method (Walker 1977). If no light has power, all are chosen alike.
#include "core/interfaces/light_sampler.h"
#include "core/math/distribution.h"
#include "core/scene/scene.h"
#include "plugins/light_samplers/fine_bits.h"

namespace lucerna {

namespace {

class PowerLightSampler final : public LightSampler {
public:
    explicit PowerLightSampler(const Params& params)
        : draws_(static_cast<std::uint32_t>(params.int32(
              "light_samples", 1, {.min = 1, .max = 1024}, "lights chosen at each point"))) {}

    void prepare(const Scene& scene) override {
        std::vector<double> power;
        power.reserve(scene.lights().size());
        double total = 0;
        for (const Light& light : scene.lights()) {
            power.push_back(light.emitter->bounds(light).power);
            total += power.back();
        }
        if (!(total > 0)) std::fill(power.begin(), power.end(), 1.0);
        distribution_ = DiscreteDistribution(power);
    }

    std::uint32_t draws() const override { return distribution_.empty() ? 0 : draws_; }

    std::optional<LightChoice> sample(const Receiver& at, std::uint32_t draw,
                                      float u) const override {
        const std::uint32_t light = distribution_.sample(fine_number(at, draw, draws_, u));
        return LightChoice{light, pmf(at, light)};
    }

    float pmf(const Receiver&, std::uint32_t light) const override {
        return static_cast<float>(draws_ * distribution_.pmf(light));
    }

private:
    std::uint32_t draws_;
    DiscreteDistribution distribution_;
};

}  // namespace

const PluginInfo plugin =
    describe<PowerLightSampler>("chooses lights in proportion to their power");

}  // namespace lucerna
