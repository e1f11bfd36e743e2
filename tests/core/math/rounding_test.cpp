// SPDX-License-Identifier: Apache-2.0
#include "core/math/rounding.h"

#include "core/math/sequences.h"

#include <gtest/gtest.h>

namespace lucerna {

#if defined(__x86_64__)
/// A processor that could do both at once, with one rounding.
[[gnu::target("fma"), gnu::noinline]] float product_and_sum(float a, float b, float c) {
    return a * b + c;
}

TEST(Rounding, M11_products_are_rounded_before_they_are_added) {
    if (!__builtin_cpu_supports("fma")) GTEST_SKIP() << "the processor has no such instruction";
    // (1 + 2⁻¹²)² = 1 + 2⁻¹¹ + 2⁻²⁴, which is rounded to 1 + 2⁻¹¹.
    EXPECT_EQ(product_and_sum(1 + 0x1p-12f, 1 + 0x1p-12f, -(1 + 0x1p-11f)), 0);
}
#endif

TEST(Rounding, neighbours_agree_with_the_library) {
    Rng rng(1);
    for (int i = 0; i < 100000; ++i) {
        const float x = std::bit_cast<float>(rng.next_uint());
        if (std::isnan(x)) continue;
        EXPECT_EQ(next_float_up(x), std::nextafter(x, infinity));
        EXPECT_EQ(next_float_down(x), std::nextafter(x, -infinity));
    }
    for (const float x : {0.0f, -0.0f}) {
        EXPECT_GT(next_float_up(x), 0);
        EXPECT_LT(next_float_down(x), 0);
    }
    EXPECT_EQ(next_float_up(infinity), infinity);
    EXPECT_TRUE(std::isnan(next_float_up(std::nanf(""))));
    EXPECT_LE(float_below(0.1), 0.1);
    EXPECT_GE(float_above(0.1), 0.1);
    EXPECT_EQ(float_below(0.25), 0.25f);
}

/// Offset origins lie beyond the exact plane of their triangle, at every scale, and move little.
TEST(Rounding, B1_origins_clear_their_triangle) {
    Rng rng(2);
    const auto vertex = [&rng](float scale, float shift) {
        const float x = rng.next_float(), y = rng.next_float(), z = rng.next_float();
        return (Vector3(x, y, z) - 0.5f) * scale + shift;
    };
    for (const float scale : {1e-6f, 1e-3f, 1.0f, 1e3f, 1e6f, 1e8f}) {
        for (const float shift : {0.0f, 1.0f, 1e3f}) {
            for (int i = 0; i < 5000; ++i) {
                Vector3 v[3];
                for (Vector3& p : v) p = vertex(scale, scale * shift);
                // Every third triangle lies in a coordinate plane.
                if (i % 3 == 0) v[0].z = v[1].z = v[2].z = 0;
                const Vector2 b(0.5f * rng.next_float(), 0.5f * rng.next_float());
                const float b2 = 1 - b.x - b.y;
                const Vector3 p = b.x * v[0] + b.y * v[1] + b2 * v[2];
                const Vector3 size =
                    absolute(b.x * v[0]) + absolute(b.y * v[1]) + absolute(b2 * v[2]);
                const Vector3d exact_n = glm::normalize(
                    glm::cross(Vector3d(v[1]) - Vector3d(v[0]), Vector3d(v[2]) - Vector3d(v[0])));
                const float error = gamma(7) * max_component(size);
                for (const float side : {-1.0f, 1.0f}) {
                    const Vector3 n(exact_n);
                    const Vector3 moved = offset_ray_origin(p, error, n, side * n);
                    const double height = glm::dot(Vector3d(moved) - Vector3d(v[0]), exact_n);
                    EXPECT_GT(height * side, 0) << "scale " << scale << " shift " << shift;
                    EXPECT_LT(std::abs(height), 4 * error);
                    const double step = glm::dot(Vector3d(moved) - Vector3d(p), exact_n);
                    EXPECT_GT(step * side, 0.9 * error);
                }
            }
        }
    }
}

}  // namespace lucerna
