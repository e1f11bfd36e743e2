// SPDX-License-Identifier: Apache-2.0
#include "core/render/render_job.h"

#include "core/math/sequences.h"
#include "core/plugin/error.h"
#include "core/scene/ray_statistics.h"

#include <algorithm>

namespace lucerna {

namespace {

constexpr int tile_size = 16;
/// The camera's own numbers: position on the film and on the lens.
constexpr std::uint32_t first_integrator_dimension = 4;
constexpr double report_interval = 0.1;
/// Fewer samples can miss all of the light, and the halves then agree.
constexpr std::uint64_t least_samples_for_error = 16;

double seconds_between(std::chrono::steady_clock::time_point a,
                       std::chrono::steady_clock::time_point b) {
    return std::chrono::duration<double>(b - a).count();
}

Vector2i tiles_in(Vector2i size) { return (size + tile_size - 1) / tile_size; }

}  // namespace

FilmLayout film_layout(const Scene& scene) {
    const Film& film = scene.sensor().film();
    return {.full_size = film.size(),
            .crop = film.crop(),
            .layers = scene.integrator().layers(),
            .negative_weight = FilterSampler(film.rfilter()).negative_weight()};
}

RenderJob::RenderJob(const Scene& scene, RenderOptions options, FilmState film)
    : scene_(scene),
      options_(std::move(options)),
      workers_(options_.threads),
      filter_(scene.sensor().film().rfilter()),
      state_(std::move(film)),
      start_(Clock::now()),
      rays_before_(ray_statistics().rays()),
      samples_(state_.complete_samples()),
      samples_before_(static_cast<double>(samples_)),
      error_time_(start_),
      report_time_(start_) {
    const RenderBudget& budget = options_.budget;
    if (!budget.samples && !budget.seconds && !budget.error) {
        throw Error("a render needs a limit: samples, seconds or error");
    }
}

double RenderJob::elapsed() const { return seconds_between(start_, Clock::now()); }

/// Samples on their way to an estimator, and on to the film.
class RenderJob::Batch {
public:
    Batch(const BatchEstimator& estimator, std::size_t size, FilmState& film)
        : estimator_(estimator),
          size_(size),
          film_(film),
          layer_count_(film.layout().layers.size()),
          layers_(size * layer_count_) {
        samples_.reserve(size);
    }

    /// Number `index` of the sequence, for the pixel; its ray is to be set.
    CameraSample& add(std::size_t pixel, const Sampler& sampler, std::uint64_t sequence,
                      std::uint64_t index) {
        if (samples_.size() == size_) finish();
        CameraSample& sample = samples_.emplace_back(sampler, sequence, index);
        sample.result.pixel = pixel;
        if (layer_count_ > 0) {
            sample.result.layers =
                std::span(layers_).subspan((samples_.size() - 1) * layer_count_, layer_count_);
        }
        negative_.push_back(false);
        return sample;
    }
    /// The filter is negative where the last sample lies.
    void mark_negative() { negative_.back() = true; }

