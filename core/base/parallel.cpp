// SPDX-License-Identifier: Apache-2.0
#include "core/base/parallel.h"

#if defined(__SSE__)
#include <immintrin.h>
#endif

#if defined(__SANITIZE_THREAD__)
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>
#else
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>
#endif

namespace lucerna {

namespace {

/// Denormals are zero on this thread as long as it lives.
class FlushDenormals {
public:
#if defined(__SSE__)
    FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040u); }
    ~FlushDenormals() { _mm_setcsr(before_); }
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

private:
    unsigned before_;
#endif
};

}  // namespace

#if defined(__SANITIZE_THREAD__)

// TBB is not compiled with the thread sanitizer, which then cannot see how its tasks are ordered,
// and sees races everywhere. Threads of the C++ library do the same, slowly.
struct Workers::State {
    int count;
};

Workers::Workers(int count)
    : state_(std::make_unique<State>(
          State{count > 0 ? count : static_cast<int>(std::thread::hardware_concurrency())})) {}

void Workers::run(std::int64_t count, const std::function<void(std::int64_t)>& task) const {
    std::atomic<std::int64_t> next{0};
    std::mutex mutex;
    std::exception_ptr first;
    const auto work = [&] {
        const FlushDenormals flush_denormals;
        try {
            for (std::int64_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;) {
                task(i);
            }
        } catch (...) {
            next = count;
            const std::scoped_lock lock(mutex);
            if (!first) first = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> others;
        for (int i = 1; i < state_->count; ++i) others.emplace_back(work);
        work();
    }
    if (first) std::rethrow_exception(first);
}

#else

struct Workers::State {
    explicit State(int threads)
        // Without it there are never more threads than processors.
        : limit(Control::max_allowed_parallelism,
                static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency())),
          // Others can have set a lower limit: Embree does.
          count(static_cast<int>(Control::active_value(Control::max_allowed_parallelism))),
          arena(count) {}

    using Control = tbb::global_control;
    Control limit;
    int count;
    tbb::task_arena arena;
};

Workers::Workers(int count) : state_(std::make_unique<State>(count)) {}

void Workers::run(std::int64_t count, const std::function<void(std::int64_t)>& task) const {
    // TBB gives every thread that works for a context the mode in which the context was made, and
    // takes it away again. (A task_scheduler_observer comes too early: its mode is overwritten.)
    using Context = tbb::task_group_context;
    const FlushDenormals flush_denormals;
    Context context(Context::isolated, Context::default_traits | Context::fp_settings);
    state_->arena.execute([&] {
        tbb::parallel_for(std::int64_t{0}, count, task, tbb::simple_partitioner{}, context);
    });
}

#endif

Workers::~Workers() = default;

int Workers::count() const { return state_->count; }

}  // namespace lucerna
