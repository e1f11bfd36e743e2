// SPDX-License-Identifier: Apache-2.0
/// Four floats that vector registers work on together, three of them a vector: for the few places
/// that every ray passes. Of vectors the fourth lane is never looked at.
#pragma once

#include "core/math/vector.h"

#include <cstring>

namespace lucerna {

using FourInts = std::int32_t __attribute__((vector_size(16)));
using FourFloats = float __attribute__((vector_size(16)));

/// From memory of which 16 bytes can be read.
inline FourFloats load_four(const float* from) {
    FourFloats result;
    std::memcpy(&result, from, sizeof result);
    return result;
}

inline Vector3 to_vector3(FourFloats v) { return {v[0], v[1], v[2]}; }

inline FourFloats cross(FourFloats a, FourFloats b) {
    const FourFloats rotated = a * __builtin_shufflevector(b, b, 1, 2, 0, 3) -
                               __builtin_shufflevector(a, a, 1, 2, 0, 3) * b;
    return __builtin_shufflevector(rotated, rotated, 1, 2, 0, 3);
}

inline float dot(FourFloats a, FourFloats b) {
    const FourFloats products = a * b;
    return products[0] + products[1] + products[2];
}

inline FourFloats absolute(FourFloats v) {
    return reinterpret_cast<FourFloats>(reinterpret_cast<FourInts>(v) & 0x7fffffff);
}

inline FourFloats max(FourFloats a, FourFloats b) { return a > b ? a : b; }
inline FourFloats min(FourFloats a, FourFloats b) { return a < b ? a : b; }

/// The magnitudes of `v` with the signs of `sign`.
inline FourFloats copysign(FourFloats v, FourFloats sign) {
    return reinterpret_cast<FourFloats>((reinterpret_cast<FourInts>(v) & 0x7fffffff) |
                                        (reinterpret_cast<FourInts>(sign) & ~0x7fffffff));
}

}  // namespace lucerna
