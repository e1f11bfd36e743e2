// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/bsdf.h"

namespace lucerna {

BSDF::~BSDF() = default;

}  // namespace lucerna
