// SPDX-License-Identifier: Apache-2.0
/// What every reconstruction filter promises (core/interfaces/rfilter.h).
#pragma once

#include "core/interfaces/rfilter.h"
#include "plugins/commands/contracts/finding.h"

namespace lucerna::contracts {

/// ∫ f over its support, by the midpoint rule [pixels].
double integral(const RFilter& filter);

/// Finite, even, largest in the middle, zero beyond the radius.
Evidence rfilter_shape(const RFilter& filter);
/// The integral is positive, so that weights can be normalized.
Evidence rfilter_integral(const RFilter& filter);
/// The table of the film is the filter at the centres of pixels.
Evidence rfilter_weights(const RFilter& filter);

/// All of them.
std::vector<Evidence> check(const RFilter& filter, const Effort& effort);

}  // namespace lucerna::contracts
