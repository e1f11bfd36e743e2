// SPDX-License-Identifier: Apache-2.0
/// Floating-point care: neighbouring floats, rounding error bounds, ray origins that clear their
/// own surface.
#pragma once

#include "core/math/vector.h"

#include <bit>

namespace lucerna {

/// The smallest float above `x`; infinity and NaN stay.
inline float next_float_up(float x) {
    if (!(x < infinity)) return x;
    if (x == 0) return std::numeric_limits<float>::denorm_min();
    const auto bits = std::bit_cast<std::uint32_t>(x);
    return std::bit_cast<float>(x > 0 ? bits + 1 : bits - 1);
}

/// The largest float below `x`; minus infinity and NaN stay.
inline float next_float_down(float x) { return -next_float_up(-x); }

/// The float nearest to `x` from below: never above x.
inline float float_below(double x) {
    const float y = static_cast<float>(x);
    return static_cast<double>(y) > x ? next_float_down(y) : y;
}

/// The float nearest to `x` from above: never below x.
inline float float_above(double x) { return -float_below(-x); }

/// Bound of the relative error of n float roundings in a row
/// (Higham 2002, "Accuracy and Stability of Numerical Algorithms", 3.1).
constexpr float gamma(int n) {
    const double ne = n * 0x1p-24;
    return static_cast<float>(ne / (1 - ne));
}

/// x + offset, then one or two floats further in its direction, unless it is zero or as good as
/// that. Without a branch: signs of normals are as random as can be.
inline float moved_by(float x, float offset) {
    const float sum = x + offset;
    const float step = std::min(std::abs(sum) * 0x1p-23f, std::abs(offset) * 0x1p60f);
    return sum + std::copysign(step, offset);
}

/// Origin for a ray that leaves the surface point `p` in direction `w`.
///
/// Moves p by `error` along the unit geometric normal `n`, to the side of w, then each moved
/// component on by a float or two, so that the sum cannot round back. `error` is an isotropic
/// bound of the distance between p and the true surface: for a triangle gamma(7) times the
/// largest coordinate of its corners. A bound per axis, projected on n, is zero for walls in a
/// coordinate plane and fails there.
inline Vector3 offset_ray_origin(Vector3 p, float error, Vector3 n, Vector3 w) {
    const Vector3 offset = std::copysign(error, glm::dot(w, n)) * n;
    return {moved_by(p.x, offset.x), moved_by(p.y, offset.y), moved_by(p.z, offset.z)};
}

}  // namespace lucerna
