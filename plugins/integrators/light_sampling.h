// SPDX-License-Identifier: Apache-2.0
/// What the path-like integrators share: next event estimation and its weights.
#pragma once

#include "core/interfaces/light_sampler.h"
#include "core/interfaces/sampler.h"
#include "core/math/sequences.h"
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

/// Number `draw` of `draws` at a point, in [0, 1): strata of equal size, and 29 bits of a hash
/// behind the 24 bits of `u`, so that a million lights can be told apart.
inline double light_number(const Receiver& at, std::uint32_t draw, std::uint32_t draws, float u) {
    const double fine =
        static_cast<double>(u) + uint64_to_double(hash_of_point(at.p, draw)) * 0x1p-24;
    return std::min((draw + fine) / draws, 1 - 0x1p-53);
}

/// Density with which a light sample at `from` has the direction `wi`, at the end of which lies
/// `hit` on the surface of a light [1/sr].
inline float light_density(const LightDistribution& lights, const Scene& scene,
                           const Receiver& from, Vector3 wi, const Interaction& hit) {
    const std::uint32_t index = Scene::light_of(hit);
    const Light& light = scene.lights()[index];
    return lights.pmf(index) * light.emitter->pdf_li(light, from, wi, &hit);
}

/// The last vertex of a path, as far as light that the next ray finds by chance depends on it.
struct PathVertex {
    Receiver receiver;
    LightDistribution lights;
    float pdf = 0;            ///< with which the BSDF chose the ray [1/sr]
    float light_samples = 1;  ///< that were taken there
    bool specular = true;     ///< light sampling could not have found what the ray finds
};

/// Whether rays that leave the scene may meet light.
inline bool has_environment(const Scene& scene) {
    return std::any_of(
        scene.infinite_lights().begin(), scene.infinite_lights().end(),
        [&](std::uint32_t first) { return !scene.lights()[first].emitter->delta(); });
}

/// Light from infinity along `d`, weighted against having been sampled at the vertex before.
inline Color found_environment(const Scene& scene, const PathVertex& before, Vector3 d) {
    Color sum(0);
    for (const std::uint32_t first : scene.infinite_lights()) {
        const Color radiance = scene.lights()[first].emitter->environment(d);
        if (is_black(radiance)) continue;
        float weight = 1;
        if (!before.specular) {
            const std::uint32_t i = scene.light_along(first, d);
            const Light& light = scene.lights()[i];
            const float density = before.light_samples * before.lights.pmf(i) *
                                  light.emitter->pdf_li(light, before.receiver, d, nullptr);
            weight = power_heuristic(before.pdf, density);
        }
        sum += weight * radiance;
    }
    return sum;
}

/// Light that the surface at the end of the ray emits towards `wo`, weighted in the same way.
inline Color found_emission(const Scene& scene, const PathVertex& before, const Interaction& at,
                            Vector3 wo) {
    if (!at.shape->emitter()) return Color(0);
    const Color radiance = at.shape->emitter()->radiance(at, wo);
    if (is_black(radiance) || before.specular) return radiance;
    const float density =
        before.light_samples * light_density(before.lights, scene, before.receiver, -wo, at);
    return radiance * power_heuristic(before.pdf, density);
}

/// No integrator takes more light samples at a point.
inline constexpr int most_light_samples = 1 << 16;

/// Numbers of the sample stream that a light sample takes.
inline constexpr std::uint32_t light_dimensions = 4;

/// One light sample: what it adds if nothing lies between.
struct LightEstimate {
    LightSample sample;
    Vector3 wi_local{0};
    BSDFValue scattered;
    float density = 0;  ///< pmf · pdf, for the weights of multiple importance sampling
    float weight = 0;   ///< what radiance · f |cos θ| is multiplied by, but for those weights
    Color response{0};  ///< what radiance is multiplied by, with them: f |cos θ| w weight

