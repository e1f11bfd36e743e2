// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/samples.h"

#include "core/math/rounding.h"

namespace lucerna {

Ray Interaction::spawn_ray(Vector3 d) const {
    return {.o = offset_ray_origin(p, error, n, d), .d = d, .tmax = infinity, .source = source};
}

Receiver Interaction::receiver(Vector3 wo, Sides sides) const {
    const float side = glm::dot(wo, n) < 0 ? -1.0f : 1.0f;
    return {.p = p,
            .n = side * n,
            .ns = side * shading.n,
            .error = error,
            .sides = sides,
            .source = source};
}

}  // namespace lucerna
