// SPDX-License-Identifier: Apache-2.0
/// A point light of 1 W/sr whose particles carry 5 % more than the light that is sampled: photon
/// maps are brighter than paths.
#include "core/interfaces/emitter.h"
#include "core/math/warp.h"

namespace lucerna {
namespace {

class BrightParticles final : public Emitter {
public:
    explicit BrightParticles(const Params&) {}

    bool delta() const override { return true; }

    std::optional<LightSample> sample_li(const Light&, const Receiver& from,
                                         Vector2) const override {
        const float distance = glm::length(from.p);
        if (!(distance > 0)) return {};
        return LightSample{.wi = -from.p / distance,
                           .distance = distance,
                           .radiance = Color(1 / sqr(distance)),
                           .pdf = 1,
                           .delta = true};
    }
    float pdf_li(const Light&, const Receiver&, Vector3, const Interaction*) const override {
        return 0;
    }
    std::optional<EmissionSample> sample_emission(const Light&, Vector2, Vector2 u) const override {
        return EmissionSample{.ray = {.o = Vector3(0), .d = square_to_uniform_sphere(u)},
                              .power = Color(1.05f * 4 * pi),
                              .pdf_position = 1,
                              .pdf_direction = inv_pi / 4};
    }
    LightBounds bounds(const Light&) const override {
        return {.box = {Vector3(0), Vector3(0)}, .power = 4 * std::numbers::pi};
    }
};

}  // namespace

const PluginInfo plugin = describe<BrightParticles>("has particles that carry too much");

}  // namespace lucerna
