// SPDX-License-Identifier: Apache-2.0
/// directional: parallel light from infinity, like the sun's without its disk.
///
///   irradiance of a surface that light meets at the angle θ: E cos θ
#include "plugins/emitters/scene_sphere.h"

#include "core/base/vectorized.h"
#include "core/interfaces/emitter.h"

namespace lucerna {

namespace {

/// Parallel rays through the scene.
LUCERNA_VECTORIZED void enter_sphere(const SceneSphere& __restrict sphere, Vector3 d,
                                     const Vector2Lanes& __restrict u_position,
                                     EmissionLanes& __restrict out) {
    for (std::size_t i = 0; i < lane_count; ++i) {
        out.o.set(i, sphere.ray_origin(d, u_position[i]));
        out.d.set(i, d);
    }
}

class DirectionalEmitter final : public Emitter {
public:
    explicit DirectionalEmitter(const Params& params)
        : irradiance_(params.rgb("irradiance", Color(1), non_negative,
                                 "of a surface that faces the light [W/m²]")) {
        const Vector3 direction =
            params.vector("direction", Vector3(0, 0, 1), "in which the light travels");
        const Transform to_world =
            params.transform("to_world", "instead of direction: light travels along its z axis");
        if (params.has("direction") && params.has("to_world")) {
            params.error("direction", "give either direction or to_world, not both");
        }
        params.no_effect("sampling_weight", "lights are chosen by the light_sampler");
        const Vector3d d = to_world.direction(Vector3d(direction));
        if (!(glm::length(d) > 0)) {
            params.error("direction", "the direction must not be zero");
        } else {
            direction_ = Vector3(glm::normalize(d));
        }
    }

    void prepare(const Scene& scene) override { sphere_ = SceneSphere(scene); }

    bool infinite() const override { return true; }
    bool delta() const override { return true; }

    std::optional<LightSample> sample_li(const Light&, const Receiver&, Vector2) const override {
        return LightSample{.wi = -direction_,
                           .distance = infinity,
                           .radiance = irradiance_,
                           .pdf = 1,
                           .delta = true};
    }

    float pdf_li(const Light&, const Receiver&, Vector3, const Interaction*) const override {
        return 0;
    }

    std::optional<EmissionSample> sample_emission(const Light&, Vector2 u_position,
                                                  Vector2) const override {
        const float area = sphere_.cross_section();
        const Vector3 origin = sphere_.ray_origin(direction_, u_position);
        return EmissionSample{.ray = {.o = origin, .d = direction_},
                              .power = irradiance_ * area,
                              .pdf_position = 1 / area,
                              .pdf_direction = 1};
    }

    void sample_emission_lanes(const Light&, const Vector2Lanes& u_position, const Vector2Lanes&,
                               std::size_t count, EmissionLanes& out) const {
        enter_sphere(sphere_, direction_, u_position, out);
        const Color power = irradiance_ * sphere_.cross_section();
        for (std::size_t i = 0; i < count; ++i) out.power.set(i, power);
    }

    LightBounds bounds(const Light&) const override {
        const double area = static_cast<double>(sphere_.cross_section());
        return {.box = {},
                .directions = {.min = -direction_, .max = -direction_},
                .power = area * static_cast<double>(luminance(irradiance_))};
    }

private:
    Color irradiance_;
    Vector3 direction_{0, 0, 1};
    SceneSphere sphere_;
};

}  // namespace

const PluginInfo plugin = describe<DirectionalEmitter>("parallel light from infinity");

}  // namespace lucerna
