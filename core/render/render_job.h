// SPDX-License-Identifier: Apache-2.0
/// One render: passes over the film until a budget is spent.
///
/// The image is a function of scene, seed and the range of samples: the same bits for any number of
/// threads, any split into passes, any interruption and resumption.
#pragma once

#include "core/base/parallel.h"
#include "core/interfaces/integrator.h"
#include "core/interfaces/sensor.h"
#include "core/render/budget.h"
#include "core/render/film_state.h"
#include "core/render/reconstruction_filter.h"
#include "core/scene/scene.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <optional>

namespace lucerna {

/// How far a render is.
struct RenderStatus {
    double seconds = 0;                       ///< since it began
    double fraction = 0;                      ///< of the budget, in [0, 1]
    std::optional<double> seconds_left = {};  ///< an estimate
    double samples = 0;                       ///< per pixel, done in this run and before
    double rays_per_second = 0;
    std::optional<ErrorEstimate> error = {};  ///< the last one that was computed
};

struct RenderOptions {
    RenderBudget budget = {};
    std::uint64_t seed = 0;
    int threads = 0;  ///< 0: all processors
    /// Asked often, by many threads; true ends the render within milliseconds.
    std::function<bool()> interrupted = {};
    /// Called about ten times a second, from any thread, but never from two at once.
    std::function<void(const RenderStatus&)> progress = {};
    /// Called after every pass, on the thread that renders.
    std::function<void(const RenderStatus&, const FilmState&)> after_pass = {};
};

class RenderJob {
public:
    /// Makes one camera sample: fills `result` for a camera ray; further random numbers come from
    /// the stream. Called from many threads.
    using Estimator = std::function<void(const Ray&, SampleStream&, PixelSample& result)>;
    /// Makes several camera samples, whole blocks of them (Integrator::block_size).
    using BatchEstimator = std::function<void(std::span<CameraSample>)>;
    /// Does the samples of `range` for all pixels, or stops early if `interrupted()`.
    using Pass = std::function<void(SampleRange range)>;

    /// Goes on from `film`, which must fit the scene: film_layout(). Throws Error if the budget has
    /// no limit.
    RenderJob(const Scene& scene, RenderOptions options, FilmState film);

    const Scene& scene() const { return scene_; }
    const Film& film() const { return scene_.sensor().film(); }
    const Workers& workers() const { return workers_; }
    std::uint64_t seed() const { return options_.seed; }

    /// Passes over all pixels until the budget is spent: all that a path tracer needs.
    void render_samples(const Estimator& estimator);
    /// The same with as many samples at once as take some milliseconds at most.
    void render_batches(const BatchEstimator& estimator);

    /// The loop alone, for integrators whose passes do more, such as tracing photons:
    ///
    ///     job.run_passes([&](SampleRange range) {
    ///         prepare(range);
    ///         job.sample_pixels(range, estimator);
    ///     });
    void run_passes(const Pass& pass);
    /// Adds the samples of a range to all pixels, in parallel. If it is interrupted, some pixels
    /// lack samples; a resumed render begins with them.
    void sample_pixels(SampleRange range, const Estimator& estimator);
    /// The render is to stop as soon as it can.
    bool interrupted() const { return options_.interrupted && options_.interrupted(); }

    const FilmState& state() const { return state_; }
    FilmState take_state() { return std::move(state_); }
    /// As it was after the last pass, with the current error.
    RenderStatus status() const;

private:
    using Clock = std::chrono::steady_clock;
    class Batch;
    void sample_pixels(SampleRange range, const BatchEstimator& estimator, std::size_t most);
    void sample_tile(SampleRange range, const CropWindow& tile, Batch& batch);
    void sample_block(SampleRange range, const CropWindow& tile, const CropWindow& block,
                      Batch& batch);
    void sample_pixel(std::uint64_t index, Vector2i pixel, Vector2i pixel_of_tile, Batch& batch);
    void add(const FilmTile& tile);
    double elapsed() const;
    void finish_pass(const PassPlan& plan);
    void report();
    double fraction(const RenderStatus& status) const;

    const Scene& scene_;
    RenderOptions options_;
    Workers workers_;
    ReconstructionFilter filter_;
    FilmState state_;
    std::vector<std::mutex> band_mutexes_;  ///< each for some rows of pixels
    Clock::time_point start_;
    std::uint64_t rays_before_;
    double rays_per_second_ = 0;
    std::uint64_t samples_;  ///< that every pixel has
    double samples_before_;  ///< that it had when the job began

    /// Samples that are estimated at once, grown and shrunk by what they take.
    std::atomic<std::size_t> batch_size_{1};
    /// Samples per pixel of this pass that are done, summed over tiles.
    std::atomic<std::int64_t> samples_of_tiles_{0};

    std::optional<ErrorEstimate> error_;
    std::uint64_t error_samples_ = 0;  ///< how many there were when the error was computed
    double error_cost_ = 0;            ///< of computing it [s]
    Clock::time_point error_time_, report_time_;
    std::mutex report_mutex_;
};

/// The shape of the film of a scene.
FilmLayout film_layout(const Scene& scene);

}  // namespace lucerna
