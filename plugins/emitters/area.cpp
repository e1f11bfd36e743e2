// SPDX-License-Identifier: Apache-2.0
/// area: a surface that emits the same radiance in all directions, on the outside of its shape.
///
/// The power of a primitive is Φ = π A L. Light towards a point is sampled as the shape does it
/// best (by solid angle), particles by area and cosine.
#include "core/base/vectorized.h"
#include "core/interfaces/emitter.h"
#include "core/interfaces/shape.h"
#include "core/math/rounding.h"
#include "core/math/warp.h"

namespace lucerna {

namespace {

/// Rays from points on a surface.
LUCERNA_VECTORIZED void leave_surface(const SurfaceSampleLanes& __restrict at,
                                      const Vector2Lanes& __restrict u,
                                      EmissionLanes& __restrict out) {
    for (std::size_t i = 0; i < lane_count; ++i) {
        const Vector3 n = at.n[i];
        const Vector3 w = Frame::from_normal(n).to_world(square_to_cosine_hemisphere(u[i]));
        out.o.set(i, offset_ray_origin(at.p[i], at.error[i], n, w));
        out.d.set(i, w);
    }
}

class AreaEmitter final : public Emitter {
public:
    explicit AreaEmitter(const Params& params)
        : radiance_(params.color_input("radiance", Color(1), non_negative,
                                       "emitted radiance [W/(m² sr)]")) {
        params.no_effect("sampling_weight", "lights are chosen by the light_sampler");
    }

    bool on_surface() const override { return true; }

    Color radiance(const Interaction& at, Vector3 w) const override {
        return glm::dot(at.n, w) > 0 ? radiance_(at) : Color(0);
    }

    std::optional<LightSample> sample_li(const Light& light, const Receiver& from,
                                         Vector2 u) const override {
        // The only variable that is returned, so that it is filled in place: a copy would wait
        // until its parts are stored.
        std::optional<LightSample> sample;
        const auto at = light.shape->sample_solid_angle(light.primitive, from, u);
        if (!at) return sample;
        const Vector3 to_light = at->p - from.p;
        const float distance = glm::length(to_light);
        if (!(distance > 0)) return sample;
        const Vector3 wi = to_light / distance;
        if (!(glm::dot(at->n, wi) < 0)) return sample;
        sample.emplace();
        sample->wi = wi;
        sample->distance = distance;
        sample->radiance = radiance_of(light, *at);
        sample->pdf = at->pdf;
        sample->p = at->p;
        sample->n = at->n;
        sample->error = at->error;
        sample->target = light.shape->primitive_id(light.primitive);
        return sample;
    }

    float pdf_li(const Light& light, const Receiver& from, Vector3 wi,
                 const Interaction* hit) const override {
        if (!hit || !(glm::dot(hit->n, wi) < 0)) return 0;
        return light.shape->pdf_solid_angle(light.primitive, from, wi, *hit);
    }

    std::optional<EmissionSample> sample_emission(const Light& light, Vector2 u_position,
                                                  Vector2 u_direction) const override {
        const SurfaceSample at = light.shape->sample_area(light.primitive, u_position);
        if (!(at.pdf > 0)) return {};
        const Vector3 local = square_to_cosine_hemisphere(u_direction);
        const Vector3 w = Frame::from_normal(at.n).to_world(local);
        return EmissionSample{.ray = {.o = offset_ray_origin(at.p, at.error, at.n, w), .d = w},
                              .power = radiance_of(light, at) * (pi / at.pdf),
                              .pdf_position = at.pdf,
                              .pdf_direction = square_to_cosine_hemisphere_pdf(local)};
    }

    void sample_emission_lanes(const Light& light, const Vector2Lanes& u_position,
                               const Vector2Lanes& u_direction, std::size_t count,
                               EmissionLanes& out) const {
        SurfaceSampleLanes at;
        light.shape->batch().sample_area(*light.shape, light.primitive, u_position, count, at);
        leave_surface(at, u_direction, out);
        for (std::size_t i = 0; i < count; ++i) {
            const Color radiance = radiance_of(light, at[i]);
            out.power.set(i, at.pdf[i] > 0 ? radiance * (pi / at.pdf[i]) : Color(0));
        }
    }

    LightBounds bounds(const Light& light) const override {
        const auto [axis, cos_normals] = light.shape->normal_cone(light.primitive);
        const double area = static_cast<double>(light.shape->area(light.primitive));
        return {
            .box = light.shape->primitive_bounds(light.primitive),
            .axis = axis,
            .cos_normals = cos_normals,
            .cos_emission = 0,
            .power = std::numbers::pi * area * static_cast<double>(luminance(radiance_.mean()))};
    }

private:
    Color radiance_of(const Light& light, const SurfaceSample& sample) const {
        if (!radiance_.texture) return radiance_.constant;
        Interaction at;
        at.p = sample.p;
        at.n = sample.n;
        at.uv = light.shape->uv_of(light.primitive, sample);
        at.shape = light.shape;
        at.primitive = light.primitive;
        at.hit_uv = sample.hit_uv;
        return radiance_(at);
    }

    ColorInput radiance_;
};

}  // namespace

const PluginInfo plugin = describe<AreaEmitter>("a diffuse emitter on the outside of a shape");

}  // namespace lucerna
