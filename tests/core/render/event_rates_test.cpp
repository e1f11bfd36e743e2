// SPDX-License-Identifier: Apache-2.0
#include "core/render/event_rates.h"

#include "core/math/sequences.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lucerna {
namespace {

/// Poisson number by the product of uniform ones (Knuth).
int poisson(double rate, Rng& rng) {
    int k = 0;
    for (double p = rng.next_float(); p > std::exp(-rate); p *= rng.next_float()) ++k;
    return k;
}

/// Counts of pixels of one rate that saw any event.
std::vector<double> counts(double rate, std::size_t pixels) {
    Rng rng(3);
    std::vector<double> result;
    while (result.size() < pixels) {
        const int k = poisson(rate, rng);
        if (k > 0) result.push_back(std::min<double>(k, EventRates::most_events));
    }
    return result;
}

double mean_rate(const EventRates& rates, double events) {
    double sum = 0, mean = 0;
    for (std::size_t i = 0; i < EventRates::count; ++i) {
        sum += rates.given(events)[i];
        mean += rates.given(events)[i] * EventRates::rate(i);
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    return mean;
}

TEST(EventRates, J8_one_rate_is_found_from_the_counts) {
    for (const double rate : {0.05, 0.5, 2.0}) {
        const EventRates rates(counts(rate, 4000));
        EXPECT_NEAR(mean_rate(rates, 1) / rate, 1, 0.25) << rate;
    }
}

TEST(EventRates, J8_few_pixels_are_taken_for_things_that_are_met_often) {
    const double once[] = {1};
    EXPECT_GT(mean_rate(EventRates(once), 1), 0.5);
    EXPECT_LT(mean_rate(EventRates(counts(0.02, 100)), 1), 0.1);
    EXPECT_GT(mean_rate(EventRates(std::span<const double>()), 4), 2);
}

}  // namespace
}  // namespace lucerna
