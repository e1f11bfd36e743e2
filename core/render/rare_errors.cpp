// SPDX-License-Identifier: Apache-2.0
#include "core/render/rare_errors.h"

#include "core/math/vector.h"
#include "core/render/event_rates.h"

#include <cmath>

namespace lucerna {

namespace {

/// (m − μ)² / (μ² + ε) of a pixel at a rate, and of the pixels like it that got nothing.
double error_at(double rate, const RarePixel& pixel, double epsilon) {
    const double missed = 1 / std::expm1(rate);
    double result = 0;
    for (const double m : pixel.mean) {
        const double bright = m * (1 - pixel.dark);
        const double expected = bright * rate / pixel.events;
        const double mu2 = sqr(m * pixel.dark + expected) + epsilon;
        result += (sqr(bright - expected) + missed * sqr(expected)) / mu2 / 3;
    }
    return result;
}

}  // namespace

RareErrors rare_errors(const std::vector<RarePixel>& pixels, double epsilon, double correlation) {
    std::vector<double> counts;
    for (const RarePixel& pixel : pixels) counts.push_back(pixel.events);
    // Assumed as firmly as no count can change; not at all; unless the counts speak against it.
    const EventRates often(counts, {.power = 8, .pixels = 1e9}, correlation);
    const EventRates likely(counts, {.power = 3}, correlation);
    const EventRates chance(counts, {.power = -1, .pixels = 3}, correlation);
    RareErrors result;
    for (const RarePixel& pixel : pixels) {
        for (std::size_t k = 0; k < EventRates::count; ++k) {
            const double error = error_at(EventRates::rate(k), pixel, epsilon);
            result.low += often.given(pixel.events)[k] * error;
            result.likely += likely.given(pixel.events)[k] * error;
            result.high += chance.given(pixel.events)[k] * error;
        }
    }
    return result;
}

}  // namespace lucerna
