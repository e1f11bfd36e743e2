// SPDX-License-Identifier: Apache-2.0
/// What the path-like integrators share: next event estimation and its weights.
#pragma once

#include "core/interfaces/light_sampler.h"
#include "core/interfaces/sampler.h"
#include "core/scene/scatter.h"
#include "core/scene/scene.h"

#include <algorithm>

namespace lucerna {

/// Power heuristic with exponent 2 for the strategy with density `a` (Veach 1997, 9.2.4). The
/// densities count samples: n · pdf.
inline float power_heuristic(float a, float b) {
    if (a > b) {  // in this order neither square overflows where the weight matters
        const float ratio = b / a;
        return 1 / (1 + ratio * ratio);
    }
    if (!(a > 0)) return 0;
    const float ratio = a / b;
    return ratio * ratio / (1 + ratio * ratio);
}

/// Probability to survive Russian roulette for a path of throughput `beta`; `eta2` undoes the
/// scaling of radiance by refraction. The limit lets paths end where nothing is absorbed. A
/// throughput that grows by albedo / limit at a step has infinite variance if albedo² > limit: only
/// above 0.9995.
inline float survival_probability(Color beta, float eta2) {
    return std::min(max_component(beta) * eta2, 0.999f);
}

/// Density with which `draws` of light sampling from `from` choose the direction `wi`, at the end
/// of which lies `hit` on the surface of a light.
inline float light_density(const LightSampler& sampler, const Scene& scene, const Receiver& from,
                           Vector3 wi, const Interaction& hit) {
    const std::uint32_t index = Scene::light_of(hit);
    const Light& light = scene.lights()[index];
    return sampler.pmf(from, index) * light.emitter->pdf_li(light, from, wi, &hit);
}

/// The last vertex of a path, as far as light that the next ray finds by chance depends on it.
struct PathVertex {
    Receiver receiver;
    float pdf = 0;            ///< with which the BSDF chose the ray [1/sr]
    float light_samples = 1;  ///< passes of light sampling there
    bool specular = true;     ///< light sampling could not have found what the ray finds
};

/// Whether rays that leave the scene may meet light.
inline bool has_environment(const Scene& scene) {
    return std::any_of(
        scene.infinite_lights().begin(), scene.infinite_lights().end(),
        [&](std::uint32_t first) { return !scene.lights()[first].emitter->delta(); });
}

/// Light from infinity along `d`, weighted against having been sampled at the vertex before.
inline Color found_environment(const Scene& scene, const LightSampler& sampler,
                               const PathVertex& before, Vector3 d) {
    Color sum(0);
    for (const std::uint32_t first : scene.infinite_lights()) {
        const Color radiance = scene.lights()[first].emitter->environment(d);
        if (is_black(radiance)) continue;
        float weight = 1;
        if (!before.specular) {
            const std::uint32_t i = scene.light_along(first, d);
            const Light& light = scene.lights()[i];
            const float density = before.light_samples * sampler.pmf(before.receiver, i) *
                                  light.emitter->pdf_li(light, before.receiver, d, nullptr);
            weight = power_heuristic(before.pdf, density);
        }
        sum += weight * radiance;
    }
    return sum;
}

/// Light that the surface at the end of the ray emits towards `wo`, weighted in the same way.
inline Color found_emission(const Scene& scene, const LightSampler& sampler,
                            const PathVertex& before, const Interaction& at, Vector3 wo) {
    if (!at.shape->emitter()) return Color(0);
    const Color radiance = at.shape->emitter()->radiance(at, wo);
    if (is_black(radiance) || before.specular) return radiance;
    const float density =
        before.light_samples * light_density(sampler, scene, before.receiver, -wo, at);
    return radiance * power_heuristic(before.pdf, density);
}

/// Numbers of the sample stream that one call of `sample_lights` takes.
inline std::uint32_t light_dimensions(const LightSampler& sampler) { return 4 * sampler.draws(); }

/// One draw of light sampling: what it adds if nothing lies between.
struct LightEstimate {
    LightSample sample;
    Vector3 wi_local{0};
    BSDFValue scattered;
    float density = 0;  ///< pmf · pdf
    Color response{0};  ///< what radiance is multiplied by: f |cos θ| weight / density
};

/// Where and how a surface is seen, for light sampling.
struct LitSurface {
    const Interaction& at;
    const BSDF& bsdf;
    Lobe lobes;
    Vector3 wo_local;
    Receiver receiver;
    bool samples_lights;  ///< false: what light sampling finds is not scattered towards wo

