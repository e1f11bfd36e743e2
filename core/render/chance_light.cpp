// SPDX-License-Identifier: Apache-2.0
#include "core/render/chance_light.h"

#include "core/interfaces/emitter.h"
#include "core/interfaces/integrator.h"
#include "core/interfaces/shape.h"
#include "core/scene/scene.h"

#include <algorithm>
#include <numbers>

namespace lucerna {

namespace {

double luminance_of(const Light& light) {
    const Emitter& emitter = *light.emitter;
    if (emitter.delta()) return 0;
    if (!light.shape) {
        const auto sample = emitter.sample_li(light, Receiver{}, Vector2(0.5f));
        return sample ? static_cast<double>(luminance(sample->radiance)) : 0;
    }
    const LightBounds bounds = emitter.bounds(light);
    const double sides = bounds.two_sided ? 2 : 1;
    return bounds.power /
           (sides * std::numbers::pi * static_cast<double>(light.shape->area(light.primitive)));
}

}  // namespace

double chance_luminance(const Scene& scene) {
    // Integrators of photons sample lights after one bounce at most.
    if (scene.integrator().light_bounces() < 2) return 0;
    if (!any(scene.surface_lobes() & specular_lobes)) return 0;
    double result = 0;
    const Light* last = nullptr;
    for (const Light& light : scene.lights()) {
        // The triangles of a mesh emit alike.
        if (last && light.shape && last->shape == light.shape) continue;
        last = &light;
        result = std::max(result, luminance_of(light));
    }
    return result;
}

}  // namespace lucerna
