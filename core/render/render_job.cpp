// SPDX-License-Identifier: Apache-2.0
#include "core/render/render_job.h"

#include "core/base/error.h"
#include "core/math/sequences.h"
#include "core/render/chance_light.h"
#include "core/scene/ray_statistics.h"

#include <algorithm>

namespace lucerna {

namespace {

constexpr int tile_size = 16;
/// The camera's own numbers: position on the film and on the lens.
constexpr std::uint32_t first_integrator_dimension = 4;
constexpr double report_interval = 0.1;
constexpr std::size_t most_in_batch = 64;
constexpr double longest_batch = 0.02;  // [s]
/// Fewer samples can miss all of the light, and the halves then agree.
constexpr std::uint64_t least_samples_for_error = 16;

double seconds_between(std::chrono::steady_clock::time_point a,
                       std::chrono::steady_clock::time_point b) {
    return std::chrono::duration<double>(b - a).count();
}

Vector2i tiles_in(Vector2i size) { return (size + tile_size - 1) / tile_size; }

/// Tile number `index` of a window.
CropWindow tile_of(const CropWindow& window, int index) {
    const int tiles = tiles_in(window.size).x;
    const Vector2i begin = tile_size * Vector2i(index % tiles, index / tiles);
    return {.offset = window.offset + begin,
            .size = glm::min(begin + tile_size, window.size) - begin};
}

int bands_in(const FilmLayout& layout) { return (layout.full_size.y + tile_size - 1) / tile_size; }

}  // namespace

FilmLayout film_layout(const Scene& scene) {
    const Film& film = scene.sensor().film();
    const ReconstructionFilter filter(film.rfilter());
    const int block = scene.integrator().block_size();
    return {.full_size = film.size(),
            .crop = film.crop(),
            .layers = scene.integrator().layers(),
            .unfiltered = scene.integrator().unfiltered(),
            .block = block,
            .reach = filter.reach(),
            .negative_weight = filter.negative_weight(),
            // Pixels of a block may all have the same noise.
            .noise_correlation = filter.noise_correlation() + block * block - 1,
            .chance_luminance = chance_luminance(scene)};
}

RenderJob::RenderJob(const Scene& scene, RenderOptions options, FilmState film)
    : scene_(scene),
      options_(std::move(options)),
      workers_(options_.threads),
      filter_(scene.sensor().film().rfilter()),
      state_(std::move(film)),
      band_mutexes_(static_cast<std::size_t>(bands_in(state_.layout()))),
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

/// Samples of a tile on their way to an estimator, and on to the film.
class RenderJob::Batch {
public:
    Batch(const BatchEstimator& estimator, std::size_t most, std::atomic<std::size_t>& size,
          const ReconstructionFilter& filter, const CropWindow& window, const FilmLayout& layout)
        : estimator_(estimator),
          most_(most),
          size_(size),
          tile_(filter, window, layout.layers.size(), layout.unfiltered),
          layer_count_(layout.layers.size()) {
        samples_.reserve(most);
        places_.reserve(most);
    }

    /// Where a sample belongs.
    struct Place {
        Vector2i pixel{0};  ///< of the tile
        Vector2 offset{0};  ///< in the pixel
        int half = 0;
    };

    /// Begins a block of so many samples, which are estimated together.
    void begin_block(std::size_t count) {
        if (samples_.size() + count > size_) estimate();
        layers_.resize(std::max(most_, count) * layer_count_);
        ++block_;
    }

    /// A sample of the block, whose ray is to be set.
    CameraSample& add(const SampleStream& stream, const Place& place, std::size_t pixel) {
        PixelSample result;
        result.pixel = pixel;
        if (layer_count_ > 0) {
            result.layers =
                std::span(layers_).subspan(samples_.size() * layer_count_, layer_count_);
        }
        places_.push_back(place);
        CameraSample& sample = samples_.emplace_back(Ray(), stream, result);
        sample.block = block_;
        return sample;
    }

    /// All samples that were added.
    const FilmTile& finish() {
        estimate();
        return tile_;
    }

private:
    void estimate() {
        if (samples_.empty()) return;
        std::fill(layers_.begin(), layers_.end(), 0.0f);
        const Clock::time_point begin = Clock::now();
        estimator_(samples_);
        fit_size(seconds_between(begin, Clock::now()));
        for (std::size_t i = 0; i < samples_.size(); ++i) {
            const Place& place = places_[i];
            tile_.add({.pixel = place.pixel,
                       .offset = place.offset,
                       .half = place.half,
                       .value = samples_[i].result});
        }
        samples_.clear();
        places_.clear();
    }

    /// Who interrupts the render must not wait for a batch.
    void fit_size(double seconds) {
        const std::size_t size = size_;
        if (seconds > longest_batch) {
            size_ = std::max<std::size_t>(size / 2, 1);
        } else if (seconds < 0.25 * longest_batch && size < most_) {
            size_ = 2 * size;
        }
    }

