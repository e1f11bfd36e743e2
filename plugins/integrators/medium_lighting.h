// SPDX-License-Identifier: Apache-2.0
/// Next event estimation in scenes with media.
#pragma once

#include "core/scene/medium_tracking.h"
#include "plugins/integrators/light_sampling.h"
#include "plugins/integrators/line_scattering.h"

namespace lucerna {

/// Where a path is scattered by a medium, for light sampling.
struct LitPoint {
    Receiver receiver;
    const Phase& phase;
    Vector3 wo;
};

/// What the light of a choice adds at a point of a medium if nothing lies between, weighted against
/// `phase_samples` samples of the phase function. False: nothing can arrive.
inline bool sample_light(const Scene& scene, const LightChoice& choice, const LitPoint& point,
                         Vector2 u, float phase_samples, LightEstimate& result) {
    const Light& light = scene.lights()[choice.light];
    const std::optional<LightSample> sample = light.emitter->sample_li(light, point.receiver, u);
    if (!sample || is_black(sample->radiance)) return false;
    const PhaseValue value = point.phase.evaluate(point.receiver.p, point.wo, sample->wi);
    if (!(value.f > 0)) return false;
    const float density = choice.pmf * sample->pdf;
    const float weight = sample->delta ? 1.0f : power_heuristic(density, phase_samples * value.pdf);
    result.sample = *sample;
    result.density = density;
    result.response = Color(value.f * weight / density);
    return true;
}

/// Light that reaches a point of a medium and is scattered towards wo, by light sampling;
/// `next_2d` gives the numbers that choose lights.
template <typename Numbers>
Color sample_lights(const Scene& scene, const LightSampler& sampler, const LitPoint& point,
                    float phase_samples, Rng& rng, Numbers&& next_2d) {
    ColorD direct(0);
    LightEstimate light;
    for (std::uint32_t draw = 0; draw < sampler.draws(); ++draw) {
        const float u_choice = next_2d().x;
        const Vector2 u_light = next_2d();
        const auto choice = sampler.sample(point.receiver, draw, u_choice);
        if (!choice || !sample_light(scene, *choice, point, u_light, phase_samples, light)) {
            continue;
        }
        const Color arriving = scene.transmittance(point.receiver, light.sample, rng);
        direct += ColorD(arriving * light.sample.radiance * light.response);
    }
    return Color(direct);
}

/// Direct light at a surface that a path in `medium` has come to.
inline Color sample_lights(const Scene& scene, const LightSampler& sampler,
                           const LitSurface& surface, const Medium* medium, float bsdf_samples,
                           Rng& rng, SampleStream& stream) {
    if (!surface.samples_lights) return Color(0);
    ColorD direct(0);  // in double: there may be a million draws
    LightEstimate light;
    for (std::uint32_t draw = 0; draw < sampler.draws(); ++draw) {
        const float u_choice = stream.next_2d().x;
        const Vector2 u_light = stream.next_2d();
        const auto choice = sampler.sample(surface.receiver, draw, u_choice);
        if (!choice || !sample_light(scene, *choice, surface, u_light, 1, bsdf_samples, light)) {
            continue;
        }
        Receiver receiver = surface.receiver;
        receiver.medium = medium_beyond(surface.at, light.sample.wi, medium);
        const Color arriving = scene.transmittance(receiver, light.sample, rng);
        if (!is_black(arriving))
            direct += ColorD(arriving * light.sample.radiance * light.response);
    }
    return Color(direct);
}

/// Aims a line at a point on a light that matters somewhere on it.
inline void aim_at_light(const Scene& scene, const LightSampler& sampler, const MediumSegment& way,
                         Rng& rng, LineScattering& line) {
    const float t = line.forced_distance(rng.next_double());
    const Receiver middle = Receiver::in_medium(*way.medium, way.o, way.d, t);
    const std::uint32_t draw =
        std::min(static_cast<std::uint32_t>(rng.next_float() * static_cast<float>(sampler.draws())),
                 sampler.draws() - 1);
    const float u_choice = rng.next_float();
    const Vector2 u_light = rng.next_float2();
    if (const auto choice = sampler.sample(middle, draw, u_choice)) {
        const Light& light = scene.lights()[choice->light];
        const auto sample = light.emitter->sample_li(light, middle, u_light);
        if (sample && std::isfinite(sample->distance)) line.aim_at(sample->p);
    }
}

}  // namespace lucerna
