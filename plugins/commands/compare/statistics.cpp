// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/compare/statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lucerna {

double student_within(double t, int degrees) {
    const double theta = std::atan(t / std::sqrt(double(degrees)));
    const double cosine2 = std::cos(theta) * std::cos(theta);
    const bool odd = degrees % 2 == 1;
    double term = odd ? std::cos(theta) : 1, sum = degrees > 1 ? term : 0;
    for (int k = odd ? 3 : 2; k < degrees; k += 2) {
        term *= cosine2 * (k - 1) / k;
        sum += term;
    }
    if (!odd) return std::sin(theta) * sum;
    return 2 / std::numbers::pi * (theta + std::sin(theta) * sum);
}

double student_quantile(double confidence, double degrees) {
    const int whole = std::clamp(static_cast<int>(degrees), 1, 1000);
    double low = 0, high = 1;
    while (student_within(high, whole) < confidence) high *= 2;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (student_within(middle, whole) < confidence ? low : high) = middle;
    }
    return (low + high) / 2;
}

Mean mean_of(std::span<const double> values) {
    const auto n = static_cast<double>(values.size());
    Mean result{0, 0, n - 1};
    for (const double x : values) result.value += x / n;
    for (const double x : values) {
        const double difference = x - result.value;
        result.variance += difference * difference / ((n - 1) * n);
    }
    return result;
}

std::vector<double> logarithms(std::span<const double> values) {
    std::vector<double> result;
    for (const double x : values) result.push_back(std::log(std::max(x, 1e-30)));
    return result;
}

std::size_t median_rank(std::size_t n) {
    // P(fewer than k of n values lie below the median): binomial.
    double term = std::pow(0.5, static_cast<double>(n)), below = 0;
    std::size_t k = 0;
    for (; k < n / 2; ++k) {
        below += term;
        if (2 * below > 0.08) break;
        term *= static_cast<double>(n - k) / static_cast<double>(k + 1);
    }
    return std::max<std::size_t>(k, 1);
}

Interval geometric_mean(std::span<const double> values) {
    std::vector<double> logs = logarithms(values);
    const Mean mean = mean_of(logs);
    const double margin = student_quantile(0.95, mean.degrees) * std::sqrt(mean.variance);
    const std::size_t rank = median_rank(logs.size());
    std::sort(logs.begin(), logs.end());
    return {.value = std::exp(mean.value),
            .low = std::exp(std::min(mean.value - margin, logs[rank - 1])),
            .high = std::exp(std::max(mean.value + margin, logs[logs.size() - rank]))};
}

Interval paired_ratio(std::span<const double> above, std::span<const double> below) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < above.size(); ++i) ratios.push_back(above[i] / below[i]);
    return geometric_mean(ratios);
}

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

}  // namespace lucerna
