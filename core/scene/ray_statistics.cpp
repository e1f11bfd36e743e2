// SPDX-License-Identifier: Apache-2.0
#include "core/scene/ray_statistics.h"

#include <mutex>
#include <vector>

namespace lucerna {

namespace {

/// Counters of running threads, and the sum of those that have ended.
struct AllThreads {
    std::mutex mutex;
    std::vector<const RayStatistics*> running;
    RayStatistics ended;
};

AllThreads& all_threads() {
    // Never destroyed: worker threads may end after the static objects.
    static AllThreads& instance = *new AllThreads;
    return instance;
}

void add(RayStatistics& sum, const RayStatistics& part) {
    sum.intersections += part.intersections;
    sum.occlusions += part.occlusions;
    sum.blocked += part.blocked;
    sum.dropped += part.dropped;
    sum.rejected += part.rejected;
}

struct ThreadCounters {
    RayStatistics counters;

    ThreadCounters() {
        AllThreads& all = all_threads();
        const std::scoped_lock lock(all.mutex);
        all.running.push_back(&counters);
    }
    ~ThreadCounters() {
        AllThreads& all = all_threads();
        const std::scoped_lock lock(all.mutex);
        add(all.ended, counters);
        std::erase(all.running, &counters);
    }
};

}  // namespace

RayStatistics& thread_ray_statistics() {
    thread_local ThreadCounters mine;
    return mine.counters;
}

RayStatistics ray_statistics() {
    AllThreads& all = all_threads();
    const std::scoped_lock lock(all.mutex);
    RayStatistics sum = all.ended;
    for (const RayStatistics* counters : all.running) add(sum, *counters);
    return sum;
}

}  // namespace lucerna
