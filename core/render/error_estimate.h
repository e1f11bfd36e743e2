// SPDX-License-Identifier: Apache-2.0
/// How noisy an image is, from two independent halves of its samples.
#pragma once

#include <cstddef>
#include <optional>

namespace lucerna {

/// Estimates of the expected squared error, over pixels and the channels R, G, B:
///
///   v = ((A − B)/2)², the variance of the mean of two halves A and B of equal size
///   mse = ⟨v⟩,  relative_mse = ⟨v / (m² + ε)⟩ with m = (A + B)/2, ε = 0.01 ⟨m⟩²
///
/// They do not change when the image is scaled (mse: with its square), and they see noise, not
/// bias. [low, high] covers the expectation of relative_mse with about 95 %. The estimate is too
/// low while images are very noisy, by about the fraction relative_mse of itself or more, since a
/// rare bright sample raises m together with v.
struct ErrorEstimate {
    double mse = 0;
    double relative_mse = 0;
    double low = 0;
    double high = 0;
    double image_mean = 0;  ///< ⟨m⟩

    /// Variance of the image over the square of its mean.
    double relative_variance() const { return mse / (image_mean * image_mean); }
};

/// Gathers ErrorEstimate pixel by pixel; ⟨m⟩ must be known before.
class ErrorEstimator {
public:
    explicit ErrorEstimator(double image_mean);

    /// The three channels' m and v of one pixel.
    void add(const double (&mean)[3], const double (&variance)[3]);
    ErrorEstimate estimate() const;

private:
    double image_mean_, epsilon_;
    double variance_sum_ = 0;
    /// Mean and sum of squared differences of the pixels' relative errors (Welford 1962).
    double mean_ = 0, squares_ = 0;
    std::size_t count_ = 0;
};

}  // namespace lucerna
