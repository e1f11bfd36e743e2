// SPDX-License-Identifier: Apache-2.0
/// The squared error of pixels whose value comes from few bright samples.
///
/// Such a pixel got k bright samples where λ were to be expected. Given λ, its mean is known, and
/// so is its error. For each such pixel there are e^−λ / (1 − e^−λ) others like it that got none
/// and are too dark by λ samples (Horvitz and Thompson 1952). What is known of λ (event_rates.h)
/// makes a distribution of the sum over the pixels, from which numbers are drawn: its tail is
/// heavy, since a pixel that met what it meets once in a thousand renders is wrong by a thousand.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace lucerna {

struct RarePixel {
    std::array<double, 3> mean = {};  ///< R, G, B
    double dark = 0;                  ///< part of the mean that comes without bright samples
    double events = 1;                ///< k
    std::size_t group = 0;            ///< pixels of a group share their bright samples
};

using RareDraws = std::array<double, 64>;

/// The likely sum, and sums under assumptions that few counts cannot refute: that bright samples
/// came as often as they usually do, and that they came by chance. The ends of an interval should
/// be taken from these: in the tail, assumptions weigh more than the data (robust Bayes: Berger
/// 1990).
struct RareErrors {
    RareDraws low{}, likely{}, high{};
};

/// Draws of the sum of (m − μ)² / (μ² + ε), mean over channels, over the pixels and those like them
/// that got nothing. `correlation`: so many pixels tell as much as one that shares no samples.
RareErrors draw_rare_errors(const std::vector<RarePixel>& pixels, double epsilon,
                            double correlation);

}  // namespace lucerna
