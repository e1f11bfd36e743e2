// SPDX-License-Identifier: Apache-2.0
/// The test toolkit itself: known quantiles, and that wrong things are found.
#include "tests/statistics.h"

#include "core/math/warp.h"

namespace lucerna {

TEST(Statistics, p_values_match_tables) {
    EXPECT_NEAR(chi_square_p_value(3.841458821, 1), 0.05, 1e-9);
    EXPECT_NEAR(chi_square_p_value(18.30703805, 10), 0.05, 1e-9);
    EXPECT_NEAR(chi_square_p_value(5000, 5000), 0.4973, 1e-4);
    EXPECT_NEAR(student_p_value(2.228138852, 10), 0.05, 1e-9);
    EXPECT_NEAR(student_quantile(0.001, 4), 8.610301581, 1e-6);
    EXPECT_NEAR(normal_quantile(0.975), 1.959963985, 1e-8);
    EXPECT_NEAR(normal_quantile(1 - 0.5 * sidak(0.01, 10)), 3.29, 0.005);
    EXPECT_NEAR(normal_quantile(1 - 0.5 * sidak(0.01, 512 * 512 * 3)), 5.69, 0.005);
}

TEST(Statistics, running_variance_far_from_zero) {
    RunningStatistics near, far, joined;
    Rng rng(1);
    for (int i = 0; i < 100000; ++i) {
        const double x = rng.next_double();
        near.add(x);
        far.add(x + 1e8);
    }
    EXPECT_NEAR(far.variance(), near.variance(), 1e-6);
    EXPECT_NEAR(near.variance(), 1.0 / 12, 1e-3);
    for (int i = 1; i <= 4; ++i) joined.add(i);
    RunningStatistics rest;
    for (int i = 5; i <= 7; ++i) rest.add(i);
    joined.add(rest);
    EXPECT_DOUBLE_EQ(joined.mean(), 4);
    EXPECT_NEAR(joined.variance(), 28.0 / 6, 1e-12);
}

TEST(Statistics, equivalence_refuses_weak_tests) {
    RunningStatistics few, many;
    Rng rng(2);
    for (int i = 0; i < 1000000; ++i) {
        const double x = 2 * rng.next_double();
        if (i < 100) few.add(x);
        many.add(x);
    }
    EXPECT_FALSE(equivalent(few, 1, 0.005));
    EXPECT_TRUE(equivalent(many, 1, 0.005));
    EXPECT_FALSE(equivalent(many, 1.01, 0.005));
    EXPECT_TRUE(mean_matches(many, 1));
    EXPECT_FALSE(mean_matches(many, 1.005));
}

TEST(Statistics, chi_square_finds_wrong_densities) {
    const auto sample = [](Vector2 u) { return std::optional(square_to_cosine_hemisphere(u)); };
    const auto wrong = [](Vector3 w) { return w.z > 0 ? 0.5 * inv_pi : 0; };
    const auto truncated = [](Vector3 w) { return w.z > 0.1f ? w.z * inv_pi / 0.99 : 0; };
    const auto too_large = [](Vector3 w) { return std::max(1.01 * w.z, 0.0) * inv_pi; };
    EXPECT_FALSE(sampling_matches_pdf(sample, wrong));
    EXPECT_FALSE(sampling_matches_pdf(sample, truncated));
    EXPECT_FALSE(sampling_matches_pdf(sample, too_large));
    const auto sometimes = [&](Vector2 u) {
        return u.y < 0.9f ? sample({u.x, u.y / 0.9f}) : std::nullopt;
    };
    const auto right = [](Vector3 w) { return 0.9 * square_to_cosine_hemisphere_pdf(w); };
    EXPECT_TRUE(sampling_matches_pdf(sometimes, right));
}

TEST(Statistics, rare_cells_are_not_dropped) {
    const double expected[] = {100, 100, 1e-3, 1e-3}, observed[] = {100, 100, 50, 0};
    EXPECT_FALSE(counts_match(observed, expected));
}

TEST(Statistics, image_test_counts_outliers) {
    std::vector<double> mean(1000, 1.0), variance(1000, 1e-4), reference(1000, 1.01), none(1000);
    EXPECT_TRUE(image_matches(mean, variance, reference, none));
    for (std::size_t i = 0; i < 4; ++i) mean[i] = 2;
    EXPECT_FALSE(image_matches(mean, variance, reference, none));
}

TEST(Statistics, integral_of_a_peak) {
    const auto peak = [](double x, double y) {
        return std::exp(-(sqr(x - 0.3) + sqr(y - 0.6)) / 1e-2) / (std::numbers::pi * 1e-2);
    };
    EXPECT_NEAR(integrate_2d(peak, -1, 2, -1, 2, 1e-6), 1, 1e-6);
    EXPECT_NEAR(integrate_sphere([](Vector3) { return 1.0; }), 4 * std::numbers::pi, 1e-6);
}

}  // namespace lucerna
