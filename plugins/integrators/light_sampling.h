// SPDX-License-Identifier: Apache-2.0
/// What the path-like integrators share: next event estimation and its weights.
#pragma once

#include "core/interfaces/bsdf.h"
#include "core/interfaces/light_sampler.h"
#include "core/interfaces/sampler.h"
#include "core/scene/scene.h"

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

/// False where the shading normal and the geometric normal disagree about the side of `wi`:
/// light must not leak through a surface because its normals are smooth (Veach 1997, 5.3).
inline bool same_side(const Interaction& at, Vector3 wi, Vector3 wi_local) {
    return glm::dot(wi, at.n) * cos_theta(wi_local) > 0;
}

/// Density with which `draws` of light sampling from `from` choose the direction `wi`, at the end
/// of which lies `hit` on the surface of a light.
inline float light_density(const LightSampler& sampler, const Scene& scene, const Receiver& from,
                           Vector3 wi, const Interaction& hit) {
    const std::uint32_t index = Scene::light_of(hit);
    const Light& light = scene.lights()[index];
    return sampler.pmf(from, index) * light.emitter->pdf_li(light, from, wi, &hit);
}

/// Numbers of the sample stream that one call of `sample_lights` takes.
inline std::uint32_t light_dimensions(const LightSampler& sampler) { return 3 * sampler.draws(); }

/// Direct light at `at` towards `wo` by light sampling, one pass over all draws of the sampler,
/// each weighted against `bsdf_samples` samples of the BSDF; `passes` such passes are averaged by
/// the caller.
inline Color sample_lights(const Scene& scene, const LightSampler& sampler, const BSDF& bsdf,
                           const Interaction& at, Vector3 wo, float passes, float bsdf_samples,
                           SampleStream& stream) {
    const Receiver receiver = at.receiver(wo, bsdf.sides());
    const Vector3 wo_local = at.to_local(wo);
    ColorD sum(0);  // in double: there may be a million draws
    for (std::uint32_t draw = 0; draw < sampler.draws(); ++draw) {
        const float u_light = stream.next_1d();
        const Vector2 u = stream.next_2d();
        const std::optional<LightChoice> choice = sampler.sample(receiver, draw, u_light);
        if (!choice) continue;
        const Light& light = scene.lights()[choice->light];
        const std::optional<LightSample> sample = light.emitter->sample_li(light, receiver, u);
        if (!sample || is_black(sample->radiance)) continue;
        const Vector3 wi_local = at.to_local(sample->wi);
        if (!same_side(at, sample->wi, wi_local)) continue;
        const BSDFValue value = bsdf.evaluate(at, wo_local, wi_local, TransportMode::radiance);
        if (is_black(value.f)) continue;
        if (scene.occluded(receiver, *sample)) continue;
        const float density = choice->pmf * sample->pdf;
        const float weight =
            sample->delta ? 1.0f : power_heuristic(passes * density, bsdf_samples * value.pdf);
        sum += ColorD(value.f * sample->radiance * (abs_cos_theta(wi_local) * weight / density));
    }
    return Color(sum);
}

}  // namespace lucerna
