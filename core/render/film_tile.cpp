// SPDX-License-Identifier: Apache-2.0
#include "core/render/film_tile.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lucerna {

namespace {

bool all_finite(const PixelSample& sample) {
    return is_finite(sample.radiance) && is_finite(sample.unfiltered) &&
           std::isfinite(sample.alpha) &&
           std::all_of(sample.layers.begin(), sample.layers.end(),
                       [](float x) { return std::isfinite(x); });
}

/// The square of a number of which eight bits count: sums of such are exact over a wide range.
double rounded_square(float x) {
    const auto rounded = std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) & 0xffff0000u);
    return sqr(static_cast<double>(rounded));
}

}  // namespace

FilmTile::FilmTile(const ReconstructionFilter& filter, CropWindow window, std::size_t layers,
                   bool unfiltered)
    : filter_(filter),
      window_(window),
      size_(window.size + 2 * filter.reach()),
      bin_count_(bin_count(filter)),
      layer_count_(layers),
      further_count_(layers + (unfiltered ? 3 : 0)),
      bins_(bin_count_ * static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y)),
      further_(bins_.size() * further_count_) {}

void FilmTile::add(const FilmSample& sample) {
    const PixelSample& value = sample.value;
    const int reach = filter_.reach();
    const std::size_t own = index(sample.pixel + reach, static_cast<std::size_t>(sample.half));
    if (!all_finite(value)) {
        ++bins_[own].dropped;
        return;
    }
    ++bins_[own].samples;
    const auto weights_x = filter_.weights(sample.offset.x);
    const auto weights_y = filter_.weights(sample.offset.y);
    const FourDoubles color = {
        static_cast<double>(value.radiance.x), static_cast<double>(value.radiance.y),
        static_cast<double>(value.radiance.z), static_cast<double>(value.alpha)};
    const double square = rounded_square(luminance(value.radiance));
    for (std::size_t y = 0; y < weights_y.size(); ++y) {
        for (std::size_t x = 0; x < weights_x.size(); ++x) {
            const std::int32_t weight = weights_x[x] * weights_y[y];
            if (weight == 0) continue;
            const Vector2i pixel =
                sample.pixel + Vector2i(static_cast<int>(x), static_cast<int>(y));
            const std::size_t bin = static_cast<std::size_t>(sample.half) + (weight < 0 ? 2 : 0);
            const std::size_t i = index(pixel, bin);
            const std::int32_t magnitude = std::abs(weight);
            bins_[i].weight += magnitude;
            bins_[i].color.add(color * static_cast<double>(magnitude));
            const std::int32_t coarse = magnitude >> coarse_shift;
            if (coarse > 0) bins_[i].squares.add(square * sqr(static_cast<double>(coarse)));
            for (std::size_t k = 0; k < layer_count_; ++k) {
                further_[i * further_count_ + k].add(static_cast<double>(value.layers[k]) *
                                                     static_cast<double>(magnitude));
            }
        }
    }
    for (std::size_t k = layer_count_; k < further_count_; ++k) {
        const auto channel = static_cast<int>(k - layer_count_);
        further_[own * further_count_ + k].add(static_cast<double>(value.unfiltered[channel]));
    }
}

}  // namespace lucerna
