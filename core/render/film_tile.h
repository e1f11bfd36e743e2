// SPDX-License-Identifier: Apache-2.0
/// The samples of a part of a film, gathered by one thread before they are added to the film.
#pragma once

#include "core/interfaces/film.h"
#include "core/interfaces/integrator.h"
#include "core/render/exact_sum.h"
#include "core/render/reconstruction_filter.h"

#include <cstdint>
#include <vector>

namespace lucerna {

/// A sample of a pixel with its place.
struct FilmSample {
    Vector2i pixel{0};  ///< from the upper left corner of the tile
    Vector2 offset{0};  ///< in the pixel, [0, 1)²
    int half = 0;       ///< of the film, 0 or 1
    PixelSample value;
};

class FilmTile {
public:
    /// For the samples of the pixels of a `window`; `layers` numbers with each. With `unfiltered`,
    /// PixelSample::unfiltered counts, too.
    FilmTile(const ReconstructionFilter& filter, CropWindow window, std::size_t layers,
             bool unfiltered);

    /// Adds to all pixels that the filter reaches. A sample with a NaN or an infinity is dropped
    /// and counted.
    void add(const FilmSample& sample);

    /// The pixels that samples may have reached: the window and a margin around it.
    CropWindow reached() const {
        return {.offset = window_.offset - filter_.reach(), .size = size_};
    }

    /// For each pixel, two halves and, if the filter has negative lobes, two for negative weights.
    static std::size_t bin_count(const ReconstructionFilter& filter) {
        return filter.negative_weight() > 0 ? 4 : 2;
    }
    /// The bits of weights that squares leave out.
    static constexpr int coarse_shift = 18;
    struct Bin {
        FourExactSums color;        ///< R, G, B and alpha, times weights
        ExactSum squares;           ///< of luminances times weights without their last bits
        std::int64_t weight = 0;    ///< sum of the magnitudes of the weights
        std::uint32_t samples = 0;  ///< that belong to the pixel itself
        std::uint32_t dropped = 0;
    };
    /// `pixel` is counted from reached().offset.
    const Bin& bin(Vector2i pixel, std::size_t bin) const { return bins_[index(pixel, bin)]; }
    /// Further sums: the layers, times weights, then, if there is such a thing, what is unfiltered.
    std::span<const ExactSum> further(Vector2i pixel, std::size_t bin) const {
        return std::span(further_).subspan(index(pixel, bin) * further_count_, further_count_);
    }

private:
    std::size_t index(Vector2i pixel, std::size_t bin) const {
        return bin_count_ * static_cast<std::size_t>(pixel.x + pixel.y * size_.x) + bin;
    }

    const ReconstructionFilter& filter_;
    CropWindow window_;
    Vector2i size_;  ///< of what is reached
    std::size_t bin_count_, layer_count_, further_count_;
    std::vector<Bin> bins_;
    std::vector<ExactSum> further_;
};

}  // namespace lucerna
