// SPDX-License-Identifier: Apache-2.0
#include "core/plugin/object.h"

namespace lucerna {

Object::~Object() = default;

}  // namespace lucerna
