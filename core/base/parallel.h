// SPDX-License-Identifier: Apache-2.0
/// Work on many threads. parallel.cpp is the only user of TBB's scheduler.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

namespace lucerna {

/// A number of threads, this one included, that share work. While they work for a `Workers`,
/// denormal numbers are zero (FTZ and DAZ, as Embree asks), on every thread alike.
class Workers {
public:
    /// `count` threads; 0: one for each processor that the process may use. There can be fewer if
    /// another library has limited the threads of the process.
    explicit Workers(int count = 0);
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    int count() const;

    /// Calls task(0) … task(count − 1), each once, in any order, on any threads, and returns when
    /// all have ended. Rethrows the first exception; some tasks are then not called.
    void run(std::int64_t count, const std::function<void(std::int64_t)>& task) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace lucerna
