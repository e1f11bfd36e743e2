// SPDX-License-Identifier: Apache-2.0
#include "core/render/budget.h"

#include <algorithm>
#include <bit>

namespace lucerna {

namespace {

constexpr double longest_pass_seconds = 0.5;
constexpr std::uint64_t largest_pass = 4096;

}  // namespace

PassPlan::PassPlan(const RenderBudget& budget, std::uint64_t first, std::uint64_t done)
    : budget_(budget), first_(first), done_(done) {}

std::uint64_t PassPlan::next_error_check(std::uint64_t done) {
    if (done < 8) return done + 2 - done % 2;
    const std::uint64_t step = std::bit_floor(done) / 4;
    return (done / step + 1) * step;
}

std::optional<SampleRange> PassPlan::next(double elapsed_seconds) const {
    // As many as there are, at least one: a pass at most doubles what there is.
    std::uint64_t size = std::clamp(done_, std::uint64_t{1}, largest_pass);
    if (budget_.samples) {
        if (done_ >= *budget_.samples) return {};
        size = std::min(size, *budget_.samples - done_);
    }
    if (budget_.error) size = std::min(size, next_error_check(done_) - done_);
    if (seconds_per_sample_ > 0) {
        const double most = longest_pass_seconds / seconds_per_sample_;
        if (most < static_cast<double>(size)) {
            size = std::max(std::uint64_t{1}, static_cast<std::uint64_t>(most));
        }
    }
    if (budget_.seconds && done_ > 0) {
        const double left = *budget_.seconds - elapsed_seconds;
        if (left <= 0 || left < seconds_per_sample_) return {};
        if (seconds_per_sample_ > 0 && left / seconds_per_sample_ < static_cast<double>(size)) {
            size = static_cast<std::uint64_t>(left / seconds_per_sample_);
        }
    }
    return SampleRange{first_ + done_, first_ + done_ + size};
}

void PassPlan::finished(SampleRange pass, double seconds) {
    done_ = pass.end - first_;
    seconds_per_sample_ = seconds / static_cast<double>(pass.size());
}

}  // namespace lucerna
