// SPDX-License-Identifier: Apache-2.0
#include "core/render/error_estimate.h"

#include "core/math/vector.h"
#include "core/render/event_rates.h"

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
    double doubtful = 0;     ///< of the error: the part that noise may hide in μ²
    double uncertainty = 0;  ///< variance of the error by what is not known of μ²
};

class Estimator {
public:
    explicit Estimator(const NoisyImage& image)
        : image_(image),
          pixels_(image.mean.size() / 3),
          background_(pixels_, std::numeric_limits<double>::quiet_NaN()) {}

    ErrorEstimate estimate() {
        ErrorEstimate result;
        result.image_mean = mean_of_image();
        epsilon_ = std::max(0.01 * sqr(result.image_mean), std::numeric_limits<double>::min());
        const EventRates rates = find_rare_pixels();
        Moments variances, errors;
        PixelError sum;
        double rare = 0;
        for (std::size_t pixel = 0; pixel < pixels_; ++pixel) {
            if (!valid(pixel)) continue;
            const PixelError p = is_rare(pixel) ? rare_error(pixel, rates) : usual_error(pixel);
            variances.add(p.variance);
            errors.add(p.error);
            sum.error += p.error;
            sum.doubtful += p.doubtful;
            sum.uncertainty += p.uncertainty;
            rare += is_rare(pixel) ? p.error : p.doubtful;
        }
        result.mse = variances.mean();
        result.relative_mse = result.low = result.high = errors.mean();
        if (!(sum.error > 0)) return result;
        result.rare = rare / sum.error;
        // The interval of the logarithm (delta method): a few pixels carry most of the error, and
        // the distribution of the logarithm is less skewed and stays above zero.
        const double variance = errors.variance_of_mean() + sum.uncertainty / sqr(errors.count());
        const double spread = 1.96 * std::sqrt(2 * image_.correlation * variance) / errors.mean();
        result.low *= std::exp(-spread);
        result.high *= std::exp(std::min(spread, widest)) * (1 + 2 * sum.doubtful / sum.error);
        return result;
    }

private:
    static constexpr double widest = 50;  ///< so that `high` stays finite

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
            result.error += e / 3;
            result.doubtful += e * std::min(v / m2, 1.0) / 3;  // v / 0 is infinite
        }
        return result;
    }

    /// μ² of a value whose mean has the square m2 and the variance v.
    double squared_mean(std::size_t i, double m2, double v) const {
        constexpr double moderate = 0.75;  // of m² is noise
        return v <= moderate * m2 ? m2 - v : std::min(m2, sqr(mean_around(i)));
    }

    /// Mean of the same channel in the pixels around, without those whose samples reach this one.
    double mean_around(std::size_t i) const {
        Moments result;
        for_each_around(i / 3, image_.reach + 1, image_.reach + 2,
                        [&](std::size_t other) { result.add(mean(3 * other + i % 3)); });
        return result.mean();
    }

    /// Sets background_ where a pixel stands out by few bright samples; the rates of such samples.
    EventRates find_rare_pixels() {
        std::vector<double> counts;
        for (std::size_t pixel = 0; pixel < image_.squares.size(); ++pixel) {
            if (!valid(pixel) || events(pixel, 0) >= EventRates::most_events) continue;
            if (sqr(brightness(pixel)) <= epsilon_) continue;
            const double background = outshone_background(pixel);
            if (background < 0) continue;
            background_[pixel] = background;
            counts.push_back(std::max(events(pixel, background), 1.0));
        }
        return EventRates(counts);
    }

    /// The median of the luminances around if the pixel is much brighter, else −1.
    double outshone_background(std::size_t pixel) const {
        constexpr double contrast = 16;
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

    /// With 1 / (μ² + ε) averaged over the rates at which the bright samples may come.
    PixelError rare_error(std::size_t pixel, const EventRates& rates) const {
        const double count = std::max(events(pixel, background_[pixel]), 1.0);
        const EventRates::Weights& weights = rates.given(count);
        const double dark = background_[pixel] / brightness(pixel);
        PixelError result;
        double square = 0;  // of the error: the second moment
        for (std::size_t i = 3 * pixel; i < 3 * pixel + 3; ++i) {
            const double v = variance(i), m = mean(i);
            double first = 0, second = 0;
            for (std::size_t k = 0; k < EventRates::count; ++k) {
                const double mu = m * (dark + (1 - dark) * EventRates::rate(k) / count);
                const double e = v / (sqr(mu) + epsilon_);
                first += weights[k] * e;
                second += weights[k] * sqr(e);
            }
            result.variance += v / 3;
            result.error += first / 3;
            square += std::sqrt(second) / 3;
        }
        result.uncertainty = std::max(sqr(square) - sqr(result.error), 0.0);
        return result;
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
};

}  // namespace

ErrorEstimate estimate_error(const NoisyImage& image) { return Estimator(image).estimate(); }

}  // namespace lucerna
