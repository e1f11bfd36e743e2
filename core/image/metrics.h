// SPDX-License-Identifier: Apache-2.0
/// How far an image is from a reference: the figures that Lucerna prints, with their formulas.
///
/// Let x be the image and r the reference, linear RGB, averages over pixels and channels:
///
///   MSE            mean (x − r)²
///   RMSE           √MSE
///   relMSE         mean (x − r)² / (r² + ε),  ε = 1e-2 · (mean r)²; the same at any exposure
///   trimmed        relMSE without the worst 0.1 % of pixels (their number rounded down), always
///                  next to the share of the untrimmed sum that was dropped
///   PSNR           −10 log₁₀ mean (t(x) − t(r))², t = the sRGB curve after clamping to [0, 1]
///
/// A pixel with a NaN or an infinity in either image is never skipped silently: it is counted, and
/// every figure is given without such pixels and with them, which makes errors infinite.
#pragma once

#include <cstddef>

#include "core/image/image.h"

namespace lucerna {

struct Metrics {
    double mse = 0;
    double rmse = 0;
    double relmse = 0;
    double trimmed_relmse = 0;
    double trimmed_share = 0;  ///< of the sum of relMSE, in [0, 1]
    double psnr = 0;           ///< dB; infinite for equal images
};

struct Comparison {
    Metrics finite;  ///< over the pixels that are finite in both images
    Metrics all;     ///< over all pixels; errors are infinite if any pixel is not finite
    std::size_t pixels = 0;
    std::size_t non_finite = 0;            ///< pixels of the image
    std::size_t non_finite_reference = 0;  ///< pixels of the reference
    std::size_t trimmed_pixels = 0;
    double reference_mean = 0;  ///< over finite pixels and channels
    double epsilon = 0;         ///< of relMSE
};

/// Compares the colours of two images of one size; throws Error if the sizes differ.
Comparison compare_images(const Image& image, const Image& reference);

/// Each pixel's mean over channels of (x − r)² / (r² + epsilon), in a channel "Y"; infinite where
/// one of the images is not finite. `epsilon` is that of the comparison.
Image error_image(const Image& image, const Image& reference, double epsilon);

/// Paints a map of one channel, 0 to `maximum`, from black over red to pale yellow ("magma" of
/// matplotlib). Values that are not finite are white, and counted.
Image8 false_color(const Image& map, float maximum);

}  // namespace lucerna
