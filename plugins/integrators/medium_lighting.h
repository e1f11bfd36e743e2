// SPDX-License-Identifier: Apache-2.0
/// Next event estimation in scenes with media.
#pragma once

#include "core/scene/medium_tracking.h"
#include "plugins/integrators/light_sampling.h"
#include "plugins/integrators/line_scattering.h"

namespace lucerna {

/// Where a path is scattered by a medium, for light sampling.
struct LitPoint {
    bool samples_lights() const { return true; }
    /// As what lights see it.
    const Receiver& lit_from() const { return receiver; }
    const Receiver& lit_from(Vector3) const { return receiver; }

    Receiver receiver;
    const Phase& phase;
    Vector3 wo;
};

/// A surface to which a path has come in `medium`, for light sampling.
struct SurfaceInMedium {
    bool samples_lights() const { return surface.samples_lights; }
    const Receiver& lit_from() const { return surface.receiver; }
    /// With the medium through which light arrives from `wi`.
    Receiver lit_from(Vector3 wi) const {
        Receiver receiver = surface.receiver;
        receiver.medium = medium_beyond(surface.at, wi, medium);
        return receiver;
    }

    const LitSurface& surface;
    const Medium* medium;
};

/// What the light of a choice adds at a point of a medium if nothing lies between, weighted against
/// `phase_samples` samples of the phase function. False: nothing can arrive, or be scattered to the
/// viewer, unless it counts `for_others`, too.
inline bool sample_light(const Scene& scene, const LightChoice& choice, const LitPoint& point,
                         Vector2 u, float light_samples, float phase_samples, LightEstimate& result,
                         bool for_others = false) {
    const LightSample& sample = result.sample;
    if (!sample_li(scene, choice, point.receiver, u, result.sample)) return false;
    if (is_black(sample.radiance)) return false;
    const PhaseValue value = point.phase.evaluate(point.receiver.p, point.wo, sample.wi);
    if (!(value.f > 0) && !for_others) return false;
    result.weigh(choice, value.pdf, light_samples, phase_samples);
    result.wi_local = sample.wi;
    result.scattered = {.f = Color(value.f), .pdf = value.pdf};
    result.response *= value.f;
    return true;
}

inline bool sample_light(const Scene& scene, const LightChoice& choice,
                         const SurfaceInMedium& vertex, Vector2 u, float light_samples,
                         float bsdf_samples, LightEstimate& result, bool for_others = false) {
    return sample_light(scene, choice, vertex.surface, u, light_samples, bsdf_samples, result,
                        for_others);
}

/// Light samples at a point, and how many they are in the weights: those of the vertex that light
/// found by chance is weighted for.
struct LightSampleCount {
    std::uint32_t taken, weighted;
};

/// Calls `visit(light, arriving)` for each light sample at a vertex (LitPoint or SurfaceInMedium),
/// drawn from `lights`, of which `arriving` is left; weighted against `scatter_samples` of the
/// phase function or BSDF. `next_2d` gives the numbers that choose lights. `for_others`: as above.
template <typename Vertex, typename Numbers, typename Visit>
void visit_light_samples(const Scene& scene, const LightDistribution& lights, const Vertex& vertex,
                         LightSampleCount count, float scatter_samples, bool for_others, Rng& rng,
                         Numbers&& next_2d, Visit&& visit) {
    if (!vertex.samples_lights()) return;
    LightEstimate light;
    const auto weighted = static_cast<float>(count.weighted);
    for (std::uint32_t k = 0; k < count.taken; ++k) {
        const double u_choice = light_number(vertex.lit_from(), k, count.taken, next_2d().x);
        const Vector2 u_light = next_2d();
        const auto choice = lights.sample(u_choice);
        if (!choice || !sample_light(scene, *choice, vertex, u_light, weighted, scatter_samples,
                                     light, for_others)) {
            continue;
        }
        if (is_black(light.sample.radiance)) continue;
        visit(light, scene.transmittance(vertex.lit_from(light.sample.wi), light.sample, rng));
    }
}

/// What light samples add up to.
struct DirectLight {
    ColorD sum{0};  ///< in double: there may be many samples

    void operator()(const LightEstimate& light, Color arriving) {
        sum += ColorD(arriving * light.sample.radiance * light.response);
    }
    Color mean(std::uint32_t count) const { return Color(sum / static_cast<double>(count)); }
};

/// Light that reaches a vertex and is scattered towards wo, by light sampling.
template <typename Vertex, typename Numbers>
Color sample_lights(const Scene& scene, const LightDistribution& lights, const Vertex& vertex,
                    LightSampleCount count, float scatter_samples, Rng& rng, Numbers&& next_2d) {
    DirectLight direct;
    visit_light_samples(scene, lights, vertex, count, scatter_samples, false, rng, next_2d, direct);
    return direct.mean(count.taken);
}

/// Aims a line at a point on a light that matters somewhere on it.
inline void aim_at_light(const Scene& scene, const LightSampler& sampler, const MediumSegment& way,
                         Rng& rng, LineScattering& line) {
    const float t = line.forced_distance(rng.next_double());
    const Receiver middle = Receiver::in_medium(*way.medium, way.o, way.d, t);
    const double u_choice = rng.next_double();
    const Vector2 u_light = rng.next_float2();
    const auto choice = sampler.at(middle).sample(u_choice);
    if (!choice) return;
    const Light& light = scene.lights()[choice->light];
    if (light.shape) return line.aim_at(light.shape->sample_area(light.primitive, u_light).p);
    const auto sample = light.emitter->sample_li(light, middle, u_light);
    if (sample && std::isfinite(sample->distance)) line.aim_at(sample->p);
}

}  // namespace lucerna
