// SPDX-License-Identifier: Apache-2.0
/// How many bright samples a pixel is to expect, judged by how many it got.
///
/// A pixel that holds a small lamp meets it in a few samples, k of them, or in none. From k = 1
/// alone one cannot tell a lamp that is met once on average from one that is met once in a hundred
/// renders, and the error of the pixel differs by orders of magnitude. All such pixels of an image
/// together can tell: if bright samples are that rare, hardly any pixel has two of them.
///
/// k follows a Poisson distribution of rate λ, and λ a distribution over a grid, fitted to the
/// counts of all pixels (empirical Bayes: Robbins 1956; by expectation maximization, Laird 1978).
/// Pixels are known only if k > 0, so probabilities are those given k > 0.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace lucerna {

class EventRates {
public:
    static constexpr std::size_t count = 33;
    using Weights = std::array<double, count>;

    /// As if some more pixels had been seen, whose share falls as λ to a power below λ = 1.
    struct Prior {
        double power = 2.5, pixels = 8;
    };
    /// From the numbers of events of pixels, each in [1, most_events]; they need not be integers.
    /// `correlation`: so many pixels count as one.
    EventRates(std::span<const double> events, Prior prior, double correlation = 1);
    explicit EventRates(std::span<const double> events) : EventRates(events, Prior{}) {}

    /// More say enough by themselves.
    static constexpr double most_events = 8;
    /// λ number i: powers of √2 from 2⁻¹¹ to 2⁵.
    static double rate(std::size_t i);
    /// Probability of each λ for a pixel with so many events.
    const Weights& given(double events) const { return given_[bin_of(events)]; }

private:
    static constexpr std::size_t bins_per_event = 16;
    static std::size_t bin_of(double events);
    void fit(const std::vector<double>& pixels, const Weights& prior);

    std::vector<Weights> given_;  ///< for each bin of events
};

}  // namespace lucerna
