// SPDX-License-Identifier: Apache-2.0
/// What every emitter promises (core/interfaces/emitter.h), tried in a scene of which it is the
/// only one; its lights are all lights of the scene.
#pragma once

#include "core/scene/scene.h"
#include "plugins/commands/contracts/finding.h"

namespace lucerna::contracts {

/// A scene with one emitter, and a ball in front of it that both light and photons are to reach.
struct EmitterTrial {
    const Scene& scene;
    Vector3 center;
    float radius;

    /// The ball lies in front of the lights, inside the bounds of the scene if they are at
    /// infinity.
    explicit EmitterTrial(const Scene& lit);

    const Emitter& emitter() const { return *scene.lights()[0].emitter; }
    /// A point in the ball, with any normal.
    Receiver receiver(Rng& rng) const;
    /// The outward normal of the ball where a ray enters it.
    std::optional<Vector3> entry(const Ray& ray) const;
};

/// It is what it says: on a surface, at infinity, or a delta; its bounds have a power.
Evidence emitter_nature(const EmitterTrial& trial, const Effort& effort);
Evidence emitter_extreme_numbers(const EmitterTrial& trial);
/// Sampled light has the radiance and the density that are evaluated where rays meet it.
Evidence emitter_densities(const EmitterTrial& trial, const Effort& effort);
/// Light that is sampled is the light that rays find by chance. Nothing to try for delta lights.
Evidence emitter_coverage(const EmitterTrial& trial, const Effort& effort);
/// Particles carry the power of the bounds, to 1.5 %.
Evidence emitter_power(const EmitterTrial& trial, const Effort& effort);
/// Particles bring as much to each octant of the ball as its irradiance.
Evidence emitter_photons(const EmitterTrial& trial, const Effort& effort);
/// Particles leave inside the box and the cone of the bounds.
Evidence emitter_bounds(const EmitterTrial& trial, const Effort& effort);
Evidence emitter_lanes(const EmitterTrial& trial, const Effort& effort);

/// All of them.
std::vector<Evidence> check(const EmitterTrial& trial, const Effort& effort);

}  // namespace lucerna::contracts
