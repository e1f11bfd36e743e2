// SPDX-License-Identifier: Apache-2.0
/// One step of a path: off or through a surface, along a direction that its BSDF draws.
#pragma once

#include "core/interfaces/bsdf.h"
#include "core/interfaces/shape.h"

#include <optional>

namespace lucerna {

/// False where the shading normal and the geometric normal disagree about the side of `w`: light
/// must not leak through a surface because its normals are smooth (Veach 1997, 5.3). The BSDF is
/// zero if this holds for either of its directions, whichever of the two is sampled.
inline bool same_side(const Interaction& at, Vector3 w, Vector3 w_local) {
    return glm::dot(w, at.n) * cos_theta(w_local) > 0;
}

/// The fraction of light that goes straight through a surface towards `wo` (world).
inline Color straight_transmittance(const Interaction& at, Vector3 wo) {
    return at.shape->bsdf()->transmittance(at, at.to_local(wo));
}

/// How a path goes on.
struct ScatteredRay {
    BSDFSample sample;
    Ray ray;
};

/// Draws a direction given `wo` (world); `u_lobe` in [0, 1) chooses the lobe, `u` in [0, 1)² the
/// direction. Empty: the path ends.
inline std::optional<ScatteredRay> scatter(const Interaction& at, Vector3 wo, float u_lobe,
                                           Vector2 u) {
    const Vector3 wo_local = at.to_local(wo);
    const std::optional<BSDFSample> sample =
        at.shape->bsdf()->sample(at, wo_local, u_lobe, u, TransportMode::radiance);
    if (!sample || is_black(sample->weight)) return {};
    if (sample->lobe == Lobe::null) return ScatteredRay{*sample, at.spawn_ray(-wo)};
    const Vector3 wi = at.to_world(sample->wi);
    if (!same_side(at, wo, wo_local) || !same_side(at, wi, sample->wi)) return {};
    return ScatteredRay{*sample, at.spawn_ray(wi)};
}

}  // namespace lucerna
