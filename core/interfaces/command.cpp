// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/command.h"

namespace lucerna {

Command::~Command() = default;

}  // namespace lucerna
