// SPDX-License-Identifier: Apache-2.0
/// constant: the same radiance from everywhere around the scene.
///
/// Directions are drawn by cos θ around the shading normal where light can go to one side only,
/// which leaves no noise on unoccluded diffuse surfaces, and uniformly where it can go to both.
#include "plugins/emitters/scene_sphere.h"

#include "core/base/vectorized.h"
#include "core/interfaces/emitter.h"

namespace lucerna {

namespace {

/// Rays through the scene from all sides.
LUCERNA_VECTORIZED void enter_sphere(const SceneSphere& __restrict sphere,
                                     const Vector2Lanes& __restrict u_position,
                                     const Vector2Lanes& __restrict u_direction,
                                     EmissionLanes& __restrict out) {
    for (std::size_t i = 0; i < lane_count; ++i) {
        const Vector3 w = square_to_uniform_sphere(u_direction[i]);
        out.o.set(i, sphere.ray_origin(w, u_position[i]));
        out.d.set(i, w);
    }
}

class ConstantEmitter final : public Emitter {
public:
    explicit ConstantEmitter(const Params& params)
        : radiance_(params.rgb("radiance", Color(1), non_negative, "[W/(m² sr)]")) {
        params.no_effect("to_world", "it is the same in all directions");
        params.no_effect("sampling_weight", "lights are chosen by the light_sampler");
    }

    void prepare(const Scene& scene) override { sphere_ = SceneSphere(scene); }

    bool infinite() const override { return true; }
    Color environment(Vector3) const override { return radiance_; }

    std::optional<LightSample> sample_li(const Light&, const Receiver& from,
                                         Vector2 u) const override {
        const Vector3 axis = sampled_side(from);
        const bool all = from.sides == Sides::both;
        const Vector3 wi = all ? square_to_uniform_sphere(u)
                               : Frame::from_normal(axis).to_world(square_to_cosine_hemisphere(u));
        const float pdf = density(from, wi);
        if (!(pdf > 0)) return {};
        return LightSample{.wi = wi, .distance = infinity, .radiance = radiance_, .pdf = pdf};
    }

    float pdf_li(const Light&, const Receiver& from, Vector3 wi,
                 const Interaction*) const override {
        return density(from, wi);
    }

    std::optional<EmissionSample> sample_emission(const Light&, Vector2 u_position,
                                                  Vector2 u_direction) const override {
        const float area = sphere_.cross_section();
        const Vector3 w = square_to_uniform_sphere(u_direction);
        return EmissionSample{.ray = {.o = sphere_.ray_origin(w, u_position), .d = w},
                              .power = radiance_ * (4 * pi * area),
                              .pdf_position = 1 / area,
                              .pdf_direction = square_to_uniform_sphere_pdf(w)};
    }

    void sample_emission_lanes(const Light&, const Vector2Lanes& u_position,
                               const Vector2Lanes& u_direction, std::size_t count,
                               EmissionLanes& out) const {
        enter_sphere(sphere_, u_position, u_direction, out);
        const Color power = radiance_ * (4 * pi * sphere_.cross_section());
        for (std::size_t i = 0; i < count; ++i) out.power.set(i, power);
    }

    LightBounds bounds(const Light&) const override {
        const double area = static_cast<double>(sphere_.cross_section());
        return {.box = {},
                .directions = {.min = Vector3(-1), .max = Vector3(1)},
                .power = 4 * std::numbers::pi * area * static_cast<double>(luminance(radiance_))};
    }

private:
    static Vector3 sampled_side(const Receiver& from) {
        return from.sides == Sides::back ? -from.ns : from.ns;
    }

    static float density(const Receiver& from, Vector3 wi) {
        if (from.sides == Sides::both) return square_to_uniform_sphere_pdf(wi);
        return std::max(glm::dot(wi, sampled_side(from)), 0.0f) * inv_pi;
    }

    Color radiance_;
    SceneSphere sphere_;
};

}  // namespace

const PluginInfo plugin = describe<ConstantEmitter>("the same radiance from everywhere");

}  // namespace lucerna
