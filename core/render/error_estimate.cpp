// SPDX-License-Identifier: Apache-2.0
#include "core/render/error_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucerna {

ErrorEstimator::ErrorEstimator(double image_mean)
    : image_mean_(image_mean),
      epsilon_(std::max(0.01 * image_mean * image_mean, std::numeric_limits<double>::min())) {}

void ErrorEstimator::add(const double (&mean)[3], const double (&variance)[3]) {
    double relative = 0;
    for (int c = 0; c < 3; ++c) {
        variance_sum_ += variance[c] / 3;
        relative += variance[c] / (mean[c] * mean[c] + epsilon_) / 3;
    }
    ++count_;
    const double difference = relative - mean_;
    mean_ += difference / static_cast<double>(count_);
    squares_ += difference * (relative - mean_);
}

/// The pixels are independent, so the mean of their errors has a standard error. A few pixels carry
/// most of it; the interval is taken for the logarithm (delta method), whose distribution is
/// less skewed, and cannot reach below zero.
ErrorEstimate ErrorEstimator::estimate() const {
    ErrorEstimate result;
    const double n = static_cast<double>(count_);
    result.image_mean = image_mean_;
    if (count_ == 0) return result;
    result.mse = variance_sum_ / n;
    result.relative_mse = result.low = result.high = mean_;
    if (mean_ > 0) {
        const double variance = count_ > 1 ? squares_ / (n - 1) : mean_ * mean_;
        const double spread = 1.96 * std::sqrt(variance / n) / mean_;
        result.low = mean_ * std::exp(-spread);
        result.high = mean_ * std::exp(spread);
    }
    return result;
}

}  // namespace lucerna
