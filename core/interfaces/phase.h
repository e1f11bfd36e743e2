// SPDX-License-Identifier: Apache-2.0
/// Into which directions a point of a medium scatters light.
///
/// Directions are unit length, in world space, and point away from the point: `wo` is given, `wi`
/// is sampled, and light that goes on as it came has dot(wo, wi) = -1. The integral of a phase
/// function f over all wi is 1. Densities are per solid angle [1/sr] (pbrt 4e, 11.3. Mitsuba swaps
/// wi and wo).
///
/// Particles may be oriented, as fibres are: then their projected area σ depends on the direction,
/// and σ(wo) f(wo, wi) = σ(wi) f(wi, wo). σ is 1 for all others. So light that comes along -wi is
/// scattered to wo with the density f(wi, wo).
#pragma once

#include "core/interfaces/batch/phase_batch.h"
#include "core/math/bounds.h"
#include "core/plugin/plugin.h"

namespace lucerna {

/// Value and density of a phase function for a pair of directions.
struct PhaseValue {
    float f = 0;    ///< [1/sr]
    float pdf = 0;  ///< density of `wi` given `wo` [1/sr]; positive where f is
};

struct PhaseSample {
    Vector3 wi{0};
    float weight = 1;  ///< f / pdf
    float pdf = 0;     ///< [1/sr]
};

class Phase : public Object {
public:
    static constexpr const char* kind = "phase";
    ~Phase() override;

    /// Value and density at the point `p` of the world.
    virtual PhaseValue evaluate(Vector3 p, Vector3 wo, Vector3 wi) const = 0;
    /// Draws `wi` given `wo`; `u_lobe` in [0, 1) chooses the lobe, `u` in [0, 1)² the direction.
    virtual PhaseSample sample(Vector3 p, Vector3 wo, float u_lobe, Vector2 u) const = 0;

    /// Whether the projected area depends on the direction.
    virtual bool oriented() const { return false; }
    /// Whether the projected area is the same at every point.
    virtual bool uniform() const { return true; }
    /// σ of the particles for light along `w`, either way, for each unit of density: the extinction
    /// of a medium is multiplied by it.
    virtual float projected_area([[maybe_unused]] Vector3 p, [[maybe_unused]] Vector3 w) const {
        return 1;
    }
    /// σ is at most so much at all points of a box of the world, for all directions.
    virtual float max_projected_area([[maybe_unused]] const Bounds3& box) const { return 1; }

    /// `evaluate` at many points at once: made by `describe`.
    using Batch = PhaseBatch;
    const Batch& batch() const { return *batch_; }

private:
    friend Batch;
    const Batch* batch_ = nullptr;
};

/// Cosine of the angle by which light turns: 1 if it goes on as it came.
inline float scattering_cosine(Vector3 wo, Vector3 wi) {
    return std::clamp(-glm::dot(wo, wi), -1.0f, 1.0f);
}

}  // namespace lucerna
