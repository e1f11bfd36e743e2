// SPDX-License-Identifier: Apache-2.0
/// The family of piecewise cubic filters of radius 2
/// (Mitchell and Netravali 1988, "Reconstruction Filters in Computer Graphics", eq. 8).
#pragma once

#include <cmath>

namespace lucerna {

/// k(x) for the parameters B and C; its integral is 1.
inline float cubic_filter(float x, float b, float c) {
    x = std::abs(x);
    if (x >= 2) return 0;
    if (x < 1) {
        return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) /
               6;
    }
    // In 2 - x, the distance from the end, where the filter and its slope vanish.
    const float y = 2 - x;
    return y * y * ((b + 6 * c) * y - 6 * c) / 6;
}

}  // namespace lucerna
