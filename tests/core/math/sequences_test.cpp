// SPDX-License-Identifier: Apache-2.0
#include "core/math/sequences.h"

#include "tests/statistics.h"

#include <set>

namespace lucerna {
namespace {

/// |r| < 4 / √n for two streams of numbers in [0, 1).
template <typename A, typename B>
testing::AssertionResult uncorrelated(A a, B b, int n) {
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double x = a(i), y = b(i);
        sum += (x - 0.5) * (y - 0.5);
    }
    const double r = 12 * sum / n;
    if (std::abs(r) < 4 / std::sqrt(n)) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "r = " << r;
}

/// Whether 2^k points have one in each elementary interval of area 2^−k.
bool is_a_net(std::uint64_t first, int k, std::uint64_t seed) {
    for (int columns = 0; columns <= k; ++columns) {
        std::set<std::uint64_t> cells;
        for (std::uint64_t i = 0; i < 1u << k; ++i) {
            const SobolPoint p = sobol_owen_2d_bits(first + i, seed);
            const std::uint64_t x = static_cast<std::uint64_t>(p.x) >> (32 - columns);
            const std::uint64_t y = static_cast<std::uint64_t>(p.y) >> (32 - (k - columns));
            cells.insert((x << 32) | y);
        }
        if (cells.size() != 1u << k) return false;
    }
    return true;
}

/// The second Sobol' coordinate by its direction numbers.
std::uint32_t sobol_second(std::uint32_t index) {
    std::uint32_t result = 0;
    for (std::uint32_t v = 1u << 31; index; index >>= 1, v ^= v >> 1) {
        if (index & 1) result ^= v;
    }
    return result;
}

}  // namespace

TEST(Sequences, J1_never_one) {
    for (std::uint32_t i = 0; i < 256; ++i) {
        EXPECT_LT(uint_to_float(0xffffffffu - i), 1.0f);
        EXPECT_LT(uint_to_double(0xffffffffu - i), 1.0);
    }
    EXPECT_EQ(uint_to_float(0xffffffffu), one_minus_epsilon);
    EXPECT_EQ(uint_to_float(0), 0.0f);
    EXPECT_LT(uint64_to_double(~std::uint64_t{0}), 1.0);
}

TEST(Sequences, J3_J4_neighbouring_seeds_and_streams) {
    constexpr int n = 20000;
    for (std::uint64_t s = 0; s < 50; ++s) {
        Rng a(s), b(s + 1), c(s, 1), d(s, 2);
        const auto from = [](Rng& rng) { return [&rng](int) { return rng.next_double(); }; };
        EXPECT_TRUE(uncorrelated(from(a), from(b), n)) << "seed " << s;
        EXPECT_TRUE(uncorrelated(from(c), from(d), n)) << "streams of seed " << s;
        const auto x_of = [](std::uint64_t seed) {
            return [seed](int i) {
                return uint_to_double(sobol_owen_2d_bits(static_cast<std::uint64_t>(i), seed).x);
            };
        };
        EXPECT_TRUE(uncorrelated(x_of(s), x_of(s + 1), n)) << "Sobol' seed " << s;
    }
    EXPECT_NE(hash64({1, 2}), hash64({2, 1}));
    EXPECT_NE(hash64({0}), hash64({0, 0}));
}

TEST(Sequences, first_numbers_of_many_seeds_are_uniform) {
    constexpr int seeds = 200000, cells = 256;
    std::vector<double> rng(cells), sobol(cells), expected(cells, seeds / double{cells});
    for (std::uint64_t s = 0; s < seeds; ++s) {
        const Vector2 a = Rng(s).next_float2(), b = sobol_owen_2d(0, s);
        const auto cell = [](Vector2 p) {
            return static_cast<std::size_t>(16 * std::floor(16 * p.x) + std::floor(16 * p.y));
        };
        ++rng[cell(a)];
        ++sobol[cell(b)];
    }
    EXPECT_TRUE(counts_match(rng, expected));
    EXPECT_TRUE(counts_match(sobol, expected));
}

