// SPDX-License-Identifier: Apache-2.0
/// Choosing between two floats by their bits.
///
/// Compilers turn `c ? a : b` of floats into a branch. Where the condition is as random as the path
/// of a photon, every second one is mispredicted, which costs more than all the arithmetic around.
#pragma once

#include <bit>
#include <cstdint>

namespace lucerna {

inline float select(bool condition, float yes, float no) {
    const std::uint32_t mask = 0 - std::uint32_t{condition};
    return std::bit_cast<float>((std::bit_cast<std::uint32_t>(yes) & mask) |
                                (std::bit_cast<std::uint32_t>(no) & ~mask));
}

/// |a| < |b|.
inline bool less_magnitude(float a, float b) {
    return (std::bit_cast<std::uint32_t>(a) << 1) < (std::bit_cast<std::uint32_t>(b) << 1);
}

/// True of −0, too.
inline bool is_negative(float x) { return std::bit_cast<std::uint32_t>(x) >> 31 != 0; }

}  // namespace lucerna
