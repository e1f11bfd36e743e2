// SPDX-License-Identifier: Apache-2.0
#include "core/math/distribution.h"

#include "tests/statistics.h"

#include <numeric>
#include <stdexcept>

namespace lucerna {
namespace {

std::vector<double> random_weights(std::size_t n, std::uint64_t seed) {
    Rng rng(seed);
    std::vector<double> weights(n);
    for (double& w : weights) {
        const double x = rng.next_double();
        w = x < 0.3 ? 0 : std::exp(8 * x);
    }
    return weights;
}

constexpr double edges[] = {0.0, 0x1p-53, 0x1p-24, 0.5, one_minus_epsilon, 1 - 0x1p-53, 1.0};

}  // namespace

TEST(DiscreteDistribution, C22_samples_follow_the_pmf) {
    const std::vector<double> weights = random_weights(1000, 1);
    const DiscreteDistribution d(weights);
    constexpr int samples = 1000000;
    std::vector<double> observed(weights.size()), expected(weights.size());
    RunningStatistics rest;
    Rng rng(2);
    for (int i = 0; i < samples; ++i) {
        const auto [index, u] = d.sample_reuse(rng.next_double());
        ++observed[index];
        rest.add(u);
        ASSERT_TRUE(u >= 0 && u < 1);
    }
    double sum = 0;
    for (std::uint32_t i = 0; i < weights.size(); ++i) {
        sum += d.pmf(i);
        expected[i] = d.pmf(i) * samples;
        EXPECT_DOUBLE_EQ(d.pmf(i), weights[i] / d.total());
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_TRUE(counts_match(observed, expected));
    EXPECT_TRUE(equivalent(rest, 0.5, 0.005));
}

/// The table itself gives each index its probability, not only within the noise of samples.
TEST(DiscreteDistribution, E7_table_is_exact) {
    const std::vector<double> weights = {0, 3, 0, 1e-3, 0, 10, 7, 0};
    const DiscreteDistribution d(weights);
    std::vector<double> measured(weights.size());
    constexpr int steps = 1 << 20;
    for (int i = 0; i < steps; ++i) measured[d.sample((i + 0.5) / steps)] += 1.0 / steps;
    for (std::uint32_t i = 0; i < weights.size(); ++i) {
        EXPECT_NEAR(measured[i], d.pmf(i), 1e-5);
        if (weights[i] == 0) {
            EXPECT_EQ(measured[i], 0);
        }
    }
}

TEST(DiscreteDistribution, E5_dim_beside_bright) {
    const DiscreteDistribution d(std::vector<double>{1e12, 1, 0});
    EXPECT_NEAR(d.pmf(1) * 1e12, 1, 1e-9);
    EXPECT_EQ(d.sample(1.0 / 3), 1u) << "the start of the dim light's column";
    for (const double u : edges) EXPECT_NE(d.sample(u), 2u);
}

TEST(DiscreteDistribution, zero_bins_are_never_drawn) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const std::vector<double> weights = random_weights(1 + seed % 17, seed);
        const DiscreteDistribution d(weights);
        if (d.empty()) continue;
        Rng rng(seed);
        for (int i = 0; i < 500; ++i) EXPECT_GT(d.pmf(d.sample(rng.next_double())), 0);
        for (const double u : edges) EXPECT_GT(d.pmf(d.sample(u)), 0);
        for (std::size_t i = 0; i <= weights.size(); ++i) {
            const double u = static_cast<double>(i) / static_cast<double>(weights.size());
            EXPECT_GT(d.pmf(d.sample(u)), 0);
        }
    }
}

TEST(DiscreteDistribution, E1_E4_nothing_to_draw) {
    EXPECT_TRUE(DiscreteDistribution().empty());
    EXPECT_TRUE(DiscreteDistribution(std::vector<double>{}).empty());
    const DiscreteDistribution d(std::vector<double>{0, 0});
    EXPECT_TRUE(d.empty());
    EXPECT_EQ(d.pmf(d.sample(0.5)), 0);
    for (const double bad : {-1.0, std::nan(""), HUGE_VAL}) {
        EXPECT_THROW(DiscreteDistribution(std::vector<double>{1, bad}), std::invalid_argument);
    }
}

TEST(PiecewiseConstant1D, C22_samples_follow_the_density) {
    const std::vector<double> weights = random_weights(300, 5);
    const PiecewiseConstant1D d(weights);
    constexpr int samples = 1000000;
    std::vector<double> observed(weights.size()), expected(weights.size());
    Rng rng(6);
    for (int i = 0; i < samples; ++i) {
        const auto [x, pdf, index] = d.sample(rng.next_double());
        ++observed[static_cast<std::size_t>(index)];
        ASSERT_EQ(d.pdf(x), pdf);
    }
    for (int i = 0; i < d.size(); ++i) expected[static_cast<std::size_t>(i)] = d.pmf(i) * samples;
    EXPECT_TRUE(counts_match(observed, expected));
    for (const double u : edges) EXPECT_GT(d.sample(u).pdf, 0);
    EXPECT_EQ(d.pdf(-0.1f), 0);
    EXPECT_EQ(d.pdf(1.1f), 0);
}

