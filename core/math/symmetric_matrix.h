// SPDX-License-Identifier: Apache-2.0
/// Symmetric 3 × 3 matrices, as six numbers.
#pragma once

#include "core/math/vector.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lucerna {

struct SymmetricMatrix {
    float xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
};

/// wᵀ S w
inline double quadratic_form(const SymmetricMatrix& s, Vector3 w) {
    const Vector3d d(w);
    const auto in_double = [](float x) { return static_cast<double>(x); };
    return in_double(s.xx) * d.x * d.x + in_double(s.yy) * d.y * d.y + in_double(s.zz) * d.z * d.z +
           2 * (in_double(s.xy) * d.x * d.y + in_double(s.xz) * d.x * d.z +
                in_double(s.yz) * d.y * d.z);
}

struct EigenvalueRange {
    double least = 0, largest = 0;
};

/// In closed form (Smith 1961, "Eigenvalues of a Symmetric 3 × 3 Matrix"), to 10⁻⁸ of the largest.
inline EigenvalueRange eigenvalues(const SymmetricMatrix& s) {
    const double xx = static_cast<double>(s.xx), yy = static_cast<double>(s.yy),
                 zz = static_cast<double>(s.zz), xy = static_cast<double>(s.xy),
                 xz = static_cast<double>(s.xz), yz = static_cast<double>(s.yz);
    const double mean = (xx + yy + zz) / 3;
    const double a = xx - mean, b = yy - mean, c = zz - mean;
    const double spread =
        std::sqrt((a * a + b * b + c * c + 2 * (xy * xy + xz * xz + yz * yz)) / 6);
    if (spread == 0) return {mean, mean};
    const double determinant =
        a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
    const double cosine = determinant / (2 * spread * spread * spread);
    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) / 3;
    return {mean + 2 * spread * std::cos(angle + 2 * std::numbers::pi / 3),
            mean + 2 * spread * std::cos(angle)};
}

/// Whether a matrix with these eigenvalues is zero, or positive definite by more than what floats
/// round off.
inline bool is_zero_or_positive_definite(const EigenvalueRange& range) {
    return std::isfinite(range.largest) &&
           (range.least > 1e-6 * range.largest || (range.least == 0 && range.largest == 0));
}

}  // namespace lucerna