    void finish() {
        if (samples_.empty()) return;
        std::fill(layers_.begin(), layers_.end(), 0.0f);
        estimator_(samples_);
        for (std::size_t i = 0; i < samples_.size(); ++i) {
            film_.add(samples_[i].result.pixel, negative_[i], samples_[i].result);
        }
        samples_.clear();
        negative_.clear();
    }

private:
    const BatchEstimator& estimator_;
    std::size_t size_;
    FilmState& film_;
    std::size_t layer_count_;
    std::vector<CameraSample> samples_;
    std::vector<char> negative_;
    std::vector<float> layers_;
};

void RenderJob::render_samples(const Estimator& estimator) {
    run_passes([&](SampleRange range) { sample_pixels(range, estimator); });
}

void RenderJob::render_batches(const BatchEstimator& estimator, std::size_t size) {
    run_passes([&](SampleRange range) { sample_pixels(range, estimator, size); });
}

void RenderJob::run_passes(const Pass& pass) {
    PassPlan plan(options_.budget, state_.first_sample(), samples_);
    while (!interrupted()) {
        const std::optional<SampleRange> range = plan.next(elapsed());
        if (!range) break;
        samples_of_tiles_ = 0;
        const Clock::time_point begin = Clock::now();
        pass(*range);
        if (interrupted()) break;
        plan.finished(*range, seconds_between(begin, Clock::now()));
        samples_ = plan.samples_done();
        finish_pass(plan);
        const bool exact_enough = error_ && error_samples_ == samples_ && options_.budget.error &&
                                  error_->high <= *options_.budget.error;
        if (exact_enough && plan.at_error_check() && samples_ >= least_samples_for_error) break;
    }
    samples_ = state_.complete_samples();
}

/// Looks at the error if it decides about stopping, or else rarely: it costs a walk over the film.
void RenderJob::finish_pass(const PassPlan& plan) {
    const Clock::time_point now = Clock::now();
    const bool decides = options_.budget.error && plan.at_error_check();
    const bool shown =
        options_.progress && seconds_between(error_time_, now) > std::max(1.0, 20 * error_cost_);
    if (decides || shown) {
        error_ = state_.error();
        error_samples_ = samples_;
        error_time_ = Clock::now();
        error_cost_ = seconds_between(now, error_time_);
    }
    const double traced = static_cast<double>(ray_statistics().rays() - rays_before_);
    rays_per_second_ = traced / std::max(elapsed(), 1e-9);
    samples_of_tiles_ = 0;
    report();
    if (options_.after_pass) options_.after_pass(status(), state_);
}

void RenderJob::sample_pixels(SampleRange range, const Estimator& estimator) {
    const auto one_by_one = [&](std::span<CameraSample> samples) {
        for (CameraSample& s : samples) estimator(s.ray, s.stream, s.result);
    };
    sample_pixels(range, one_by_one, 1);
}

void RenderJob::sample_pixels(SampleRange range, const BatchEstimator& estimator,
                              std::size_t size) {
    const Vector2i tiles = tiles_in(state_.layout().crop.size);
    workers_.run(std::int64_t{tiles.x} * tiles.y, [&](std::int64_t index) {
        if (interrupted()) return;
        const int i = static_cast<int>(index);
        Batch batch(estimator, size, state_);
        sample_tile(range, tile_size * Vector2i(i % tiles.x, i / tiles.x), batch);
        batch.finish();
        samples_of_tiles_ += static_cast<std::int64_t>(range.size());
        report();
    });
}

void RenderJob::sample_tile(SampleRange range, Vector2i tile, Batch& batch) {
    const Vector2i end = glm::min(tile + tile_size, state_.layout().crop.size);
    for (int y = tile.y; y < end.y; ++y) {
        for (int x = tile.x; x < end.x; ++x) {
            if (interrupted()) return;
            sample_pixel(range, {x, y}, batch);
        }
    }
}

void RenderJob::sample_pixel(SampleRange range, Vector2i pixel, Batch& batch) {
    const CropWindow& crop = state_.layout().crop;
    const std::size_t index =
        static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(crop.size.x) +
        static_cast<std::size_t>(pixel.x);
    const Sensor& sensor = scene_.sensor();
    const Vector2i position = crop.offset + pixel;
    const std::uint64_t x = static_cast<std::uint64_t>(position.x);
    const std::uint64_t y = static_cast<std::uint64_t>(position.y);
    const std::uint64_t sequences[2] = {hash64({x, y, options_.seed, 0}),
                                        hash64({x, y, options_.seed, 1})};
    // A pass that was cut short may have done some of the samples already.
    const std::uint64_t begin = state_.first_sample() + state_.samples(index);
    for (std::uint64_t i = begin; i < range.end; ++i) {
        CameraSample& sample = batch.add(index, sensor.sampler(), sequences[i & 1], i >> 1);
        const FilterSampler::Sample film = filter_.sample(sample.stream.next_2d());
        if (film.negative) batch.mark_negative();
        const Vector2 u_lens = sample.stream.next_2d();
        sample.stream.jump_to(first_integrator_dimension);
        sample.ray = sensor.sample_ray(Vector2(position) + 0.5f + film.offset, u_lens);
    }
}

RenderStatus RenderJob::status() const {
    RenderStatus status;
    status.seconds = elapsed();
    const Vector2i tiles = tiles_in(state_.layout().crop.size);
    const double part =
        static_cast<double>(samples_of_tiles_) / (double(tiles.x) * double(tiles.y));
    status.samples = static_cast<double>(samples_) + part;
    status.fraction = fraction(status);
    // Samples of an earlier run took none of this run's time.
    RenderStatus before;
    before.samples = samples_before_;
    const double gained = status.fraction - fraction(before);
    if (gained > 0.001) status.seconds_left = status.seconds * (1 - status.fraction) / gained;
    status.rays_per_second = rays_per_second_;
    status.error = error_;
    return status;
}

/// Of the limit that is nearest. The error falls with the number of samples.
double RenderJob::fraction(const RenderStatus& status) const {
    const RenderBudget& budget = options_.budget;
    double result = 0;
    if (budget.samples) {
        const double all = static_cast<double>(std::max<std::uint64_t>(*budget.samples, 1));
        result = std::max(result, status.samples / all);
    }
    if (budget.seconds) result = std::max(result, status.seconds / std::max(*budget.seconds, 1e-9));
    if (budget.error && error_ && error_->high > 0 && error_samples_ > 0) {
        const double gain = status.samples / static_cast<double>(error_samples_);
        result = std::max(result, std::min(gain * *budget.error / error_->high, 0.99));
    }
    return std::min(result, 1.0);
}

/// Whoever comes first after the interval reports; the others go on.
void RenderJob::report() {
    if (!options_.progress) return;
    const std::unique_lock lock(report_mutex_, std::try_to_lock);
    if (!lock) return;
    const Clock::time_point now = Clock::now();
    if (seconds_between(report_time_, now) < report_interval) return;
    report_time_ = now;
    options_.progress(status());
}

}  // namespace lucerna
