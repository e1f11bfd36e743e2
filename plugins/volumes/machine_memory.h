// SPDX-License-Identifier: Apache-2.0
/// How much memory there is: grids that cannot fit are refused before it is asked for.
#pragma once

#include <unistd.h>

#include <cstdint>

namespace lucerna {

/// [bytes], whether they are in use or not.
inline std::uint64_t memory_of_machine() {
    return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
           static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace lucerna
