// SPDX-License-Identifier: Apache-2.0
#include "core/render/rare_errors.h"

#include "core/math/sequences.h"
#include "core/math/vector.h"
#include "core/render/event_rates.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

/// (m − μ)² / (μ² + ε) of a pixel at each rate, and of the pixels like it that got nothing.
EventRates::Weights errors_at_rates(const RarePixel& pixel, double epsilon) {
    EventRates::Weights result{};
    for (std::size_t k = 0; k < EventRates::count; ++k) {
        const double rate = EventRates::rate(k);
        const double missed = 1 / std::expm1(rate);
        for (const double m : pixel.mean) {
            const double bright = m * (1 - pixel.dark);
            const double expected = bright * rate / pixel.events;
            const double mu2 = sqr(m * pixel.dark + expected) + epsilon;
            result[k] += (sqr(bright - expected) + missed * sqr(expected)) / mu2 / 3;
        }
    }
    return result;
}

/// The first rate up to which the probabilities add up to u.
std::size_t rate_at(const EventRates::Weights& weights, double u) {
    std::size_t k = 0;
    for (double sum = weights[0]; sum < u && k + 1 < EventRates::count; sum += weights[k]) ++k;
    return k;
}

RareDraws draw(const std::vector<RarePixel>& pixels, const std::vector<EventRates::Weights>& errors,
               const EventRates& rates) {
    RareDraws sums{};
    for (std::size_t k = 0; k < sums.size(); ++k) {
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const auto u = static_cast<double>(Rng(pixels[i].group, k).next_float());
            sums[k] += errors[i][rate_at(rates.given(pixels[i].events), u)];
        }
    }
    return sums;
}

}  // namespace

RareErrors draw_rare_errors(const std::vector<RarePixel>& pixels, double epsilon,
                            double correlation) {
    if (pixels.empty()) return {};
    std::vector<double> counts;
    std::vector<EventRates::Weights> errors;
    for (const RarePixel& pixel : pixels) {
        counts.push_back(pixel.events);
        errors.push_back(errors_at_rates(pixel, epsilon));
    }
    const double independent = static_cast<double>(pixels.size()) / correlation;
    const auto draws = [&](EventRates::Prior prior) {
        return draw(pixels, errors, EventRates(counts, prior, correlation));
    };
    // Assumed as firmly as no count can change, not at all, and as firmly as the counts speak.
    return {.low = draws({.power = 8, .pixels = 1e9}),
            .likely = draws({.power = 3}),
            .high = draws({.power = 0.25, .pixels = std::max(independent, 8.0)})};
}

}  // namespace lucerna
