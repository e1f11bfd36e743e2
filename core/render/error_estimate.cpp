// SPDX-License-Identifier: Apache-2.0
#include "core/render/error_estimate.h"

#include "core/math/vector.h"

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
    double mean() const { return mean_; }
    double variance_of_mean() const {
        return count_ > 1 ? squares_ / (count_ - 1) / count_ : sqr(mean_);
    }

private:
    double count_ = 0, mean_ = 0, squares_ = 0;
};

class Estimator {
public:
    explicit Estimator(const NoisyImage& image) : image_(image) {}

    ErrorEstimate estimate() {
        Moments means, variances, relative;
        const std::size_t size = image_.mean.size();
        for (std::size_t i = 0; i < size; ++i) {
            if (valid(i)) means.add(static_cast<double>(image_.mean[i]));
        }
        epsilon_ = std::max(0.01 * sqr(means.mean()), std::numeric_limits<double>::min());
        double doubtful = 0, total = 0;
        for (std::size_t pixel = 0; 3 * pixel < size; ++pixel) {
            double error = 0, variance = 0;
            if (!valid(3 * pixel)) continue;
            for (std::size_t c = 0; c < 3; ++c) {
                const std::size_t i = 3 * pixel + c;
                const double v = sqr(static_cast<double>(image_.deviation[i]));
                if (v == 0) continue;
                const double m2 = sqr(static_cast<double>(image_.mean[i]));
                const double e = v / (squared_mean(i, m2, v) + epsilon_);
                error += e / 3;
                variance += v / 3;
                doubtful += e * std::min(v / m2, 1.0) / 3;  // v / 0 is infinite
            }
            relative.add(error);
            variances.add(variance);
            total += error;
        }
        ErrorEstimate result;
        result.image_mean = means.mean();
        result.mse = variances.mean();
        result.relative_mse = result.low = result.high = relative.mean();
        if (total > 0) {
            // The interval of the logarithm (delta method): a few pixels carry most of the error,
            // and the distribution of the logarithm is less skewed and stays above zero.
            const double spread = 1.96 *
                                  std::sqrt(2 * image_.correlation * relative.variance_of_mean()) /
                                  relative.mean();
            result.low *= std::exp(-spread);
            result.high *= std::exp(spread) * (1 + doubtful / total);
        }
        return result;
    }

private:
    bool valid(std::size_t i) const { return image_.deviation[i] >= 0; }

    /// μ² of a value whose mean has the square m2 and the variance v.
    double squared_mean(std::size_t i, double m2, double v) const {
        constexpr double moderate = 0.75;  // of m² is noise
        return v <= moderate * m2 ? m2 - v : std::min(m2, sqr(mean_around(i)));
    }

    /// Of the same channel in the 5 × 5 pixels around, without the pixel itself.
    double mean_around(std::size_t i) const {
        const int pixel = static_cast<int>(i / 3);
        const int x = pixel % image_.width, y = pixel / image_.width;
        Moments mean;
        for (int v = std::max(y - 2, 0); v <= std::min(y + 2, image_.height - 1); ++v) {
            for (int u = std::max(x - 2, 0); u <= std::min(x + 2, image_.width - 1); ++u) {
                const auto other = static_cast<std::size_t>(u + v * image_.width);
                const std::size_t k = 3 * other + i % 3;
                if (k != i && valid(k)) mean.add(static_cast<double>(image_.mean[k]));
            }
        }
        return mean.mean();
    }

    const NoisyImage& image_;
    double epsilon_ = 0;
};

}  // namespace

ErrorEstimate estimate_error(const NoisyImage& image) { return Estimator(image).estimate(); }

}  // namespace lucerna
