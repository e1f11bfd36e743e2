// SPDX-License-Identifier: Apache-2.0
/// Numbers of 16 bits (IEEE 754 binary16), as far as pictures need them: finite, not negative.
#pragma once

#include "core/math/four_floats.h"

#include <bit>
#include <cmath>
#include <cstdint>

namespace lucerna::half {

using Four = std::uint16_t __attribute__((vector_size(8)));

inline constexpr float largest = 65504;
inline constexpr float least_normal = 0x1p-14f;
inline constexpr float denormal_step = 0x1p-24f;
/// The exponent of a float with the same number is larger by 112.
inline constexpr std::uint32_t exponent_offset = 112u << 10;

/// Whether 16 bits hold x exactly.
inline bool holds(float x) {
    if (!(x >= 0 && x <= largest)) return false;
    if (x < least_normal) return std::floor(x / denormal_step) == x / denormal_step;
    return (std::bit_cast<std::uint32_t>(x) & 0x1fff) == 0;
}

/// The bits of a number that they hold.
inline std::uint16_t bits_of(float x) {
    if (x < least_normal) return static_cast<std::uint16_t>(x / denormal_step);
    return static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(x) >> 13) - exponent_offset);
}

/// The numbers of four halves. Denormal ones are read as what they are beyond the least normal one,
/// since threads that render take denormal floats as zero.
inline FourFloats to_floats(Four halves) {
    const FourInts wide = __builtin_convertvector(halves, FourInts);
    const FourInts bits = (wide << 13) + (static_cast<std::int32_t>(exponent_offset) << 13);
    const FourFloats beyond = reinterpret_cast<FourFloats>(bits + (1 << 23)) - least_normal;
    return wide < (1 << 10) ? beyond : reinterpret_cast<FourFloats>(bits);
}

}  // namespace lucerna::half