TEST(Sequences, pascal_matrix_gives_the_second_sobol_coordinate) {
    Rng rng(3);
    for (std::uint32_t i = 0; i < 10000; ++i) {
        const std::uint32_t x = rng.next_uint();
        EXPECT_EQ(reverse_bits(multiply_by_pascal(i)), sobol_second(i));
        EXPECT_EQ(reverse_bits(multiply_by_pascal(x)), sobol_second(x));
        EXPECT_EQ(reverse_bits(reverse_bits(x)), x);
    }
}

TEST(Sequences, J9_elementary_intervals) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        for (int k = 0; k <= 10; ++k) {
            EXPECT_TRUE(is_a_net(0, k, seed)) << "seed " << seed << ", 2^" << k;
            EXPECT_TRUE(is_a_net(std::uint64_t{5} << k, k, seed)) << "later block";
        }
        std::set<std::uint32_t> cells;
        for (std::uint32_t i = 0; i < 1024; ++i) cells.insert(sobol_owen_1d_bits(i, seed) >> 22);
        EXPECT_EQ(cells.size(), 1024u);
    }
}

/// Pairs of the dimensions 0 … 2047 of padded pairs.
TEST(Sequences, J5_padded_dimensions_fill_the_square) {
    constexpr int grid = 16, samples = 2048, pairs = 4096;
    const std::vector<double> expected(grid * grid, double{samples} / (grid * grid));
    Rng rng(5);
    RunningStatistics within;
    for (int pair = 0; pair < pairs; ++pair) {
        const std::uint64_t a = pair < 2047 ? static_cast<unsigned>(pair) : rng.next_uint() % 2048;
        const std::uint64_t b = pair < 2047 ? a + 1 : (a + 1 + rng.next_uint() % 2047) % 2048;
        const auto cell = [a, b](std::uint64_t index, std::uint64_t pixel) {
            const auto coordinate = [&](std::uint64_t dimension) {
                const SobolPoint p = sobol_owen_2d_bits(index, hash64({pixel, dimension / 2}));
                return (dimension % 2 ? p.y : p.x) >> 28;
            };
            return coordinate(a) * grid + coordinate(b);
        };
        // One sample of many pixels: independent points.
        std::vector<double> across(grid * grid), counts(grid * grid);
        for (std::uint64_t i = 0; i < samples; ++i) {
            ++across[cell(7, i)];
            ++counts[cell(i, 1)];
        }
        EXPECT_TRUE(counts_match(across, expected, sidak(1e-3, pairs))) << a << ", " << b;
        double statistic = 0;
        for (const double c : counts) statistic += sqr(c - expected[0]) / expected[0];
        within.add(statistic);
        // Far above the scatter of shuffled nets, far below what equal dimensions give: 15 · 2048.
        if (a / 2 != b / 2) {
            EXPECT_LT(statistic, 1000) << a << ", " << b;
        }
    }
    EXPECT_LT(within.mean(), 256);
}

TEST(Sequences, J7_indices_beyond_32_bits) {
    constexpr std::uint64_t turn = std::uint64_t{1} << 32;
    EXPECT_NE(sobol_owen_2d_bits(turn, 1).x, sobol_owen_2d_bits(0, 1).x);
    EXPECT_NE(sobol_owen_2d_bits(turn + 1, 1).x, sobol_owen_2d_bits(turn - 1, 1).x);
    EXPECT_TRUE(is_a_net(turn, 8, 1));
    EXPECT_TRUE(is_a_net(turn - 256, 8, 1));
    EXPECT_TRUE(uncorrelated(
        [](int i) { return sobol_owen_1d(static_cast<std::uint64_t>(i), 1); },
        [](int i) { return sobol_owen_1d(turn + static_cast<std::uint64_t>(i), 1); }, 20000));
}

TEST(Sequences, integration_error_falls_faster_than_by_chance) {
    double squared = 0;
    constexpr int n = 1024, seeds = 64;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        double sum = 0;
        for (std::uint64_t i = 0; i < n; ++i) {
            const Vector2 u = sobol_owen_2d(i, seed);
            sum += u.x * u.y;
        }
        squared += sqr(sum / n - 0.25) / seeds;
    }
    const double by_chance = (1.0 / 9 - 1.0 / 16) / n;
    EXPECT_LT(squared, 0.01 * by_chance);
}

}  // namespace lucerna
