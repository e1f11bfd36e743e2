// SPDX-License-Identifier: Apache-2.0
#include "core/render/filter_sampler.h"

#include "core/plugin/error.h"

namespace lucerna {

namespace {

/// Cells of the table over the whole width. Even: a box of half a pixel and any other symmetric
/// filter keep their centre.
constexpr int cell_count = 2048;

}  // namespace

FilterSampler::FilterSampler(const RFilter& filter) {
    const double radius = static_cast<double>(filter.radius());
    std::vector<double> weights;
    double above = 0, below = 0;  // zero: integrals of the positive and the negative part
    for (int i = 0; i < cell_count; ++i) {
        const double x = (2.0 * (i + 0.5) / cell_count - 1) * radius;
        const double value = static_cast<double>(filter.evaluate(static_cast<float>(x)));
        weights.push_back(value);
        (value < 0 ? below : above) += std::abs(value);
    }
    if (!(above > below) || !std::isfinite(above)) {
        throw Error("the reconstruction filter has no positive integral");
    }
    // Of the product f(x) f(y), the parts where one factor is negative.
    negative_weight_ = 2 * above * below / sqr(above - below);

    const double width = 2 * radius / cell_count;
    double sum = 0;
    for (int i = 0; i < cell_count; ++i) {
        const double weight = weights[static_cast<std::size_t>(i)];
        const double probability = std::abs(weight) / (above + below);
        if (probability == 0) continue;
        const bool goes_on = i > 0 && weight == weights[static_cast<std::size_t>(i) - 1];
        if (goes_on) {
            sum += probability;
            continue;  // a box is one cell
        }
        cells_.push_back({.begin = sum,
                          .scale = width / probability,
                          .x = static_cast<float>(i * width - radius),
                          .negative = weight < 0});
        sum += probability;
    }
    std::uint32_t cell = 0;
    const std::size_t guides = cells_.size();
    for (std::size_t i = 0; i < guides; ++i) {
        const double u = static_cast<double>(i) / static_cast<double>(guides);
        while (cell + 1 < cells_.size() && cells_[cell + 1].begin <= u) ++cell;
        guide_.push_back(cell);
    }
}

FilterSampler::Offset FilterSampler::sample_1d(float u) const {
    std::size_t i = guide_[static_cast<std::size_t>(static_cast<double>(u) *
                                                    static_cast<double>(guide_.size()))];
    while (i + 1 < cells_.size() && cells_[i + 1].begin <= static_cast<double>(u)) ++i;
    const Cell& cell = cells_[i];
    const double inside = (static_cast<double>(u) - cell.begin) * cell.scale;
    return {cell.x + static_cast<float>(inside), cell.negative};
}

FilterSampler::Sample FilterSampler::sample(Vector2 u) const {
    const Offset x = sample_1d(u.x);
    const Offset y = sample_1d(u.y);
    return {.offset = {x.x, y.x}, .negative = x.negative != y.negative};
}

}  // namespace lucerna
