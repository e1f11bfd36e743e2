// SPDX-License-Identifier: Apache-2.0
#include "core/render/reconstruction_filter.h"

#include "core/base/error.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

ReconstructionFilter::ReconstructionFilter(const RFilter& filter)
    : reach_(std::max(static_cast<int>(std::ceil(filter.radius() - 0.5f)), 0)),
      extent_(std::min(2 * filter.radius(), 1.0f)) {
    const auto count = static_cast<std::size_t>(2 * reach_ + 1);
    // The filter at the distance of each pixel's centre, in the middle of each step.
    std::vector<double> values(steps * count);
    double integral = 0, magnitude = 0, peak = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double x = (static_cast<double>(i / count) + 0.5) / steps;
        const double pixel = static_cast<double>(i % count) - reach_;
        values[i] = static_cast<double>(filter.evaluate(static_cast<float>(pixel + 0.5 - x)));
        integral += values[i];
        magnitude += std::abs(values[i]);
        peak = std::max(peak, std::abs(values[i]));
    }
    if (!(integral > 0) || !std::isfinite(integral)) {
        throw Error("the reconstruction filter has no positive integral");
    }
    for (const double value : values) {
        table_.push_back(static_cast<std::int32_t>(std::lround(value / peak * largest)));
    }

    // The product of two factors is negative if one of them is: (∫|f|)² = ∫∫ f⁺ + ∫∫ f⁻.
    if (magnitude > integral) negative_weight_ = (sqr(magnitude / integral) - 1) / 2;

    // A sample adds to pixels k apart in proportion to ∫ f(x) f(x + k) dx.
    std::vector<double> products(count);
    for (std::size_t first = 0; first < values.size(); first += count) {
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t k = 0; i + k < count; ++k) {
                products[k] += values[first + i] * values[first + i + k];
            }
        }
    }
    double along_axis = 1;
    for (std::size_t k = 1; k < count; ++k) along_axis += 2 * sqr(products[k] / products[0]);
    noise_correlation_ = sqr(along_axis);
}

}  // namespace lucerna
