// SPDX-License-Identifier: Apache-2.0
#include "core/render/parallel.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_scheduler_observer.h>

#if defined(__SSE__)
#include <immintrin.h>
#endif

namespace lucerna {

namespace {

/// Sets the mode of each thread that enters the arena, and restores it when the thread leaves:
/// a thread that comes from outside keeps its own.
class FlushDenormals final : public tbb::task_scheduler_observer {
public:
    explicit FlushDenormals(tbb::task_arena& arena) : task_scheduler_observer(arena) {
        observe(true);
    }
    ~FlushDenormals() override { observe(false); }

#if defined(__SSE__)
    void on_scheduler_entry(bool) override {
        before_ = _mm_getcsr();
        _mm_setcsr(before_ | 0x8040u);  // FTZ and DAZ
    }
    void on_scheduler_exit(bool) override { _mm_setcsr(before_); }

private:
    static thread_local unsigned before_;
#endif
};

#if defined(__SSE__)
thread_local unsigned FlushDenormals::before_ = 0x1f80;
#endif

}  // namespace

struct Workers::State {
    explicit State(int threads)
        : count(threads > 0 ? threads : tbb::info::default_concurrency()),
          // Without it there are never more threads than processors.
          limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count)),
          arena(count),
          flush_denormals(arena) {}

    int count;
    tbb::global_control limit;
    tbb::task_arena arena;
    FlushDenormals flush_denormals;
};

Workers::Workers(int count) : state_(std::make_unique<State>(count)) {}

Workers::~Workers() = default;

int Workers::count() const { return state_->count; }

void Workers::run(std::int64_t count, const std::function<void(std::int64_t)>& task) const {
    state_->arena.execute(
        [&] { tbb::parallel_for(std::int64_t{0}, count, task, tbb::simple_partitioner{}); });
}

}  // namespace lucerna
