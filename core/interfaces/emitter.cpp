// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/emitter.h"

namespace lucerna {

Emitter::~Emitter() = default;

Color Emitter::radiance(const Interaction&, Vector3) const { return Color(0); }

Color Emitter::environment(Vector3) const { return Color(0); }

}  // namespace lucerna
