// SPDX-License-Identifier: Apache-2.0
/// Counts of rays, kept per thread so that counting shares nothing between threads.
#pragma once

#include <cstdint>

namespace lucerna {

struct RayStatistics {
    std::uint64_t intersections = 0;  ///< rays for the nearest hit
    std::uint64_t occlusions = 0;     ///< rays that only ask whether something is in the way
    std::uint64_t blocked = 0;        ///< those of them for which there was
    std::uint64_t dropped = 0;        ///< rays that were not finite, and were not traced
    std::uint64_t rejected = 0;       ///< hits outside their own primitive, passed over

    std::uint64_t rays() const { return intersections + occlusions; }
};

/// Sums over all threads since the program started. Exact when no thread is tracing.
RayStatistics ray_statistics();

/// The counters of the calling thread.
RayStatistics& thread_ray_statistics();

}  // namespace lucerna
