// SPDX-License-Identifier: Apache-2.0
/// power: lights in proportion to the flux they emit, P(l) = Φ_l / Σ Φ.
///
/// Good where all lights are seen alike; it knows nothing of distance, direction or occlusion.
/// Constant time: alias method (Walker 1977). If no light has power, all are chosen alike.
#include "core/interfaces/light_sampler.h"
#include "core/math/distribution.h"
#include "core/scene/scene.h"

namespace lucerna {

namespace {

class PowerLightSampler final : public LightSampler {
public:
    explicit PowerLightSampler(const Params&) {}

    void prepare(const Scene& scene) override {
        std::vector<double> power;
        power.reserve(scene.lights().size());
        double total = 0;
        for (const Light& light : scene.lights()) {
            power.push_back(light.emitter->bounds(light).power);
            total += power.back();
        }
        if (!(total > 0)) std::fill(power.begin(), power.end(), 1.0);
        powers_ = DiscreteDistribution(power);
    }

    /// The same everywhere.
    struct Distribution {
        std::optional<LightChoice> sample(double u) const {
            if (powers->empty()) return {};
            const std::uint32_t light = powers->sample(u);
            return LightChoice{light, pmf(light)};
        }
        float pmf(std::uint32_t light) const { return static_cast<float>(powers->pmf(light)); }

        const DiscreteDistribution* powers;
    };
    Distribution at(const Receiver&) const { return {&powers_}; }

private:
    DiscreteDistribution powers_;
};

}  // namespace

const PluginInfo plugin =
    describe<PowerLightSampler>("chooses lights in proportion to their power");

}  // namespace lucerna
