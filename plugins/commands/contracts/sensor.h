// SPDX-License-Identifier: Apache-2.0
/// What every sensor promises (core/interfaces/sensor.h).
#pragma once

#include "core/interfaces/sensor.h"
#include "plugins/commands/contracts/finding.h"

namespace lucerna::contracts {

/// Rays are unit, finite, and have a length; their lens is not in front of them.
Evidence sensor_rays(const Sensor& sensor, const Effort& effort);
/// `connect` is the inverse of `sample_ray`. Nothing to try if nothing can be connected to it.
Evidence sensor_connections(const Sensor& sensor, const Effort& effort);
/// A small square that faces the lens covers importance · area of the film.
Evidence sensor_importance(const Sensor& sensor, const Effort& effort);

/// All of them.
std::vector<Evidence> check(const Sensor& sensor, const Effort& effort);

}  // namespace lucerna::contracts
