// SPDX-License-Identifier: Apache-2.0
#include "core/math/angle.h"

#include "core/math/sequences.h"

#include <gtest/gtest.h>

namespace lucerna {

TEST(Angle, agrees_with_the_library) {
    Rng rng(1);
    for (int i = 0; i < 1000000; ++i) {
        const float x = std::bit_cast<float>(rng.next_uint());
        const float y = std::bit_cast<float>(rng.next_uint());
        const float longer = std::max(std::abs(x), std::abs(y));
        if (!(std::isnormal(longer) && std::isfinite(x) && std::isfinite(y))) continue;
        EXPECT_NEAR(angle_of(x, y), std::atan2(static_cast<double>(y), static_cast<double>(x)),
                    4e-7)
            << x << ' ' << y;
    }
}

TEST(Angle, is_right_on_the_axes_and_diagonals) {
    for (const float x : {-2.0f, -0.0f, 0.0f, 2.0f}) {
        for (const float y : {-2.0f, -0.0f, 0.0f, 2.0f}) {
            EXPECT_NEAR(angle_of(x, y), std::atan2(y, x), 4e-7) << x << ' ' << y;
        }
    }
}

/// Each lane has its own quadrant.
TEST(Angle, four_at_once_are_the_same) {
    const FourFloats x{1, -2, -0.5f, 0.25f}, y{3, 0.125f, -7, -0.5f};
    const FourFloats angles = angles_of(x, y);
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(angles[i], angle_of(x[i], y[i]));
        EXPECT_NEAR(angles[i], std::atan2(y[i], x[i]), 4e-7);
    }
}

}  // namespace lucerna
