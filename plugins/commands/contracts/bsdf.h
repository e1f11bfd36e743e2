// SPDX-License-Identifier: Apache-2.0
/// What every BSDF promises (core/interfaces/bsdf.h). Tried at one point of a surface, seen from
/// outside and inside, from steep to grazing angles.
#pragma once

#include "core/interfaces/bsdf.h"
#include "plugins/commands/contracts/finding.h"

#include <array>

namespace lucerna::contracts {

inline constexpr std::array transport_modes = {TransportMode::radiance, TransportMode::importance};

/// A point of a surface whose uv directions are neither orthogonal nor of unit length.
Interaction bsdf_surface();
/// The direction at this cosine from the normal.
Vector3 local_direction(float cos_theta, float phi);
/// Directions of view.
std::vector<Vector3> viewers();
/// A sample whose three numbers come from the generator, in a fixed order.
std::optional<BSDFSample> draw(const BSDF& bsdf, const Interaction& at, Vector3 wo,
                               TransportMode mode, Rng& rng);
/// Of the power that is scattered, a channel, per sample: radiance is denser in denser media.
RunningStatistics scattered_power(const BSDF& bsdf, Vector3 wo, TransportMode mode, int samples,
                                  int channel = 1, std::uint64_t seed = 7);
/// Whether reflection at `bsdf_surface` is known to be the same in both directions; not so where
/// normals are perturbed, nor if all lobes are deltas.
bool is_reciprocal(const BSDF& bsdf, const Effort& effort);

/// χ² of sampled directions, and what the density integrates to: two contracts.
std::array<Evidence, 2> bsdf_density(const BSDF& bsdf, const Effort& effort);
Evidence bsdf_weights(const BSDF& bsdf, const Effort& effort);
Evidence bsdf_samples(const BSDF& bsdf, const Effort& effort);
Evidence bsdf_energy(const BSDF& bsdf, const Effort& effort);
Evidence bsdf_adjoint(const BSDF& bsdf, const Effort& effort);
Evidence bsdf_reciprocity(const BSDF& bsdf, const Effort& effort);
Evidence bsdf_support(const BSDF& bsdf, const Effort& effort);
Evidence bsdf_grazing(const BSDF& bsdf, const Effort& effort);
Evidence bsdf_extreme_numbers(const BSDF& bsdf);
Evidence bsdf_transmittance(const BSDF& bsdf);
Evidence bsdf_lanes(const BSDF& bsdf, const Effort& effort);

/// All of them.
std::vector<Evidence> check(const BSDF& bsdf, const Effort& effort);

}  // namespace lucerna::contracts
