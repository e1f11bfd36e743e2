// SPDX-License-Identifier: Apache-2.0
#include "core/render/filter_sampler.h"

#include "core/plugin/error.h"

namespace lucerna {

namespace {

/// Cells of the table over the whole width. Even: a box of half a pixel and any other symmetric
/// filter keep their centre.
constexpr int cell_count = 2048;

}  // namespace

FilterSampler::FilterSampler(const RFilter& filter) : radius_(filter.radius()) {
    std::vector<double> weights(cell_count);
    double above = 0, below = 0;  // zero: integrals of the positive and the negative part
    for (int i = 0; i < cell_count; ++i) {
        const double x = (2.0 * (i + 0.5) / cell_count - 1) * static_cast<double>(radius_);
        const double value = static_cast<double>(filter.evaluate(static_cast<float>(x)));
        weights[static_cast<std::size_t>(i)] = std::abs(value);
        negative_.push_back(value < 0);
        (value < 0 ? below : above) += std::abs(value);
    }
    if (!(above > below) || !std::isfinite(above)) {
        throw Error("the reconstruction filter has no positive integral");
    }
    density_ = PiecewiseConstant1D(weights);
    // Of the product f(x) f(y), the parts where one factor is negative.
    negative_weight_ = 2 * above * below / sqr(above - below);
}

FilterSampler::Sample FilterSampler::sample(Vector2 u) const {
    const auto x = density_.sample(static_cast<double>(u.x));
    const auto y = density_.sample(static_cast<double>(u.y));
    const bool x_negative = negative_[static_cast<std::size_t>(x.index)];
    const bool y_negative = negative_[static_cast<std::size_t>(y.index)];
    return {.offset = (2.0f * Vector2(x.x, y.x) - 1.0f) * radius_,
            .negative = x_negative != y_negative};
}

}  // namespace lucerna
