// SPDX-License-Identifier: Apache-2.0
#include "core/math/warp.h"

#include "tests/statistics.h"

namespace lucerna {
namespace {

template <typename F>
auto always(F warp) {
    return [warp](Vector2 u) { return std::optional<Vector3>(warp(u)); };
}

/// χ² of points of a plane region against equal areas; `cell_of` numbers cells of equal area.
template <typename Warp, typename CellOf>
testing::AssertionResult fills_evenly(Warp warp, CellOf cell_of, int cells) {
    constexpr int samples = 1000000;
    std::vector<double> observed(static_cast<std::size_t>(cells));
    const std::vector<double> expected(observed.size(), static_cast<double>(samples) / cells);
    Rng rng(3);
    for (int i = 0; i < samples; ++i) ++observed[cell_of(warp(rng.next_float2()))];
    return counts_match(observed, expected);
}

}  // namespace

TEST(Warp, directions_follow_their_densities) {
    EXPECT_TRUE(
        sampling_matches_pdf(always(square_to_cosine_hemisphere), square_to_cosine_hemisphere_pdf));
    EXPECT_TRUE(sampling_matches_pdf(always(square_to_uniform_hemisphere),
                                     square_to_uniform_hemisphere_pdf));
    EXPECT_TRUE(
        sampling_matches_pdf(always(square_to_uniform_sphere), square_to_uniform_sphere_pdf));
    const float cap = 0.3f;
    EXPECT_TRUE(sampling_matches_pdf(
        always([cap](Vector2 u) { return square_to_uniform_cone(u, cap); }),
        [cap](Vector3 w) { return 1 - w.z <= cap ? square_to_uniform_cone_pdf(cap) : 0.0; }));
}

TEST(Warp, disk_and_triangle_are_uniform) {
    const auto ring_and_sector = [](Vector2 p) {
        const float turn = (std::atan2(p.y, p.x) + pi) / (2 * pi);
        const int ring = std::min(static_cast<int>(10 * glm::dot(p, p)), 9);
        return static_cast<std::size_t>(ring * 16 + std::min(static_cast<int>(16 * turn), 15));
    };
    EXPECT_TRUE(fills_evenly(square_to_uniform_disk, ring_and_sector, 160));
    // Lines from b0 = 1, and parallels to the opposite side, cut a triangle into equal areas.
    const auto fan = [](Vector2 b) {
        const int strip = static_cast<int>(10 * sqr(1 - b.x));
        const int sector = std::min(static_cast<int>(16 * b.y / (1 - b.x)), 15);
        return static_cast<std::size_t>(std::min(strip, 9) * 16 + sector);
    };
    EXPECT_TRUE(fills_evenly(square_to_uniform_triangle, fan, 160));
}

/// The angle, the series and the result are each rounded: 3·10⁻⁸ or a little more.
TEST(Warp, points_of_the_unit_circle) {
    constexpr int steps = 1 << 20;
    for (int i = 0; i <= steps; ++i) {
        const double u = static_cast<double>(i) / steps;
        const double phi = 2 * std::numbers::pi * u;
        const Vector2 p = unit_circle(static_cast<float>(u));
        ASSERT_NEAR(p.x, std::cos(phi), 1.2e-7) << u;
        ASSERT_NEAR(p.y, std::sin(phi), 1.2e-7) << u;
    }
}

TEST(Warp, tent_follows_its_density) {
    const auto by_probability = [](Vector2 u) {
        const float x = interval_to_tent(u.x);
        const float below = x < 0 ? 0.5f * sqr(1 + x) : 1 - 0.5f * sqr(1 - x);
        return static_cast<std::size_t>(std::min(static_cast<int>(100 * below), 99));
    };
    EXPECT_TRUE(fills_evenly([](Vector2 u) { return u; }, by_probability, 100));
    EXPECT_EQ(interval_to_tent_pdf(0.25f), 0.75f);
}

TEST(Warp, C1_cone_of_a_distant_light) {
    for (const double distance : {1e1, 1e3, 1e4, 1e6}) {
        const double s2 = 1 / (distance * distance);
        const auto one_minus_cos = static_cast<float>(s2 / (1 + std::sqrt(1 - s2)));
        const double pdf = 1 / (2 * std::numbers::pi * one_minus_cos);
        EXPECT_NEAR(square_to_uniform_cone_pdf(one_minus_cos) / pdf, 1, 8 * 0x1p-24);
        RunningStatistics sin2;
        Rng rng(4);
        for (int i = 0; i < 100000; ++i) {
            const Vector3 w = square_to_uniform_cone(rng.next_float2(), one_minus_cos);
            sin2.add((sqr(static_cast<double>(w.x)) + sqr(static_cast<double>(w.y))) / s2);
        }
        EXPECT_TRUE(equivalent(sin2, 0.5 + s2 / 24, 0.01)) << distance;
    }
}

TEST(Warp, C21_extreme_random_numbers) {
    for (const float x : {0.0f, 0x1p-32f, 0x1p-24f, 0.5f, one_minus_epsilon}) {
        for (const float y : {0.0f, 0x1p-32f, 0x1p-24f, 0.5f, one_minus_epsilon}) {
            const Vector2 u(x, y);
            for (const Vector3 w :
                 {square_to_cosine_hemisphere(u), square_to_uniform_hemisphere(u),
                  square_to_uniform_sphere(u), square_to_uniform_cone(u, 1e-9f)}) {
                EXPECT_NEAR(glm::length(w), 1, 1e-6);
            }
            EXPECT_GT(square_to_cosine_hemisphere_pdf(square_to_cosine_hemisphere(u)), 1e-4);
            EXPECT_GT(square_to_uniform_hemisphere(u).z, 0);
            EXPECT_GT(square_to_uniform_disk_pdf(square_to_uniform_disk(u)), 0);
            EXPECT_GT(square_to_uniform_triangle_pdf(square_to_uniform_triangle(u)), 0);
            EXPECT_LE(std::abs(interval_to_tent(x)), 1);
        }
    }
}

}  // namespace lucerna
