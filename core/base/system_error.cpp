// SPDX-License-Identifier: Apache-2.0
#include "core/base/system_error.h"

#include <algorithm>
#include <array>
#include <cerrno>

namespace lucerna {

bool may_pass(int error) {
    constexpr std::array passing = {ENOSPC, EDQUOT, EIO,       ESTALE, ETIMEDOUT, EAGAIN,
                                    ENOLCK, ENFILE, EREMOTEIO, EBUSY,  ENOMEM,    EINTR};
    return std::find(passing.begin(), passing.end(), error) != passing.end();
}

}  // namespace lucerna
