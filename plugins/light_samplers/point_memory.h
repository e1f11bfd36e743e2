// SPDX-License-Identifier: Apache-2.0
/// What a thread has computed at the points that it met last: the draws at a point, and the
/// probabilities that are asked for there, begin with the same numbers.
#pragma once

#include "plugins/light_samplers/fine_bits.h"

#include <atomic>
#include <vector>

namespace lucerna {

/// `size` is how many points: large where an integrator asks about many in turn.
template <typename T, std::size_t size = 1024>
class PointMemory {
public:
    /// Forgets what it knows: before it is used for another scene.
    void clear() {
        static std::atomic<std::uint64_t> count{0};
        id_ = ++count;
    }
    /// The value at a point, which `compute(at, value)` has written. Valid until the thread asks
    /// again.
    template <typename Compute>
    const T& at(const Receiver& at, const Compute& compute) const {
        thread_local std::vector<Entry> entries(size);
        Entry& entry = entries[hash_of(at.p, id_) % size];
        if (entry.owner != id_ || !is_same_place(entry.at, at)) {
            entry.owner = 0;
            compute(at, entry.value);
            entry.owner = id_;
            entry.at = at;
        }
        return entry.value;
    }

private:
    struct Entry {
        std::uint64_t owner = 0;
        Receiver at;
        T value;
    };
    std::uint64_t id_ = 0;
};

}  // namespace lucerna
