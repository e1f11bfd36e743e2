// SPDX-License-Identifier: Apache-2.0
/// A vertex of a path that other paths may use: on a surface, or in a medium.
#pragma once

#include "plugins/integrators/light_sampling.h"
#include "plugins/integrators/medium_lighting.h"

namespace lucerna {

struct ReusableVertex {
    Interaction at;  ///< in a medium: only the point, its frame that of the world, n = 0
    const BSDF* bsdf = nullptr;
    const Phase* phase = nullptr;    ///< if there is no BSDF; neither: no path gets there
    Vector3 wo_local{0};             ///< to the vertex before
    Vector3 viewed_n{0};             ///< geometric normal, on the side of wo
    const Medium* medium = nullptr;  ///< in which the path came; null if media do not count

    void set(const LitSurface& surface, const Medium* around) {
        at = surface.at;
        bsdf = &surface.bsdf;
        wo_local = surface.wo_local;
        viewed_n = surface.receiver.n;
        medium = around;
    }
    void set(const LitPoint& point) {
        *this = {};
        at.p = point.receiver.p;
        at.n = Vector3(0);
        phase = &point.phase;
        wo_local = point.wo;
        medium = point.receiver.medium;
    }

    bool is_set() const { return bsdf || phase; }
    bool in_medium() const { return phase != nullptr; }
    /// The medium into which a path leaves along `wi`.
    const Medium* medium_towards(Vector3 wi) const {
        return bsdf ? medium_beyond(at, wi, medium) : medium;
    }
    /// The factor of light that arrives from `wi` (local): |cos θ| on surfaces.
    float cosine(Vector3 wi) const { return bsdf ? abs_cos_theta(wi) : 1.0f; }
};

}  // namespace lucerna
