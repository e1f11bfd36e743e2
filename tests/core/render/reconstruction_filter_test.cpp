// SPDX-License-Identifier: Apache-2.0
/// Samples are shared as the filter says.
#include "core/render/reconstruction_filter.h"

#include "core/base/error.h"
#include "tests/core/render/films.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

TEST(ReconstructionFilter, a_box_reaches_its_own_pixel) {
    const ReconstructionFilter filter(box_filter());
    EXPECT_EQ(filter.reach(), 0);
    EXPECT_EQ(filter.noise_correlation(), 1);
    for (const float x : {0.0f, 0.3f, one_minus_epsilon}) {
        ASSERT_EQ(filter.weights(x).size(), 1u);
        EXPECT_EQ(filter.weights(x)[0], filter.weights(0.5f)[0]);
    }
    EXPECT_EQ(filter.place({0, 0.75f}), Vector2(0, 0.75f));
}

TEST(ReconstructionFilter, samples_of_a_narrow_filter_are_all_used) {
    const ReconstructionFilter filter(FormulaFilter(0.25f, [](float) { return 1.0f; }));
    EXPECT_EQ(filter.reach(), 0);
    for (const float u : {0.0f, 0.5f, 0.999f}) {
        EXPECT_GT(filter.weights(filter.place(Vector2(u)).x)[0], 0);
    }
}

/// A tent of radius 1: the noise of neighbours is correlated by (1/6) / (2/3) = 1/4.
TEST(ReconstructionFilter, correlation_of_noise) {
    const ReconstructionFilter filter(FormulaFilter(1, [](float x) { return 1 - std::abs(x); }));
    EXPECT_NEAR(filter.noise_correlation(), sqr(1 + 2.0 / 16), 1e-3);
}

TEST(ReconstructionFilter, weight_of_negative_lobes) {
    EXPECT_EQ(ReconstructionFilter(box_filter()).negative_weight(), 0);
    // f = 3 in the middle half, -1 outside: integrals 3 and 1 of a half each; in two dimensions
    // positive 9 + 1, negative 2 · 3, whole 4.
    const FormulaFilter filter(1, [](float x) { return std::abs(x) < 0.5f ? 3.0f : -1.0f; });
    EXPECT_NEAR(ReconstructionFilter(filter).negative_weight(), 6.0 / 4, 1e-9);
}

TEST(ReconstructionFilter, refuses_a_filter_without_positive_integral) {
    EXPECT_THROW(ReconstructionFilter(FormulaFilter(1, [](float) { return 0.0f; })), Error);
    EXPECT_THROW(ReconstructionFilter(FormulaFilter(1, [](float) { return -1.0f; })), Error);
}

}  // namespace
}  // namespace lucerna
