// SPDX-License-Identifier: Apache-2.0
/// The squared error of pixels whose value comes from few bright samples.
///
/// Such a pixel got k bright samples where λ were to be expected. Given λ, its mean is known, and
/// so is its error. For each such pixel there are e^−λ / (1 − e^−λ) others like it that got none
/// and are too dark by λ samples (Horvitz and Thompson 1952). λ is as all pixels together let
/// expect (event_rates.h).
#pragma once

#include <array>
#include <vector>

namespace lucerna {

struct RarePixel {
    std::array<double, 3> mean = {};  ///< R, G, B
    double dark = 0;                  ///< part of the mean that comes without bright samples
    double events = 1;                ///< k
};

/// The likely error, and what it is under assumptions that few counts cannot refute: that bright
/// samples came as often as they usually do, and that they came by chance. The ends of an interval
/// are to be taken from these: in the tail, assumptions weigh more than data (robust Bayes: Berger
/// 1990).
struct RareErrors {
    double low = 0, likely = 0, high = 0;
};

/// Expected sums of (m − μ)² / (μ² + ε), mean over channels, over the pixels and those like them
/// that got nothing. `correlation`: so many pixels tell as much as one that shares no samples.
RareErrors rare_errors(const std::vector<RarePixel>& pixels, double epsilon, double correlation);

}  // namespace lucerna
