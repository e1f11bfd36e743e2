// SPDX-License-Identifier: Apache-2.0
/// power: lights in proportion to the flux they emit, P(l) = Φ_l / Σ Φ.
///
/// Good where all lights are seen alike; it knows nothing of distance, direction or occlusion.
/// Constant time: alias method (Walker 1977). If no light has power, all are chosen alike.
#include "core/interfaces/light_sampler.h"
#include "core/math/distribution.h"
#include "core/math/sequences.h"
#include "core/scene/scene.h"

#include <bit>

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
        const double place = (draw + static_cast<double>(u) + fine_bits(at, draw)) / draws_;
        const std::uint32_t light = distribution_.sample(std::min(place, 1 - 0x1p-53));
        return LightChoice{light, pmf(at, light)};
    }

    float pmf(const Receiver&, std::uint32_t light) const override {
        return static_cast<float>(draws_ * distribution_.pmf(light));
    }

private:
    /// The 24 bits of a float cannot tell a million lights apart: a hash of the point adds the
    /// rest, in [0, 2⁻²⁴).
    double fine_bits(const Receiver& at, std::uint32_t draw) const {
        if (distribution_.size() < 1024) return 0;
        const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x)}; };
        const std::uint64_t key = (bits(at.p.x) + draw) * 0x9e3779b97f4a7c15u +
                                  bits(at.p.y) * 0xbf58476d1ce4e5b9u + bits(at.p.z);
        return uint64_to_double(mix64(key)) * 0x1p-24;
    }

    std::uint32_t draws_;
    DiscreteDistribution distribution_;
};

}  // namespace

const PluginInfo plugin =
    describe<PowerLightSampler>("chooses lights in proportion to their power");

}  // namespace lucerna
