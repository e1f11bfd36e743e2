// SPDX-License-Identifier: Apache-2.0
/// Packed sums give back every bit, whatever the sums, and damage does no harm.
#include "core/render/packed_sums.h"

#include "core/math/sequences.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace lucerna {
namespace {

std::span<const std::uint8_t> bytes_of(const std::string& text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string packed(const std::vector<ExactSum>& sums) {
    std::string bytes;
    pack_sums({.first = sums.data(), .count = sums.size()}, bytes);
    return bytes;
}

void expect_bits(const std::vector<ExactSum>& sums) {
    const std::string bytes = packed(sums);
    std::vector<ExactSum> again(sums.size());
    PackedSums reader(bytes_of(bytes));
    ASSERT_TRUE(reader.add_to({.first = again.data(), .count = again.size()}));
    EXPECT_TRUE(reader.at_end());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        EXPECT_EQ(again[i].high, sums[i].high) << i;
        EXPECT_EQ(again[i].low, sums[i].low) << i;
    }
}

/// Sums of floats of any exponent in the range, with weights.
std::vector<ExactSum> random_sums(Rng& rng, std::size_t count, int exponents, bool negative) {
    std::vector<ExactSum> sums(count);
    for (ExactSum& sum : sums) {
        for (int i = 0; i < 40; ++i) {
            const int exponent =
                static_cast<int>(rng.next_uint() % static_cast<unsigned>(exponents + 1));
            const float value = std::ldexp(rng.next_float() + 0.5f, -exponent);
            const double weight = rng.next_uint() >> 5;
            const double sign = negative && rng.next_uint() % 2 == 0 ? -1 : 1;
            sum.add(sign * static_cast<double>(value) * weight);
        }
    }
    return sums;
}

TEST(PackedSums, HoldEveryBit) {
    Rng rng(3);
    for (const std::size_t count : {1u, 2u, 63u, 64u, 65u, 1000u}) {
        for (const int exponents : {0, 3, 10, 20, 30, 60, 120}) {
            expect_bits(random_sums(rng, count, exponents, false));
            expect_bits(random_sums(rng, count, exponents, true));
        }
    }
    expect_bits({});
    expect_bits(std::vector<ExactSum>(100));
    constexpr double most = std::numeric_limits<double>::max();
    constexpr double least = std::numeric_limits<double>::denorm_min();
    expect_bits({{.high = most}, {.high = -most}, {.high = least}, {.high = 1, .low = 0x1p-54}});
    expect_bits({{.high = 1, .low = -0x1p-54}, {.high = 0x1p100, .low = 1}});
    expect_bits({{.high = most, .low = least}, {}});
}

TEST(PackedSums, AreShortIfSumsAreAlike) {
    Rng rng(4);
    const std::size_t count = 64000;
    // 24 bits of a float, 27 of a weight, 4 of exponents, 6 of 40 terms, and one for a carry.
    EXPECT_LT(packed(random_sums(rng, count, 4, false)).size(), count * 64 / 8);
    EXPECT_EQ(packed(std::vector<ExactSum>(count)).size(), count / 64 * 4);
}

TEST(PackedSums, AreAddedExactly) {
    Rng rng(5);
    std::vector<ExactSum> a = random_sums(rng, 500, 12, true);
    const std::vector<ExactSum> b = random_sums(rng, 500, 12, true);
    std::vector<ExactSum> expected = a;
    for (std::size_t i = 0; i < a.size(); ++i) expected[i].add(b[i]);
    std::vector<ExactSum> unpacked = a;
    add_sums(b.data(), {.first = unpacked.data(), .count = unpacked.size() - 1});
    unpacked.back().add(b.back());
    const std::string bytes = packed(b);
    ASSERT_TRUE(PackedSums(bytes_of(bytes)).add_to({.first = a.data(), .count = a.size()}));
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].high, expected[i].high);
        EXPECT_EQ(a[i].low, expected[i].low);
        EXPECT_EQ(unpacked[i].high, expected[i].high);
        EXPECT_EQ(unpacked[i].low, expected[i].low);
    }
}

TEST(PackedSums, AreTakenOneChannelAfterTheOther) {
    Rng rng(8);
    const std::vector<ExactSum> a = random_sums(rng, 100, 5, false);
    const std::vector<ExactSum> b = random_sums(rng, 100, 90, true);
    const std::string bytes = packed(a) + packed(b);
    PackedSums both(bytes_of(bytes));
    std::optional<PackedSums> first = both.take(100), second = both.take(100);
    ASSERT_TRUE(first && second);
    EXPECT_TRUE(both.at_end());
    EXPECT_FALSE(both.take(1));
    // In groups, by turns.
    std::vector<ExactSum> x(100), y(100);
    for (const std::size_t begin : {0u, 64u}) {
        const std::size_t count = begin == 0 ? 64 : 36;
        ASSERT_TRUE(first->add_to({.first = &x[begin], .count = count}));
        ASSERT_TRUE(second->add_to({.first = &y[begin], .count = count}));
    }
    EXPECT_TRUE(first->at_end() && second->at_end());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(x[i].high, a[i].high);
        EXPECT_EQ(x[i].low, a[i].low);
        EXPECT_EQ(y[i].high, b[i].high);
        EXPECT_EQ(y[i].low, b[i].low);
    }
}

TEST(PackedSums, StridesSkipWhatLiesBetween) {
    Rng rng(6);
    const std::vector<ExactSum> sums = random_sums(rng, 3 * 100, 5, false);
    std::string bytes;
    pack_sums({.first = &sums[1], .count = 100, .stride = 3}, bytes);
    std::vector<ExactSum> again(2 * 100);
    ASSERT_TRUE(
        PackedSums(bytes_of(bytes)).add_to({.first = again.data(), .count = 100, .stride = 2}));
    for (std::size_t i = 0; i < 100; ++i) {
        EXPECT_EQ(again[2 * i].high, sums[3 * i + 1].high);
        EXPECT_EQ(again[2 * i + 1].high, 0);
    }
}

TEST(PackedSums, TruncationIsNoticed) {
    Rng rng(7);
    const std::vector<ExactSum> sums = random_sums(rng, 100, 5, false);
    const std::string bytes = packed(sums);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        std::vector<ExactSum> again(sums.size());
        PackedSums reader(bytes_of(bytes).first(size));
        EXPECT_FALSE(reader.add_to({.first = again.data(), .count = again.size()})) << size;
    }
}

}  // namespace
}  // namespace lucerna
