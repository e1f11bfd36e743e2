// SPDX-License-Identifier: Apache-2.0
/// What every phase function promises (core/interfaces/phase.h). Tried at several points, for light
/// to several directions.
#pragma once

#include "core/interfaces/phase.h"
#include "plugins/commands/contracts/finding.h"

#include <array>

namespace lucerna::contracts {

/// χ² of sampled directions, and what the density integrates to: two contracts.
std::array<Evidence, 2> phase_density(const Phase& phase, const Effort& effort);
/// Unit vectors, and the value and density that `evaluate` has.
Evidence phase_samples(const Phase& phase, const Effort& effort);
/// No light is lost or gained: the integral of f is 1.
Evidence phase_integral(const Phase& phase, const Effort& effort);
/// σ(wo) f(wo, wi) = σ(wi) f(wi, wo)
Evidence phase_reciprocity(const Phase& phase, const Effort& effort);
Evidence phase_support(const Phase& phase, const Effort& effort);
/// σ is the same both ways, within its bound, and 1 unless particles are oriented.
Evidence phase_areas(const Phase& phase, const Effort& effort);
Evidence phase_extreme_numbers(const Phase& phase);

/// All of them.
std::vector<Evidence> check(const Phase& phase, const Effort& effort);

}  // namespace lucerna::contracts
