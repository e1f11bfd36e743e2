// SPDX-License-Identifier: Apache-2.0
/// What every texture promises (core/interfaces/texture.h).
#pragma once

#include "core/interfaces/texture.h"
#include "plugins/commands/contracts/finding.h"

namespace lucerna::contracts {

/// No channel is above `max()`, all are finite, and `real` is the luminance.
Evidence texture_values(const Texture& texture, const Effort& effort);
/// `mean()` is the average over the unit square.
Evidence texture_mean(const Texture& texture, const Effort& effort);
/// `gradient` is that of `real`, away from edges.
Evidence texture_gradient(const Texture& texture, const Effort& effort);
/// Coordinates that are huge or no numbers do no harm.
Evidence texture_extreme_coordinates(const Texture& texture);

/// All of them.
std::vector<Evidence> check(const Texture& texture, const Effort& effort);

}  // namespace lucerna::contracts