TEST(PiecewiseConstant2D, C11_one_hot_texel) {
    constexpr int width = 1024, height = 512;
    std::vector<float> texels(width * height, 1.0f);
    texels[128 * width + 700] = 1e6f;
    const PiecewiseConstant2D d(texels, width, height);
    const double total = 1e6 + width * height - 1;
    RunningStatistics hot;
    Rng rng(7);
    for (int i = 0; i < 200000; ++i) {
        const double x = rng.next_double(), y = rng.next_double();
        const PiecewiseConstant2D::Sample s = d.sample({x, y});
        const Vector2i cell(s.p * Vector2(width, height));
        hot.add(cell == Vector2i(700, 128) ? 1 : 0);
        ASSERT_EQ(d.pdf(s.p), s.pdf);
        const float texel = texels[static_cast<std::size_t>(cell.y * width + cell.x)];
        ASSERT_NEAR(s.pdf / (texel * width * height / total), 1, 1e-6);
    }
    EXPECT_TRUE(equivalent(hot, 1e6 / total, 0.01));
}

TEST(PiecewiseConstant2D, density_integrates_to_one_and_zero_cells_stay_empty) {
    const std::vector<double> doubles = random_weights(37 * 23, 8);
    std::vector<float> weights(doubles.begin(), doubles.end());
    std::fill_n(weights.begin() + 37 * 22, 37, 0.0f);
    const PiecewiseConstant2D d(weights, 37, 23);
    double sum = 0;
    for (int y = 0; y < 23; ++y) {
        for (int x = 0; x < 37; ++x) {
            sum +=
                d.pdf({(static_cast<float>(x) + 0.5f) / 37, (static_cast<float>(y) + 0.5f) / 23});
        }
    }
    EXPECT_NEAR(sum / (37 * 23), 1, 1e-6);
    Rng rng(9);
    for (int i = 0; i < 100000; ++i) EXPECT_GT(d.sample(rng.next_float2()).pdf, 0);
    for (const double x : edges) {
        for (const double y : edges) {
            const PiecewiseConstant2D::Sample s = d.sample({x, y});
            EXPECT_GT(s.pdf, 0);
            EXPECT_TRUE(s.p.x >= 0 && s.p.x < 1 && s.p.y >= 0 && s.p.y < 1);
        }
    }
}

/// Cells of all kinds, and a size that is no multiple of a tile.
TEST(PiecewiseConstant2D, C22_samples_follow_the_density) {
    constexpr int width = 45, height = 19;
    std::vector<float> weights(width * height);
    Rng rng(10);
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const bool smooth = i % width < 24;
        weights[i] = smooth ? 1 + 0.2f * rng.next_float() : std::max(rng.next_float() - 0.3f, 0.0f);
    }
    const PiecewiseConstant2D d(weights, width, height);
    constexpr int samples = 1000000;
    std::vector<double> observed(weights.size()), expected(weights.size());
    for (int i = 0; i < samples; ++i) {
        const PiecewiseConstant2D::Sample s = d.sample({rng.next_double(), rng.next_double()});
        ASSERT_EQ(d.pdf(s.p), s.pdf);
        const Vector2i cell(s.p * Vector2(width, height));
        ++observed[static_cast<std::size_t>(cell.x + width * cell.y)];
    }
    double total = 0;
    for (const float w : weights) total += static_cast<double>(w);
    for (int i = 0; i < width * height; ++i) {
        const Vector2 center((static_cast<float>(i % width) + 0.5f) / width,
                             (static_cast<float>(i / width) + 0.5f) / height);
        const double density = static_cast<double>(d.pdf(center));
        expected[static_cast<std::size_t>(i)] = density / (width * height) * samples;
        // Alike cells share a density; all others have their own.
        const double own = static_cast<double>(weights[static_cast<std::size_t>(i)]) / total;
        EXPECT_NEAR(density / (width * height), own, i % width < 24 ? 0.25 * own : 1e-6 * own);
    }
    EXPECT_TRUE(counts_match(observed, expected));
}

TEST(PiecewiseConstant2D, C12_C13_black_and_tiny_images) {
    const PiecewiseConstant2D black(std::vector<float>(6, 0.0f), 3, 2);
    EXPECT_TRUE(black.empty());
    EXPECT_EQ(black.sample({0.5, 0.5}).pdf, 0);
    EXPECT_EQ(black.pdf({0.5f, 0.5f}), 0);
    EXPECT_TRUE(PiecewiseConstant2D().empty());
    EXPECT_EQ(PiecewiseConstant2D().pdf({0.5f, 0.5f}), 0);
    const PiecewiseConstant2D one(std::vector<float>{3}, 1, 1);
    EXPECT_EQ(one.pdf({0.2f, 0.7f}), 1);
    EXPECT_EQ(one.sample({0.25, 0.75}).p, Vector2(0.25f, 0.75f));
    EXPECT_THROW(PiecewiseConstant2D(std::vector<float>(5), 3, 2), std::invalid_argument);
}

}  // namespace lucerna
