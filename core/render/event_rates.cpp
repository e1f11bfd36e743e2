// SPDX-License-Identifier: Apache-2.0
#include "core/render/event_rates.h"

#include "core/math/vector.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

constexpr int iterations = 200;

/// Makes the sum one.
void normalize(EventRates::Weights& weights) {
    double sum = 0;
    for (const double w : weights) sum += w;
    for (double& w : weights) w /= sum;
}

/// Likelihood of each rate, given that there is any event; up to a factor.
EventRates::Weights likelihood(double events) {
    EventRates::Weights result;
    for (std::size_t i = 0; i < result.size(); ++i) {
        const double rate = EventRates::rate(i);
        result[i] = std::exp(events * std::log(rate) - rate) / -std::expm1(-rate);
    }
    return result;
}

EventRates::Weights product(EventRates::Weights a, const EventRates::Weights& b) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] *= b[i];
    normalize(a);
    return a;
}

}  // namespace

double EventRates::rate(std::size_t i) { return std::exp2(0.5 * static_cast<double>(i) - 11); }

std::size_t EventRates::bin_of(double events) {
    const double x = std::clamp(events, 1.0, most_events);
    return static_cast<std::size_t>(std::lround((x - 1) * static_cast<double>(bins_per_event)));
}

EventRates::EventRates(std::span<const double> events, Prior prior_pixels, double correlation) {
    const std::size_t bins = bin_of(most_events) + 1;
    for (std::size_t bin = 0; bin < bins; ++bin) {
        const double middle = 1 + static_cast<double>(bin) / static_cast<double>(bins_per_event);
        given_.push_back(likelihood(middle));
    }
    // Rates are most likely one or above: less is believed if the counts speak for it.
    Weights prior;
    for (std::size_t i = 0; i < count; ++i) {
        prior[i] = std::pow(std::min(rate(i), 1.0), prior_pixels.power);
    }
    normalize(prior);
    for (double& p : prior) p *= prior_pixels.pixels;
    std::vector<double> pixels(bins);
    for (const double k : events) pixels[bin_of(k)] += 1 / correlation;
    fit(pixels, prior);
}

void EventRates::fit(const std::vector<double>& pixels, const Weights& prior) {
    Weights share = prior;
    normalize(share);
    for (int i = 0; i < iterations; ++i) {
        Weights next = prior;
        for (std::size_t bin = 0; bin < pixels.size(); ++bin) {
            if (pixels[bin] == 0) continue;
            const Weights posterior = product(given_[bin], share);
            for (std::size_t k = 0; k < count; ++k) next[k] += pixels[bin] * posterior[k];
        }
        normalize(next);
        share = next;
    }
    for (Weights& weights : given_) weights = product(weights, share);
}

}  // namespace lucerna
