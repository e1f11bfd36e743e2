// SPDX-License-Identifier: Apache-2.0
/// Angles in the plane, where the library's double precision and branches cost too much.
#pragma once

#include "core/math/four_floats.h"

namespace lucerna {

/// The angles of four directions (x, y) from the x axis in [−π, π], as std::atan2(y, x) gives them,
/// to 4·10⁻⁷; as if x and y were zero if both are denormal. By an approximation of atan on [0, 1]
/// to 2·10⁻⁸ (Abramowitz and Stegun 1964, "Handbook of Mathematical Functions", 4.4.49).
inline FourFloats angles_of(FourFloats x, FourFloats y) {
    const FourFloats along = absolute(x), across = absolute(y);
    const FourFloats least = FourFloats{} + std::numeric_limits<float>::min();
    const FourFloats t = min(along, across) / max(max(along, across), least);
    const FourFloats t2 = t * t;
    FourFloats series = FourFloats{} + 0.0028662257f;
    for (const float coefficient : {-0.0161657367f, 0.0429096138f, -0.0752896400f, 0.1065626393f,
                                    -0.1420889944f, 0.1999355085f, -0.3333314528f, 1.0f}) {
        series = series * t2 + coefficient;
    }
    // From the longer axis to the x axis, to the half plane, to the sign: all without branches.
    const auto reflected = [](FourFloats angle, float reach, FourFloats side) {
        return reach - copysign(FourFloats{} + reach, side) + copysign(angle, side);
    };
    const FourFloats acute = reflected(series * t, pi / 4, along - across);
    return copysign(reflected(acute, pi / 2, x), y);
}

/// The same for one direction.
inline float angle_of(float x, float y) { return angles_of(FourFloats{x}, FourFloats{y})[0]; }

}  // namespace lucerna
