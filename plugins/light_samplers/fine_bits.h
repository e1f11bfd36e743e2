// SPDX-License-Identifier: Apache-2.0
/// More bits for a random number than a float has.
#pragma once

#include "core/interfaces/samples.h"
#include "core/math/sequences.h"

#include <bit>

namespace lucerna {

/// A hash of the point and of `salt`.
inline std::uint64_t hash_of(const Receiver& at, std::uint64_t salt) {
    const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x)}; };
    const std::uint64_t key = (bits(at.p.x) + salt) * 0x9e3779b97f4a7c15u +
                              bits(at.p.y) * 0xbf58476d1ce4e5b9u + bits(at.p.z);
    return mix64(key);
}

/// Whether a light sampler sees the same point: what it has computed there, it can use again.
inline bool is_same_place(const Receiver& a, const Receiver& b) {
    return a.p == b.p && a.n == b.n && a.ns == b.ns && a.error == b.error && a.sides == b.sides;
}

/// Number `draw` of `draws` of the point, in [0, 1): strata of equal size, and 29 bits of a hash
/// behind the 24 bits of `u`, so that a million lights can be told apart.
inline double fine_number(const Receiver& at, std::uint32_t draw, std::uint32_t draws, float u) {
    const double fine = static_cast<double>(u) + uint64_to_double(hash_of(at, draw)) * 0x1p-24;
    return std::min((draw + fine) / draws, 1 - 0x1p-53);
}

}  // namespace lucerna
