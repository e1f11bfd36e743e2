// SPDX-License-Identifier: Apache-2.0
#include "core/render/parallel.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#if defined(__SSE__)
#include <immintrin.h>
#endif

#include <atomic>

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

/// TBB is not compiled with the thread sanitizer, which so cannot see that tasks come after what
/// was before them and before what comes after; this tells it.
void mark_order() {
#if defined(__SANITIZE_THREAD__)
    static std::atomic<int> order;
    order.fetch_add(1);
#endif
}

}  // namespace

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

Workers::~Workers() = default;

int Workers::count() const { return state_->count; }

void Workers::run(std::int64_t count, const std::function<void(std::int64_t)>& task) const {
    // TBB gives every thread that works for a context the mode in which the context was made, and
    // takes it away again. (A task_scheduler_observer comes too early: its mode is overwritten.)
    using Context = tbb::task_group_context;
    const FlushDenormals flush_denormals;
    Context context(Context::isolated, Context::default_traits | Context::fp_settings);
    const auto body = [&task](std::int64_t i) {
        mark_order();
        task(i);
        mark_order();
    };
    mark_order();
    state_->arena.execute([&] {
        tbb::parallel_for(std::int64_t{0}, count, body, tbb::simple_partitioner{}, context);
    });
    mark_order();
}

}  // namespace lucerna
