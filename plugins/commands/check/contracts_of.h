// SPDX-License-Identifier: Apache-2.0
/// From a plugin to the contracts of its kind.
#pragma once

#include "plugins/commands/check/subject.h"
#include "plugins/commands/contracts/finding.h"

namespace lucerna {

/// Tries all contracts of the kind. Throws SceneError and Error as `Subject` does.
std::vector<Evidence> contracts_of(Subject& subject, const Effort& effort);

}  // namespace lucerna
