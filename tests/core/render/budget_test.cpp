// SPDX-License-Identifier: Apache-2.0
/// How samples are dealt out in passes.
#include "core/render/budget.h"

#include <gtest/gtest.h>

#include <vector>

namespace lucerna {
namespace {

std::vector<std::uint64_t> pass_sizes(PassPlan plan, double seconds_per_sample,
                                      double start_seconds = 0) {
    std::vector<std::uint64_t> sizes;
    double elapsed = start_seconds;
    while (const auto pass = plan.next(elapsed)) {
        sizes.push_back(pass->size());
        const double seconds = static_cast<double>(pass->size()) * seconds_per_sample;
        elapsed += seconds;
        plan.finished(*pass, seconds);
        if (sizes.size() > 1000) break;
    }
    return sizes;
}

TEST(PassPlan, doubles_until_all_samples_are_done) {
    EXPECT_EQ(pass_sizes(PassPlan({.samples = 20}, 0, 0), 1e-6),
              (std::vector<std::uint64_t>{1, 1, 2, 4, 8, 4}));
    EXPECT_TRUE(pass_sizes(PassPlan({.samples = 20}, 0, 20), 1e-6).empty());
    EXPECT_EQ(pass_sizes(PassPlan({.samples = 20}, 0, 17), 1e-6), (std::vector<std::uint64_t>{3}));
}

TEST(PassPlan, keeps_passes_short) {
    for (const std::uint64_t size : pass_sizes(PassPlan({.samples = 500}, 0, 0), 0.1)) {
        EXPECT_LE(size, 5u);
    }
    // A sample that takes longer cannot be split.
    for (const std::uint64_t size : pass_sizes(PassPlan({.samples = 20}, 0, 0), 3)) {
        EXPECT_EQ(size, 1u);
    }
}

TEST(PassPlan, N14_keeps_to_the_time) {
    std::uint64_t samples = 0;
    for (const std::uint64_t n : pass_sizes(PassPlan({.seconds = 10}, 0, 0), 0.03)) samples += n;
    EXPECT_EQ(samples, 333u);
    // Too little time even for one: there must be a picture.
    EXPECT_EQ(pass_sizes(PassPlan({.seconds = 1}, 0, 0), 5), (std::vector<std::uint64_t>{1}));
    EXPECT_TRUE(pass_sizes(PassPlan({.seconds = 1}, 0, 7), 5, 2).empty());
}

TEST(PassPlan, first_limit_ends_it) {
    EXPECT_EQ(pass_sizes(PassPlan({.samples = 8, .seconds = 1e6}, 0, 0), 0.01).size(), 4u);
    EXPECT_LE(pass_sizes(PassPlan({.samples = 1000000, .seconds = 1}, 0, 0), 0.25).size(), 4u);
}

/// Where the error is looked at must not depend on how fast the machine is.
TEST(PassPlan, error_is_looked_at_after_the_same_samples) {
    const auto checks = [](double seconds_per_sample) {
        PassPlan plan({.samples = 300, .error = 1e-3}, 0, 0);
        std::vector<std::uint64_t> result;
        while (const auto pass = plan.next(0)) {
            plan.finished(*pass, static_cast<double>(pass->size()) * seconds_per_sample);
            if (plan.at_error_check()) result.push_back(plan.samples_done());
        }
        return result;
    };
    const std::vector<std::uint64_t> fast = checks(1e-9);
    EXPECT_EQ(fast, checks(0.4));
    EXPECT_EQ(fast, checks(0.07));
    for (std::size_t i = 4; i < fast.size(); ++i) {
        EXPECT_LE(static_cast<double>(fast[i]), 1.26 * static_cast<double>(fast[i - 1]));
        EXPECT_EQ(fast[i] % 2, 0u) << "halves of different sizes";
    }
}

TEST(PassPlan, counts_from_the_first_sample) {
    const PassPlan plan({.samples = 8}, 100, 2);
    EXPECT_EQ(plan.next(0)->begin, 102u);
    EXPECT_EQ(plan.next(0)->end, 104u);
}

}  // namespace
}  // namespace lucerna
