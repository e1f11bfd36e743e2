// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/integrator.h"

namespace lucerna {

Integrator::~Integrator() = default;

}  // namespace lucerna