    LitSurface(const Interaction& interaction, const BSDF& material, Vector3 wo)
        : at(interaction),
          bsdf(material),
          lobes(material.lobes()),
          wo_local(interaction.to_local(wo)),
          receiver(interaction.receiver(wo, sides(lobes))),
          samples_lights(any(lobes & smooth_lobes) && same_side(interaction, wo, wo_local)) {}
};

/// Draw number `draw` at many points. If the lights do not fit into the nearest cache, what
/// sampling the chosen ones will read is on its way.
inline void choose_lights(const Scene& scene, const LightSampler& sampler, std::uint32_t draw,
                          std::span<LightQuery> queries) {
    sampler.batch().sample(sampler, draw, queries);
    const std::span<const Light> lights = scene.lights();
    constexpr std::size_t few = 1024;
    if (lights.size() < few) return;
    for (const LightQuery& query : queries) {
        if (query.choice) __builtin_prefetch(&lights[query.choice->light]);
    }
    for (const auto what : {Shape::Batch::Prefetch::addresses, Shape::Batch::Prefetch::data}) {
        for (const LightQuery& query : queries) {
            if (!query.choice) continue;
            const Light& light = lights[query.choice->light];
            if (!light.shape) continue;
            light.shape->batch().prefetch(*light.shape, light.primitive, what);
        }
    }
}

/// What the light of a choice adds, weighted against `bsdf_samples` samples of the BSDF; `passes`
/// such draws are averaged by the caller. False: nothing can arrive, or be scattered towards the
/// viewer, unless it counts `for_others`, too.
inline bool sample_light(const Scene& scene, const LightChoice& choice, const LitSurface& surface,
                         Vector2 u, float passes, float bsdf_samples, LightEstimate& result,
                         bool for_others = false) {
    const Interaction& at = surface.at;
    const Light& light = scene.lights()[choice.light];
    const std::optional<LightSample> sample = light.emitter->sample_li(light, surface.receiver, u);
    if (!sample) return false;
    const Vector3 wi_local = at.to_local(sample->wi);
    if (!same_side(at, sample->wi, wi_local)) return false;
    const BSDFValue value =
        surface.bsdf.evaluate(at, surface.wo_local, wi_local, TransportMode::radiance);
    if (is_black(value.f)) {
        const bool reflected = wi_local.z * surface.wo_local.z > 0;
        if (!for_others || !(reflected || surface.receiver.sides == Sides::both)) return false;
    }
    const float density = choice.pmf * sample->pdf;
    const float weight =
        sample->delta ? 1.0f : power_heuristic(passes * density, bsdf_samples * value.pdf);
    result.sample = *sample;
    result.wi_local = wi_local;
    result.scattered = value;
    result.density = density;
    result.response = value.f * (abs_cos_theta(wi_local) * weight / density);
    return true;
}

/// Direct light at `at` towards `wo` by light sampling: one pass over all draws of the sampler.
inline Color sample_lights(const Scene& scene, const LightSampler& sampler, const BSDF& bsdf,
                           const Interaction& at, Vector3 wo, float passes, float bsdf_samples,
                           SampleStream& stream) {
    const LitSurface surface(at, bsdf, wo);
    if (!surface.samples_lights) return Color(0);
    ColorD sum(0);  // in double: there may be a million draws
    LightEstimate estimate;
    for (std::uint32_t draw = 0; draw < sampler.draws(); ++draw) {
        const Vector2 u_light = stream.next_2d();
        const Vector2 u = stream.next_2d();
        const auto choice = sampler.sample(surface.receiver, draw, u_light.x);
        if (!choice || !sample_light(scene, *choice, surface, u, passes, bsdf_samples, estimate)) {
            continue;
        }
        if (is_black(estimate.sample.radiance)) continue;
        const Color arriving = scene.transmittance(surface.receiver, estimate.sample);
        sum += ColorD(arriving * estimate.sample.radiance * estimate.response);
    }
    return Color(sum);
}

}  // namespace lucerna
