// SPDX-License-Identifier: Apache-2.0
/// What an image is while it grows: weighted sums of the samples around every pixel.
///
/// Pixel (x, y) takes samples number first_sample(), first_sample() + 1, … one after the other;
/// even and odd ones go to two halves that are independent of each other. Sums are exact, so the
/// image is a function of the set of samples alone: resuming and merging change no bit.
///
/// Samples are also taken of a margin around the crop window, as far as the filter reaches, rounded
/// up to whole blocks: a crop is a part of the whole image.
#pragma once

#include "core/image/image.h"
#include "core/interfaces/film.h"
#include "core/interfaces/integrator.h"
#include "core/render/error_estimate.h"
#include "core/render/exact_sum.h"
#include "core/render/film_tile.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lucerna {

/// The shape of a film: two films can be added if it is the same.
struct FilmLayout {
    Vector2i full_size{0};            ///< of the whole image [pixels]
    CropWindow crop;                  ///< what is rendered of it
    std::vector<std::string> layers;  ///< channels beside R, G, B, A
    bool unfiltered = false;          ///< PixelSample::unfiltered counts
    int block = 1;                    ///< Integrator::block_size()
    int reach = 0;                    ///< ReconstructionFilter::reach()
    double negative_weight = 0;       ///< ReconstructionFilter::negative_weight()
    double noise_correlation = 1;     ///< ReconstructionFilter::noise_correlation()
    double chance_luminance = 0;      ///< chance_light.h

    /// The pixels that take samples: the crop window and the margin, rounded up to whole blocks,
    /// inside of the whole image.
    CropWindow sampled() const;

    bool operator==(const FilmLayout&) const = default;
};

class FilmState {
public:
    /// A film without samples. Throws Error if there is not enough memory.
    explicit FilmState(FilmLayout layout, std::uint64_t first_sample = 0);

    const FilmLayout& layout() const { return layout_; }
    /// Pixels of the crop window; pixel i is (i mod width, i / width).
    std::size_t pixel_count() const { return count_of(layout_.crop); }
    std::uint64_t first_sample() const { return first_sample_; }

    /// Adds the next samples of the pixels of a tile. Threads may add to different rows of pixels
    /// at once: only rows first … end − 1 of the whole image are added.
    void add(const FilmTile& tile, int first_row, int end_row);

    /// The number of samples that a pixel of layout().sampled() has taken, dropped ones included.
    std::uint64_t samples(std::size_t sampled_pixel) const;
    /// The smallest and the largest number over all pixels: they differ if a pass was cut short.
    std::uint64_t complete_samples() const;
    std::uint64_t most_samples() const;
    /// Samples dropped because they were not finite.
    std::uint64_t dropped_samples() const;
    /// The first pixel that dropped one, in coordinates of the whole image.
    std::optional<Vector2i> first_dropped_pixel() const;
    /// Pixels of the crop window that no finite sample reached; they are black.
    std::size_t empty_pixels() const;

    /// Adds the samples of `next`, which must be those that follow for every pixel. Throws Error if
    /// the layouts differ, or if samples would be missing or counted twice.
    void merge(const FilmState& next);

    /// Value of channel (R, G, B, A, layers) of a pixel of the crop window by half 0 or 1 of the
    /// samples.
    double half_mean(std::size_t pixel, int half, std::size_t channel) const;
    /// By all samples; 0 if there are none.
    double mean(std::size_t pixel, std::size_t channel) const;
    std::size_t channel_count() const { return 4 + layout_.layers.size(); }
    std::vector<std::string> channel_names() const;

    /// The image as it is now; a channel "samples.dropped" counts what each pixel dropped, if any
    /// did.
    ImageFile resolve() const { return resolve(layout_.crop); }
    /// A part of layout().sampled().
    ImageFile resolve(const CropWindow& window) const;
    /// How far the image is from its limit. Empty if some pixel has samples in one half only;
    /// pixels that lack a half because they dropped its samples are left out.
    std::optional<ErrorEstimate> error() const;

    /// The numbers that make up the state, for files: see state_file.cpp. Each sampled pixel has
    /// bin_count() bins, half + 2 · negative, and a bin has sum_count() sums: the channels times
    /// their weights, then what is unfiltered.
    std::size_t bin_count() const { return layout_.negative_weight > 0 ? 4 : 2; }
    std::size_t sum_count() const { return channel_count() + (layout_.unfiltered ? 3 : 0); }
    std::span<const ExactSum> sums() const { return sums_; }
    std::span<const std::int64_t> weights() const { return weights_; }
    std::span<const ExactSum> squares() const { return squares_; }
    std::span<const std::uint32_t> counts() const { return counts_; }
    std::span<const std::uint32_t> dropped() const { return dropped_; }
    std::span<ExactSum> sums() { return sums_; }
    std::span<std::int64_t> weights() { return weights_; }
    std::span<ExactSum> squares() { return squares_; }
    std::span<std::uint32_t> counts() { return counts_; }
    std::span<std::uint32_t> dropped() { return dropped_; }

private:
    struct Halves {
        std::size_t first, count;
    };
    static std::size_t count_of(const CropWindow& window) {
        return static_cast<std::size_t>(window.size.x) * static_cast<std::size_t>(window.size.y);
    }
    /// Index among the sampled pixels of a pixel of the whole image.
    std::size_t sampled_index(Vector2i pixel) const;
    std::size_t sampled_index(std::size_t crop_pixel) const;
    void add(const FilmTile& tile, Vector2i pixel);
    /// Value of a sampled pixel.
    double value(std::size_t i, Halves halves, std::size_t channel) const;
    std::int64_t weight(std::size_t i, Halves halves, std::size_t sign) const;
    double total_weight(std::size_t i) const;
    std::uint64_t finite_samples(std::size_t i, Halves halves) const;

    FilmLayout layout_;
    CropWindow sampled_;
    std::uint64_t first_sample_;
    std::vector<ExactSum> sums_;
    std::vector<std::int64_t> weights_;   ///< sums of their magnitudes, per pixel and bin
    std::vector<ExactSum> squares_;       ///< FilmTile::Bin::squares, per pixel
    std::vector<std::uint32_t> counts_;   ///< finite samples, per pixel and half
    std::vector<std::uint32_t> dropped_;  ///< others, per pixel
};

}  // namespace lucerna
