// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/medium.h"

namespace lucerna {

Phase::~Phase() = default;

Medium::Medium(const Params& params)
    : phase_(&params.nested_or<Phase>("isotropic", "into which directions light is scattered")) {}

Medium::~Medium() = default;

}  // namespace lucerna
