// SPDX-License-Identifier: Apache-2.0
/// Filter importance sampling: samples are placed as the reconstruction filter weighs them
/// (Ernst, Stamminger and Greiner 2006, "Filter Importance Sampling").
///
/// So all samples of a pixel have the same weight, and none belongs to two pixels: pixels are
/// independent of each other, of tiles and of threads.
#pragma once

#include "core/interfaces/rfilter.h"
#include "core/math/vector.h"

#include <cstdint>
#include <vector>

namespace lucerna {

class FilterSampler {
public:
    struct Sample {
        Vector2 offset{0};      ///< from the centre of the pixel [pixels]
        bool negative = false;  ///< the filter is negative there
    };

    explicit FilterSampler(const RFilter& filter);

    /// A position, drawn in proportion to |filter|; u in [0, 1)².
    Sample sample(Vector2 u) const;

    /// How much larger the integral of the negative lobes is than the integral of the whole filter:
    /// (∫|f| − ∫f) / 2∫f, in two dimensions. Zero for filters without negative lobes. Means of
    /// positive and of negative samples are weighted by 1 + this and by minus this.
    double negative_weight() const { return negative_weight_; }

private:
    struct Offset {
        float x;
        bool negative;
    };
    Offset sample_1d(float u) const;

    /// The filter is constant in each of equally wide cells.
    struct Cell {
        double begin;  ///< probability of all cells before
        double scale;  ///< width over probability [pixels]
        float x;       ///< left end [pixels]
        bool negative;
    };
    std::vector<Cell> cells_;
    /// guide_[i] is the cell in which u = i / guide_.size() lies: a search has few steps to go
    /// (Chen and Asau 1974).
    std::vector<std::uint32_t> guide_;
    double negative_weight_ = 0;
};

}  // namespace lucerna
