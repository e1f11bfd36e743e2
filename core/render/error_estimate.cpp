// SPDX-License-Identifier: Apache-2.0
#include "core/render/error_estimate.h"

#include "core/math/vector.h"
#include "core/render/event_rates.h"
#include "core/render/rare_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucerna {

namespace {

/// Mean and variance of the mean of a stream (Welford 1962).
class Moments {
public:
    void add(double x) {
        ++count_;
        const double difference = x - mean_;
        mean_ += difference / count_;
        squares_ += difference * (x - mean_);
    }
    double count() const { return count_; }
    double mean() const { return mean_; }
    double variance_of_mean() const {
        return count_ > 1 ? squares_ / (count_ - 1) / count_ : sqr(mean_);
    }

private:
    double count_ = 0, mean_ = 0, squares_ = 0;
};

/// A pixel's part of the estimate, mean over its channels.
struct PixelError {
    double variance = 0;
    double error = 0;
    double least = 0;     ///< the error if the value is as bright as it seems
    double doubtful = 0;  ///< part of the error that noise may hide in μ²
};

class Estimator {
public:
    explicit Estimator(const NoisyImage& image)
        : image_(image),
          pixels_(image.mean.size() / 3),
          background_(pixels_, std::numeric_limits<double>::quiet_NaN()),
          cell_side_(static_cast<int>(std::ceil(std::sqrt(image.correlation)))) {}

    ErrorEstimate estimate() {
        ErrorEstimate result;
        result.image_mean = mean_of_image();
        epsilon_ = std::max(0.01 * sqr(result.image_mean), std::numeric_limits<double>::min());
        const std::vector<RarePixel> rare = find_rare_pixels();
        Moments variances, errors;
        PixelError sum;
        for (std::size_t pixel = 0; pixel < pixels_; ++pixel) {
            if (!valid(pixel)) continue;
            PixelError p = usual_error(pixel);
            variances.add(p.variance);
            if (is_rare(pixel)) p = {};
            errors.add(p.error);
            add_to_cell(pixel, p.error);
            sum.doubtful += p.doubtful;
            sum.least += p.least;
        }
        result.mse = variances.mean();
        if (!(result.mse > 0)) return result;
        const double n = errors.count();
        const double spread = usual_spread(errors);
        const RareErrors of_rare = rare_errors(rare, epsilon_, image_.correlation);
        const double independent = static_cast<double>(rare.size()) / image_.correlation;
        const double rare_spread = spread_of(std::sqrt(1 / std::max(independent, 1.0)));
        result.relative_mse = errors.mean() + of_rare.likely / n;
        result.low = (sum.least / spread + of_rare.low / rare_spread) / n;
        result.unseen = unseen_error(result.image_mean);
        result.high =
            (errors.mean() * n * spread + 2 * sum.doubtful + of_rare.high * rare_spread) / n +
            result.unseen;
        result.rare = std::min((of_rare.likely + sum.doubtful) / n / result.relative_mse, 1.0);
        return result;
    }

private:
    bool valid(std::size_t pixel) const { return image_.deviation[3 * pixel] >= 0; }
    bool is_rare(std::size_t pixel) const { return background_[pixel] >= 0; }
    double mean(std::size_t i) const { return static_cast<double>(image_.mean[i]); }
    double variance(std::size_t i) const { return sqr(static_cast<double>(image_.deviation[i])); }
    double brightness(std::size_t pixel) const {
        const float* m = &image_.mean[3 * pixel];
        return static_cast<double>(luminance(Color(m[0], m[1], m[2])));
    }
    /// The number of samples of one size that would be as noisy as what is brighter than `from`.
    double events(std::size_t pixel, double from) const {
        const auto squares = static_cast<double>(image_.squares[pixel]);
        return squares > 0 ? sqr(brightness(pixel) - from) / squares : infinity;
    }

    double mean_of_image() const {
        Moments means;
        for (std::size_t i = 0; i < 3 * pixels_; ++i) {
            if (valid(i / 3)) means.add(mean(i));
        }
        return means.mean();
    }

    PixelError usual_error(std::size_t pixel) const {
        PixelError result;
        for (std::size_t i = 3 * pixel; i < 3 * pixel + 3; ++i) {
            const double v = variance(i), m2 = sqr(mean(i));
            if (v == 0) continue;
            const double e = v / (squared_mean(i, m2, v) + epsilon_);
            result.variance += v / 3;
            const double noise = std::min({v, m2 / events(pixel, 0), 0.75 * m2});
            result.error += e / 3;
            result.least += std::min(e, v / (m2 - noise + epsilon_)) / 3;
            result.doubtful += e * std::min(v / m2, 1.0) / 3;  // v / 0 is infinite
        }
        return result;
    }

    /// μ² of a value whose mean has the square m2 and the variance v. v has one degree of freedom:
    /// where it says that all is noise and the number of samples says otherwise, both m² and the
    /// surroundings count (geometric mean).
    double squared_mean(std::size_t i, double m2, double v) const {
        constexpr double moderate = 0.75;  // of m² is noise
        if (v <= moderate * m2) return m2 - v;
        const double around = std::min(m2, sqr(mean_around(i)));
        const double count = events(i / 3, 0);
        const double noise = std::min(v, m2 / count);
        if (noise > moderate * m2) return around;
        const double weight = 1 / (1 + 2 / count);  // the surroundings count as two samples
        return std::pow(m2 - noise, weight) * std::pow(around, 1 - weight);
    }