    /// Sets all but the sample and what the surface or the medium tells.
    void weigh(const LightChoice& choice, float scattered_pdf, float light_samples,
               float scatter_samples) {
        density = choice.pmf * sample.pdf;
        weight = choice.weight / sample.pdf;
        const float mis = sample.delta ? 1.0f
                                       : power_heuristic(light_samples * density,
                                                         scatter_samples * scattered_pdf);
        response = Color(mis * weight);
    }
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

/// A light sample at each of many points. If the lights do not fit into the nearest cache, what
/// sampling the chosen ones will read is on its way.
inline void choose_lights(const Scene& scene, const LightSampler& sampler,
                          std::span<LightDraw> draws) {
    sampler.batch().sample(sampler, draws);
    const std::span<const Light> lights = scene.lights();
    constexpr std::size_t few = 1024;
    if (lights.size() < few) return;
    for (const LightDraw& draw : draws) {
        if (draw.choice) __builtin_prefetch(&lights[draw.choice->light]);
    }
    for (const auto what : {Shape::Batch::Prefetch::addresses, Shape::Batch::Prefetch::data}) {
        for (const LightDraw& draw : draws) {
            if (!draw.choice) continue;
            const Light& light = lights[draw.choice->light];
            if (!light.shape) continue;
            light.shape->batch().prefetch(*light.shape, light.primitive, what);
        }
    }
}

/// The first step of a light sample: a point on the light of a choice, or a direction to it. False:
/// nothing can arrive from there.
inline bool sample_li(const Scene& scene, const LightChoice& choice, const Receiver& receiver,
                      Vector2 u, LightSample& result) {
    const Light& light = scene.lights()[choice.light];
    const std::optional<LightSample> sample = light.emitter->sample_li(light, receiver, u);
    if (sample) result = *sample;
    return sample.has_value();
}

/// The second step: what `result.sample` adds if nothing lies between, weighted against
/// `bsdf_samples` samples of the BSDF; the caller takes the mean of `light_samples` of them. False:
/// nothing is scattered towards the viewer, unless it counts `for_others`, too.
inline bool weigh_light(const LightChoice& choice, const LitSurface& surface, float light_samples,
                        float bsdf_samples, bool for_others, LightEstimate& result) {
    const Interaction& at = surface.at;
    const Vector3 wi = result.sample.wi, wi_local = at.to_local(wi);
    if (!same_side(at, wi, wi_local)) return false;
    const BSDFValue value =
        surface.bsdf.evaluate(at, surface.wo_local, wi_local, TransportMode::radiance);
    if (is_black(value.f)) {
        const bool reflected = wi_local.z * surface.wo_local.z > 0;
        if (!for_others || !(reflected || surface.receiver.sides == Sides::both)) return false;
    }
    result.weigh(choice, value.pdf, light_samples, bsdf_samples);
    result.wi_local = wi_local;
    result.scattered = value;
    result.response *= value.f * abs_cos_theta(wi_local);
    return true;
}

/// Both steps.
inline bool sample_light(const Scene& scene, const LightChoice& choice, const LitSurface& surface,
                         Vector2 u, float light_samples, float bsdf_samples, LightEstimate& result,
                         bool for_others = false) {
    return sample_li(scene, choice, surface.receiver, u, result.sample) &&
           weigh_light(choice, surface, light_samples, bsdf_samples, for_others, result);
}

/// Direct light at `at` towards `wo` by `light_samples` light samples. Fills `lights`, the
/// distribution there, unless light sampling can find nothing.
inline Color sample_lights(const Scene& scene, const LightSampler& sampler, const BSDF& bsdf,
                           const Interaction& at, Vector3 wo, std::uint32_t light_samples,
                           float bsdf_samples, SampleStream& stream, LightDistribution& lights) {
    const LitSurface surface(at, bsdf, wo);
    if (!surface.samples_lights) return Color(0);
    lights = sampler.at(surface.receiver);
    const auto count = static_cast<float>(light_samples);
    ColorD sum(0);  // in double: there may be many samples
    LightEstimate estimate;
    for (std::uint32_t i = 0; i < light_samples; ++i) {
        const float u_light = stream.next_2d().x;
        const Vector2 u = stream.next_2d();
        const auto choice =
            lights.sample(light_number(surface.receiver, i, light_samples, u_light));
        if (!choice || !sample_light(scene, *choice, surface, u, count, bsdf_samples, estimate)) {
            continue;
        }
        if (is_black(estimate.sample.radiance)) continue;
        const Color arriving = scene.transmittance(surface.receiver, estimate.sample);
        sum += ColorD(arriving * estimate.sample.radiance * estimate.response);
    }
    return Color(sum / static_cast<double>(light_samples));
}

}  // namespace lucerna
