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

}  // namespace lucerna
