// SPDX-License-Identifier: Apache-2.0
/// When a render is done, and how its samples are dealt out in passes until then.
#pragma once

#include <cstdint>
#include <optional>

namespace lucerna {

/// A render stops at the first limit that it reaches. There must be one.
struct RenderBudget {
    std::optional<std::uint64_t> samples = {};  ///< per pixel
    std::optional<double> seconds = {};         ///< of this run, without loading and building
    std::optional<double> error = {};           ///< relative MSE (error_estimate.h)
};

/// Samples begin, …, end − 1 of every pixel.
struct SampleRange {
    std::uint64_t begin = 0;
    std::uint64_t end = 0;
    std::uint64_t size() const { return end - begin; }
};

/// Plans passes: 1, 1, 2, 4, … samples, as long as a pass stays near a second, so that looking at
/// clock, error and signals between them costs nothing and is never far away. The image does not
/// depend on how samples are split into passes.
class PassPlan {
public:
    /// `done` samples of every pixel exist already; counting starts at `first`.
    PassPlan(const RenderBudget& budget, std::uint64_t first, std::uint64_t done);

    /// The next pass, if samples and time are left for one. Without any sample so far, there is
    /// one.
    std::optional<SampleRange> next(double elapsed_seconds) const;
    /// A pass has been done and has taken so long.
    void finished(SampleRange pass, double seconds);

    std::uint64_t samples_done() const { return done_; }
    /// The error is to be looked at after these passes only: 2, 4, 6, 8, 10, 12, 14, 16, 20, 24, …
    /// samples. So a render with an error target, too, is a function of scene and seed.
    bool at_error_check() const { return done_ > 0 && next_error_check(done_ - 1) == done_; }

private:
    /// The first number of samples > `done` after which the error is looked at.
    static std::uint64_t next_error_check(std::uint64_t done);

    RenderBudget budget_;
    std::uint64_t first_, done_;
    double seconds_per_sample_ = 0;
};

}  // namespace lucerna
