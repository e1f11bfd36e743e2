// SPDX-License-Identifier: Apache-2.0
/// How a surface scatters light.
///
/// Directions are unit length, point away from the surface, and live in the local frame whose +z
/// is the shading normal, on the outside of the shape. `wo` is given, `wi` is sampled; f excludes
/// the cosine; densities are per solid angle [1/sr] (Veach 1997, 3.7.5; pbrt 4e, 9.1. Mitsuba
/// swaps wi and wo and includes the cosine).
#pragma once

#include "core/interfaces/batch/bsdf_batch.h"
#include "core/interfaces/scattering.h"
#include "core/interfaces/texture.h"
#include "core/plugin/plugin.h"

#include <optional>

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

    /// The fraction of light that goes straight through towards `wo` as if there were no surface:
    /// the mean weight of samples of the lobe `null`.
    virtual Color transmittance(const Interaction& /*at*/, Vector3 /*wo*/) const {
        return Color(0);
    }

    /// An estimate of the fraction of light reflected or transmitted, for the albedo layer and
    /// for Russian roulette of photons; in [0, 1].
    virtual Color albedo(const Interaction& at, Vector3 wo) const = 0;

    /// Sides to which light can go: both if something is transmitted.
    Sides sides() const { return lucerna::sides(lobes()); }

    /// The functions above at many points at once: made by `describe`.
    using Batch = BSDFBatch;
    const Batch& batch() const { return *batch_; }

private:
    friend Batch;
    const Batch* batch_ = nullptr;
};

}  // namespace lucerna
