// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/preview.h"

namespace lucerna {

Preview::~Preview() = default;

}  // namespace lucerna
