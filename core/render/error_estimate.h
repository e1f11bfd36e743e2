// SPDX-License-Identifier: Apache-2.0
/// How noisy an image is, from two independent halves of its samples.
#pragma once

#include <cstddef>
#include <vector>

namespace lucerna {

/// The mean of two halves A and B of the samples, and how far they are apart.
struct NoisyImage {
    int width = 0, height = 0;
    /// Three per pixel, R, G, B: m, and |A − B| √(ab) / (a + b), where a and b are the sizes of the
    /// halves, so |A − B| / 2 for equal ones: its square is an unbiased estimate v of the variance
    /// of m. NaN for pixels that lack a half; they are left out.
    std::vector<float> mean = {}, deviation = {};
    /// One per pixel: Σ (w y)² / (Σ w)² over the luminances y and weights w of its samples. The
    /// square of the pixel's luminance over this is its effective number of samples (Kish 1965).
    std::vector<float> squares = {};
    /// How many pixels beside its own a sample reaches, on each side.
    int reach = 0;
    /// Σ ρ² over all pixels around, where ρ is the correlation of their noise with a pixel's: 1 if
    /// pixels are independent. Their squared errors are correlated by ρ².
    double correlation = 1;
    double samples = 1;           ///< number of samples, of all pixels together
    double chance_luminance = 0;  ///< chance_light.h
};

/// Estimates of the squared error, over pixels and the channels R, G, B:
///
///   mse = ⟨v⟩,  relative_mse = ⟨v / (μ² + ε)⟩,  ε = 0.01 ⟨m⟩²
///
/// They do not change when the image is scaled (mse: with its square), and they see noise, not
/// bias. μ² of a pixel is what relative_mse is most sensitive to: m² would be too large exactly
/// where a rare bright sample makes v large, so that the estimate could never exceed one.
///
/// - Where noise is moderate, its unbiased estimate m² − v.
/// - Where it is not, the mean of the pixels around that share no sample with this one, or m² if
///   that is less; or, if the pixel has more effective samples than v lets expect, between both.
/// - A pixel that stands out from its surroundings by few bright samples may hold a small lamp, so
///   that the surroundings say nothing about it, or the samples came by chance. All such pixels
///   together tell how likely that is. Their errors, and those of the pixels like them that no
///   bright sample reached, follow from that (rare_errors.h).
///
/// [low, high] is to hold the error of this very image with 95 %. It adds: by chance, v differs
/// from the expected variance, and the squared error, as independent of v as the sum of two normal
/// numbers is of their difference, does as much once more; what noisy μ² may hide: the part of the
/// estimate that comes from pixels of relative variance v / m² counts 1 + 2 v / m² times; what is
/// not known of bright samples: for `low`, they came as often as they usually do, for `high`, by
/// chance, unless there are too many; and light that comes by way of mirrors or glass, of which
/// there may be no sample. Other bright samples that are too rare to have been drawn are missing.
struct ErrorEstimate {
    double mse = 0;
    double relative_mse = 0;
    double low = 0;
    double high = 0;
    double image_mean = 0;  ///< ⟨m⟩
    /// Part of relative_mse in pixels whose value comes from few bright samples.
    double rare = 0;
    /// Part of `high`: light by way of mirrors or glass that no sample may have met.
    double unseen = 0;

    /// The error is known to an order of magnitude at most.
    bool vague() const { return high > 6 * low; }
    /// The error is at most this with 97.5 %, but for half as much again.
    bool surely_below(double error) const { return high <= 1.5 * error; }

    /// Variance of the image over the square of its mean.
    double relative_variance() const { return mse / (image_mean * image_mean); }
};

ErrorEstimate estimate_error(const NoisyImage& image);

}  // namespace lucerna