    const BatchEstimator& estimator_;
    std::size_t most_;
    std::atomic<std::size_t>& size_;  ///< of all threads; a block that is larger is not split
    std::uint32_t block_ = 0;
    FilmTile tile_;
    std::size_t layer_count_;
    std::vector<CameraSample> samples_;
    std::vector<Place> places_;
    std::vector<float> layers_;
};

void RenderJob::render_samples(const Estimator& estimator) {
    run_passes([&](SampleRange range) { sample_pixels(range, estimator); });
}

void RenderJob::render_batches(const BatchEstimator& estimator) {
    run_passes([&](SampleRange range) { sample_pixels(range, estimator, most_in_batch); });
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
                                  error_->relative_mse <= *options_.budget.error;
        if (exact_enough && plan.at_error_check() && samples_ >= least_samples_for_error) break;
    }
    samples_ = state_.complete_samples();
}

/// Looks at the error if it decides about stopping, or else rarely: it costs a walk over the film.
void RenderJob::finish_pass(const PassPlan& plan) {
    const Clock::time_point now = Clock::now();
    const bool decides = options_.budget.error && plan.at_error_check();
    const bool shown =
        options_.progress && seconds_between(error_time_, now) > std::max(1.0, 100 * error_cost_);
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
                              std::size_t most) {
    const CropWindow window = state_.layout().sampled();
    const Vector2i tiles = tiles_in(window.size);
    workers_.run(std::int64_t{tiles.x} * tiles.y, [&](std::int64_t index) {
        if (interrupted()) return;
        const CropWindow tile = tile_of(window, static_cast<int>(index));
        Batch batch(estimator, most, batch_size_, filter_, tile, state_.layout());
        sample_tile(range, tile, batch);
        add(batch.finish());
        samples_of_tiles_ += static_cast<std::int64_t>(range.size());
        report();
    });
}

/// Sums do not depend on the order of their terms, so it does not matter which tile comes first.
void RenderJob::add(const FilmTile& tile) {
    const CropWindow reached = tile.reached();
    const int first = std::max(reached.offset.y, 0) / tile_size;
    const int end = std::min(reached.offset.y + reached.size.y, state_.layout().full_size.y);
    for (int band = first; band * tile_size < end; ++band) {
        const std::lock_guard lock(band_mutexes_[static_cast<std::size_t>(band)]);
        state_.add(tile, band * tile_size, (band + 1) * tile_size);
    }
}

void RenderJob::sample_tile(SampleRange range, const CropWindow& tile, Batch& batch) {
    const int size = state_.layout().block;
    for (int y = 0; y < tile.size.y; y += size) {
        for (int x = 0; x < tile.size.x; x += size) {
            if (interrupted()) return;
            const Vector2i begin(x, y), end = glm::min(begin + size, tile.size);
            sample_block(range, tile, {.offset = begin, .size = end - begin}, batch);
        }
    }
}

void RenderJob::sample_block(SampleRange range, const CropWindow& tile, const CropWindow& block,
                             Batch& batch) {
    // A pass that was cut short may have done some of the samples already, of whole blocks.
    const CropWindow window = state_.layout().sampled();
    const Vector2i first = tile.offset + block.offset - window.offset;
    const auto index = static_cast<std::size_t>(first.x + first.y * window.size.x);
    const auto count = static_cast<std::size_t>(block.size.x * block.size.y);
    for (std::uint64_t i = state_.first_sample() + state_.samples(index); i < range.end; ++i) {
        batch.begin_block(count);
        for (int y = 0; y < block.size.y; ++y) {
            for (int x = 0; x < block.size.x; ++x) {
                const Vector2i pixel = block.offset + Vector2i(x, y);
                sample_pixel(i, tile.offset + pixel, pixel, batch);
            }
        }
    }
}

void RenderJob::sample_pixel(std::uint64_t index, Vector2i pixel, Vector2i pixel_of_tile,
                             Batch& batch) {
    const CropWindow window = state_.layout().sampled();
    const Vector2i in_window = pixel - window.offset;
    const Sensor& sensor = scene_.sensor();
    const auto x = static_cast<std::uint64_t>(pixel.x), y = static_cast<std::uint64_t>(pixel.y);
    const std::uint64_t half = index & 1;
    SampleStream stream(sensor.sampler(), hash64({x, y, options_.seed, half}), index);
    const Vector2 offset = filter_.place(stream.next_2d());
    const Vector2 u_lens = stream.next_2d();
    stream.jump_to(first_integrator_dimension);
    CameraSample& sample = batch.add(
        stream, {.pixel = pixel_of_tile, .offset = offset, .half = static_cast<int>(half)},
        static_cast<std::size_t>(in_window.x + in_window.y * window.size.x));
    sample.ray = sensor.sample_ray(Vector2(pixel) + offset, u_lens);
}

RenderStatus RenderJob::status() const {
    RenderStatus status;
    status.seconds = elapsed();
    const Vector2i tiles = tiles_in(state_.layout().sampled().size);
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

/// Progress towards the nearest limit. The error falls with the number of samples.
double RenderJob::fraction(const RenderStatus& status) const {
    const RenderBudget& budget = options_.budget;
    double result = 0;
    if (budget.samples) {
        const double all = static_cast<double>(std::max<std::uint64_t>(*budget.samples, 1));
        result = std::max(result, status.samples / all);
    }
    if (budget.seconds) result = std::max(result, status.seconds / std::max(*budget.seconds, 1e-9));
    if (budget.error && error_ && error_->relative_mse > 0 && error_samples_ > 0) {
        const double gain = status.samples / static_cast<double>(error_samples_);
        result = std::max(result, std::min(gain * *budget.error / error_->relative_mse, 0.99));
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
