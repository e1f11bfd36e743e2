// SPDX-License-Identifier: Apache-2.0
/// What an image is while it grows: sums over the samples of every pixel.
///
/// Pixel (x, y) takes samples number first_sample(), first_sample() + 1, … one after the other;
/// even and odd ones go to two halves that are independent of each other. Sums are exact, so the
/// image is a function of the set of samples alone: resuming and merging change no bit.
#pragma once

#include "core/image/image.h"
#include "core/interfaces/film.h"
#include "core/interfaces/integrator.h"
#include "core/render/error_estimate.h"
#include "core/render/exact_sum.h"

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
    /// FilterSampler::negative_weight().
    double negative_weight = 0;

    bool operator==(const FilmLayout&) const = default;
};

class FilmState {
public:
    /// A film without samples. Throws Error if there is not enough memory.
    explicit FilmState(FilmLayout layout, std::uint64_t first_sample = 0);

    const FilmLayout& layout() const { return layout_; }
    std::size_t pixel_count() const { return dropped_.size(); }
    std::uint64_t first_sample() const { return first_sample_; }

    /// Adds the next sample of a pixel (index x + y · width in the crop window). A sample with a
    /// NaN or an infinity is dropped and counted. `negative`: it lies where the reconstruction
    /// filter is negative. Threads may work on different pixels at once.
    void add(std::size_t pixel, bool negative, const PixelSample& sample);

    /// The number of samples that a pixel has taken, dropped ones included.
    std::uint64_t samples(std::size_t pixel) const;
    /// The smallest and the largest number over all pixels: they differ if a pass was cut short.
    std::uint64_t complete_samples() const;
    std::uint64_t most_samples() const;
    /// Samples dropped because they were not finite.
    std::uint64_t dropped_samples() const;
    /// The first pixel that dropped one, in coordinates of the whole image.
    std::optional<Vector2i> first_dropped_pixel() const;
    /// Pixels without any finite sample; they are black.
    std::size_t empty_pixels() const;

    /// Adds the samples of `next`, which must be those that follow for every pixel. Throws Error if
    /// the layouts differ, or if samples would be missing or counted twice.
    void merge(const FilmState& next);

    /// Mean of channel (R, G, B, A, layers) over the samples of half 0 or 1.
    double half_mean(std::size_t pixel, int half, std::size_t channel) const;
    /// Mean over all samples; 0 if there are none.
    double mean(std::size_t pixel, std::size_t channel) const;
    std::size_t channel_count() const { return 4 + layout_.layers.size(); }
    std::vector<std::string> channel_names() const;

    /// The image as it is now; a channel "samples.dropped" counts what each pixel dropped, if any
    /// did.
    ImageFile resolve() const;
    /// How far the image is from its limit. Empty if some pixel has samples in one half only;
    /// pixels that lack a half because they dropped its samples are left out.
    std::optional<ErrorEstimate> error() const;

    /// The numbers that make up the state, for files: see state_file.cpp.
    std::size_t bin_count() const { return layout_.negative_weight > 0 ? 4 : 2; }
    std::span<const ExactSum> sums() const { return sums_; }
    std::span<const std::uint32_t> counts() const { return counts_; }
    std::span<const std::uint32_t> dropped() const { return dropped_; }
    std::span<ExactSum> sums() { return sums_; }
    std::span<std::uint32_t> counts() { return counts_; }
    std::span<std::uint32_t> dropped() { return dropped_; }

private:
    struct Halves {
        int first, count;
    };
    double mean_of(std::size_t pixel, Halves halves, std::size_t channel) const;
    std::uint64_t finite_samples(std::size_t pixel, Halves halves) const;

    FilmLayout layout_;
    std::uint64_t first_sample_;
    /// Per pixel and bin, all channels. The bin of a sample is half + 2 · negative.
    std::vector<ExactSum> sums_;
    std::vector<std::uint32_t> counts_;   ///< finite samples per pixel and bin
    std::vector<std::uint32_t> dropped_;  ///< others, per pixel
};

}  // namespace lucerna
