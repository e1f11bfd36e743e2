// SPDX-License-Identifier: Apache-2.0
/// Samples are placed as the filter weighs them.
#include "core/render/filter_sampler.h"

#include "core/math/sequences.h"
#include "core/plugin/error.h"
#include "tests/core/render/films.h"
#include "tests/statistics.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

/// Counts of x offsets in cells against the integral of |filter|, and the sign in each.
template <typename Filter>
void expect_distribution(const Filter& filter) {
    constexpr int cells = 60, samples = 400000;
    const FilterSampler sampler(filter);
    std::vector<double> observed(cells), expected(cells);
    Rng rng(7);
    for (int i = 0; i < samples; ++i) {
        const FilterSampler::Sample sample = sampler.sample(rng.next_float2());
        const float x = (sample.offset.x / filter.radius() + 1) / 2;
        ASSERT_TRUE(x >= 0 && x <= 1);
        observed[static_cast<std::size_t>(std::min(x * cells, cells - 1.0f))] += 1;
        const float value = filter.evaluate(sample.offset.x) * filter.evaluate(sample.offset.y);
        if (std::abs(value) > 1e-3f) {
            EXPECT_EQ(value < 0, sample.negative);
        }
    }
    double total = 0;
    for (int i = 0; i < cells * 1000; ++i) {
        const float x = (2 * (static_cast<float>(i) + 0.5f) / (cells * 1000) - 1) * filter.radius();
        const double value = static_cast<double>(std::abs(filter.evaluate(x)));
        expected[static_cast<std::size_t>(i / 1000)] += value;
        total += value;
    }
    for (double& e : expected) e *= samples / total;
    EXPECT_TRUE(counts_match(observed, expected, 1e-3));
}

TEST(FilterSampler, places_samples_like_the_filter) {
    expect_distribution(FormulaFilter(0.5f, [](float) { return 1.0f; }));
    expect_distribution(FormulaFilter(2, [](float x) { return std::exp(-2 * x * x); }));
    expect_distribution(lanczos_filter());
}

TEST(FilterSampler, weight_of_negative_lobes) {
    EXPECT_EQ(
        FilterSampler(FormulaFilter(1, [](float x) { return 1 - std::abs(x); })).negative_weight(),
        0);
    // f = 3 in the middle half, -1 outside: integrals 3 and 1 of a half each; in two dimensions
    // positive 9 + 1, negative 2 · 3, whole 4.
    const FormulaFilter filter(1, [](float x) { return std::abs(x) < 0.5f ? 3.0f : -1.0f; });
    EXPECT_NEAR(FilterSampler(filter).negative_weight(), 6.0 / 4, 1e-9);
}

TEST(FilterSampler, refuses_a_filter_without_positive_integral) {
    EXPECT_THROW(FilterSampler(FormulaFilter(1, [](float) { return 0.0f; })), Error);
    EXPECT_THROW(FilterSampler(FormulaFilter(1, [](float) { return -1.0f; })), Error);
}

}  // namespace
}  // namespace lucerna