    /// Mean of the same channel in the pixels around, without those whose samples reach this one.
    double mean_around(std::size_t i) const {
        Moments result;
        for_each_around(i / 3, image_.reach + 1, image_.reach + 2,
                        [&](std::size_t other) { result.add(mean(3 * other + i % 3)); });
        return result.mean();
    }

    /// The pixels that stand out by few bright samples. Sets background_ of them.
    std::vector<RarePixel> find_rare_pixels() {
        std::vector<RarePixel> result;
        for (std::size_t pixel = 0; pixel < image_.squares.size(); ++pixel) {
            if (!valid(pixel) || events(pixel, 0) >= EventRates::most_events) continue;
            if (sqr(brightness(pixel)) <= epsilon_) continue;
            const double background = outshone_background(pixel);
            if (background < 0) continue;
            background_[pixel] = background;
            const float* m = &image_.mean[3 * pixel];
            result.push_back({.mean = {static_cast<double>(m[0]), static_cast<double>(m[1]),
                                       static_cast<double>(m[2])},
                              .dark = background / brightness(pixel),
                              .events = std::max(events(pixel, background), 1.0)});
        }
        return result;
    }

    /// The median of the luminances around if the pixel is much brighter, else −1.
    double outshone_background(std::size_t pixel) const {
        const double contrast = events(pixel, 0) < 1.5 ? 3 : 16;
        const double limit = brightness(pixel) / contrast;
        std::vector<double> darker;
        std::size_t all = 0;
        for_each_around(pixel, 0, std::max(2, 2 * image_.reach + 1), [&](std::size_t other) {
            ++all;
            const double y = brightness(other);
            if (y < limit) darker.push_back(std::max(y, 0.0));
        });
        if (2 * darker.size() <= all) return -1;
        const auto middle = darker.begin() + static_cast<std::ptrdiff_t>(all / 2);
        std::nth_element(darker.begin(), middle, darker.end());
        return *middle;
    }

    /// Number of the square of pixels that share samples with this one.
    std::size_t cell(std::size_t pixel) const {
        const auto side = static_cast<std::size_t>(cell_side_);
        const auto width = static_cast<std::size_t>(image_.width);
        return pixel % width / side + pixel / width / side * ((width + side - 1) / side);
    }

    void add_to_cell(std::size_t pixel, double error) {
        const std::size_t i = cell(pixel);
        if (i >= cells_.size()) cells_.resize(i + 1);
        cells_[i] += error;
    }

    /// The factor up and down that holds a sum of squared errors of this relative deviation. Its
    /// logarithm is taken as normal (delta method): a few pixels carry most of the error, and the
    /// distribution of the logarithm is less skewed and stays above zero.
    static double spread_of(double deviation) {
        constexpr double widest = 25;  // so that it stays finite
        return std::exp(std::min(1.96 * std::sqrt(2.0) * deviation, widest));
    }

    /// From the pixels, or from the cells, whose errors are independent.
    double usual_spread(const Moments& errors) const {
        if (!(errors.mean() > 0)) return 1;
        Moments cells;
        for (const double sum : cells_) cells.add(sum);
        const double relative = std::max(errors.variance_of_mean() / sqr(errors.mean()),
                                         cells.variance_of_mean() / sqr(cells.mean()));
        return spread_of(std::sqrt(relative));
    }

    /// The error by light that no sample may have met. What none of N samples met comes with a
    /// probability of at most 3 / N (with 95 %: Hanley and Lippman-Hand 1983), so that light of
    /// luminance L adds at most E = 3 L / N to the mean m. A part f of the pixels that lacks it all
    /// has the error (E / f)² / (m + E / f)²; times f, that is E / 4m at most.
    double unseen_error(double image_mean) const {
        if (!(image_.chance_luminance > 0 && image_mean > 0)) return 0;
        return 3 * image_.chance_luminance / image_.samples / image_mean / 4;
    }

    /// Valid pixels whose larger distance along an axis is near … far.
    template <typename Visit>
    void for_each_around(std::size_t pixel, int near, int far, const Visit& visit) const {
        const int x = static_cast<int>(pixel) % image_.width;
        const int y = static_cast<int>(pixel) / image_.width;
        for (int v = std::max(y - far, 0); v <= std::min(y + far, image_.height - 1); ++v) {
            for (int u = std::max(x - far, 0); u <= std::min(x + far, image_.width - 1); ++u) {
                if (std::max(std::abs(u - x), std::abs(v - y)) < near) continue;
                const auto other = static_cast<std::size_t>(u + v * image_.width);
                if (valid(other)) visit(other);
            }
        }
    }

    const NoisyImage& image_;
    std::size_t pixels_;
    /// For pixels that stand out by few bright samples, the luminance around. NaN for others.
    std::vector<double> background_;
    double epsilon_ = 0;
    int cell_side_;              ///< [pixels]
    std::vector<double> cells_;  ///< sums of errors
};

}  // namespace

ErrorEstimate estimate_error(const NoisyImage& image) { return Estimator(image).estimate(); }

}  // namespace lucerna
