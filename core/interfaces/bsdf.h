// SPDX-License-Identifier: Apache-2.0
/// How a surface scatters light.
///
/// Directions are unit length, point away from the surface, and live in the local frame whose +z
/// is the shading normal, on the outside of the shape. `wo` is given, `wi` is sampled; f excludes
/// the cosine; densities are per solid angle [1/sr] (Veach 1997, 3.7.5; pbrt 4e, 9.1. Mitsuba
/// swaps wi and wo and includes the cosine).
#pragma once

#include "core/interfaces/lanes.h"
#include "core/interfaces/scattering.h"
#include "core/interfaces/texture.h"
#include "core/plugin/plugin.h"

#include <optional>
#include <span>

namespace lucerna {

class BSDF : public Object {
public:
    static constexpr const char* kind = "bsdf";
    ~BSDF() override;

    /// All lobes that can occur anywhere on the surface.
    virtual Lobe lobes() const = 0;

    /// Value and density. Both are zero for delta lobes, which cannot be evaluated, and wherever
    /// `sample` cannot go.
    virtual BSDFValue evaluate(const Interaction& at, Vector3 wo, Vector3 wi,
                               TransportMode mode) const = 0;

    /// Draws `wi` given `wo`; `u_lobe` in [0, 1) chooses the lobe, `u` in [0, 1)² the direction.
    /// Empty: nothing is scattered.
    virtual std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float u_lobe,
                                             Vector2 u, TransportMode mode) const = 0;

    /// The same at several points, at most `lane_count`, a lane for each. All lanes hold numbers
    /// that are allowed; those of `out` after the last point may be left or filled with anything.
    /// One by one unless overridden.
    virtual void sample_lanes(std::span<const Interaction* const> at, const Vector3Lanes& wo,
                              const FloatLanes& u_lobe, const Vector2Lanes& u, TransportMode mode,
                              BSDFSampleLanes& out) const;

    /// The fraction of light that goes straight through towards `wo` as if there were no surface:
    /// the mean weight of samples of the lobe `null`.
    virtual Color transmittance(const Interaction& /*at*/, Vector3 /*wo*/) const {
        return Color(0);
    }

    /// An estimate of the fraction of light reflected or transmitted, for the albedo layer and
    /// for Russian roulette of photons; in [0, 1].
    virtual Color albedo(const Interaction& at, Vector3 wo) const = 0;

    /// Whether it asks for `dpdu`, `dpdv` or the direction of `shading.s`. Hits are found faster if
    /// not: then only `shading.n` means something, and the other axes are any.
    virtual bool uses_tangents() const { return true; }

    /// Sides to which light can go: both if something is transmitted.
    Sides sides() const { return lucerna::sides(lobes()); }
};

}  // namespace lucerna
