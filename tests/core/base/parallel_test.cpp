// SPDX-License-Identifier: Apache-2.0
/// Work on many threads.
#include "core/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <stdexcept>
#include <vector>

namespace lucerna {
namespace {

TEST(Workers, run_each_task_once) {
    for (const int threads : {0, 1, 2, 5}) {
        const Workers workers(threads);
        std::vector<std::atomic<int>> calls(1000);
        workers.run(1000, [&](std::int64_t i) { ++calls[static_cast<std::size_t>(i)]; });
        for (const auto& n : calls) EXPECT_EQ(n, 1);
        EXPECT_GE(workers.count(), 1);
    }
    Workers(2).run(0, [](std::int64_t) { FAIL(); });
}

TEST(Workers, hand_on_exceptions) {
    const Workers workers(2);
    EXPECT_THROW(workers.run(100,
                             [](std::int64_t i) {
                                 if (i == 42) throw std::runtime_error("42");
                             }),
                 std::runtime_error);
}

/// Twice the smallest denormal, unless denormals are zero. Not known to the compiler.
float twice_denormal() {
    volatile float x = std::numeric_limits<float>::denorm_min();
    return x * 2;
}

TEST(Workers, N11_denormals_are_zero_in_every_worker_and_nowhere_else) {
#if defined(__SSE__)
    const Workers workers(3);
    std::atomic<int> not_flushed = 0;
    workers.run(1000, [&](std::int64_t) { not_flushed += twice_denormal() != 0; });
    EXPECT_EQ(not_flushed, 0);
#endif
    EXPECT_NE(twice_denormal(), 0);
}

}  // namespace
}  // namespace lucerna
