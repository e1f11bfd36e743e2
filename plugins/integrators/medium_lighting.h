// SPDX-License-Identifier: Apache-2.0
/// Next event estimation at points of media.
#pragma once

#include "core/interfaces/medium.h"
#include "plugins/integrators/light_sampling.h"

namespace lucerna {

/// Where a path is scattered by a medium, for light sampling.
struct LitPoint {
    Receiver receiver;
    const Phase& phase;
    Vector3 wo;
};

/// What the light of a choice adds at a point of a medium if nothing lies between, weighted against
/// a sample of the phase function. False: nothing can arrive.
inline bool sample_light(const Scene& scene, const LightChoice& choice, const LitPoint& point,
                         Vector2 u, LightEstimate& result) {
    const Light& light = scene.lights()[choice.light];
    const std::optional<LightSample> sample = light.emitter->sample_li(light, point.receiver, u);
    if (!sample || is_black(sample->radiance)) return false;
    const PhaseValue value = point.phase.evaluate(point.receiver.p, point.wo, sample->wi);
    if (!(value.f > 0)) return false;
    const float density = choice.pmf * sample->pdf;
    const float weight = sample->delta ? 1.0f : power_heuristic(density, value.pdf);
    result.sample = *sample;
    result.density = density;
    result.value = sample->radiance * (value.f * weight / density);
    return true;
}

}  // namespace lucerna
