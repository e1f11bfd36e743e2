// SPDX-License-Identifier: Apache-2.0
#include "core/render/film_state.h"

#include "core/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <numeric>

namespace lucerna {

CropWindow FilmLayout::sampled() const {
    const Vector2i begin = glm::max(crop.offset - reach, Vector2i(0)) / block * block;
    const Vector2i end = (crop.offset + crop.size + reach + block - 1) / block * block;
    return {.offset = begin, .size = glm::min(end, full_size) - begin};
}

FilmState::FilmState(FilmLayout layout, std::uint64_t first_sample)
    : layout_(std::move(layout)), sampled_(layout_.sampled()), first_sample_(first_sample) {
    const std::size_t pixels = count_of(sampled_);
    try {
        sums_.resize(pixels * bin_count() * sum_count());
        weights_.resize(pixels * bin_count());
        counts_.resize(pixels * 2);
        squares_.resize(pixels);
        dropped_.resize(pixels);
    } catch (const std::bad_alloc&) {
        const std::size_t bytes =
            pixels * (bin_count() * (sum_count() * sizeof(ExactSum) + 8) + sizeof(ExactSum) + 12);
        throw Error(
            fmt::format("not enough memory for a film of {} × {} pixels and {} channels, "
                        "which needs {} MiB; render less of it with --crop",
                        layout_.crop.size.x, layout_.crop.size.y, channel_count(), bytes >> 20));
    }
}

std::size_t FilmState::sampled_index(Vector2i pixel) const {
    const Vector2i p = pixel - sampled_.offset;
    return static_cast<std::size_t>(p.x) +
           static_cast<std::size_t>(p.y) * static_cast<std::size_t>(sampled_.size.x);
}

std::size_t FilmState::sampled_index(std::size_t crop_pixel) const {
    if (sampled_ == layout_.crop) return crop_pixel;
    const auto i = static_cast<int>(crop_pixel);
    const int width = layout_.crop.size.x;
    return sampled_index(layout_.crop.offset + Vector2i(i % width, i / width));
}

void FilmState::add(const FilmTile& tile, int first_row, int end_row) {
    const CropWindow reached = tile.reached();
    const Vector2i begin = glm::max(
        reached.offset, Vector2i(sampled_.offset.x, std::max(first_row, sampled_.offset.y)));
    const Vector2i sampled_end = sampled_.offset + sampled_.size;
    const Vector2i end = glm::min(reached.offset + reached.size,
                                  Vector2i(sampled_end.x, std::min(end_row, sampled_end.y)));
    for (int y = begin.y; y < end.y; ++y) {
        for (int x = begin.x; x < end.x; ++x) add(tile, {x, y});
    }
}

void FilmState::add(const FilmTile& tile, Vector2i pixel) {
    const Vector2i in_tile = pixel - tile.reached().offset;
    const std::size_t i = sampled_index(pixel);
    for (std::size_t b = 0; b < bin_count(); ++b) {
        const FilmTile::Bin& bin = tile.bin(in_tile, b);
        // Only the tile that holds the pixel has such samples: its thread reads these counts while
        // others add what reaches over their edges.
        if (b < 2 && bin.samples > 0) counts_[2 * i + b] += bin.samples;
        if (b < 2 && bin.dropped > 0) dropped_[i] += bin.dropped;
        if (bin.weight == 0 && bin.samples == 0) continue;
        const std::size_t k = bin_count() * i + b;
        weights_[k] += bin.weight;
        squares_[i].add(bin.squares);
        ExactSum* sum = &sums_[k * sum_count()];
        for (int c = 0; c < 4; ++c) (sum++)->add(ExactSum{bin.color.high[c], bin.color.low[c]});
        for (const ExactSum& further : tile.further(in_tile, b)) (sum++)->add(further);
    }
}

std::uint64_t FilmState::finite_samples(std::size_t i, Halves halves) const {
    std::uint64_t result = 0;
    for (std::size_t h = 0; h < halves.count; ++h) result += counts_[2 * i + halves.first + h];
    return result;
}

std::int64_t FilmState::weight(std::size_t i, Halves halves, std::size_t sign) const {
    std::int64_t result = 0;
    for (std::size_t h = halves.first; h < halves.first + halves.count; ++h) {
        result += weights_[bin_count() * i + h + 2 * sign];
    }
    return result;
}

std::uint64_t FilmState::samples(std::size_t sampled_pixel) const {
    return dropped_[sampled_pixel] + finite_samples(sampled_pixel, {0, 2});
}

std::uint64_t FilmState::complete_samples() const {
    std::uint64_t result = samples(0);
    for (std::size_t i = 1; i < dropped_.size(); ++i) result = std::min(result, samples(i));
    return result;
}

std::uint64_t FilmState::most_samples() const {
    std::uint64_t result = 0;
    for (std::size_t i = 0; i < dropped_.size(); ++i) result = std::max(result, samples(i));
    return result;
}

std::uint64_t FilmState::dropped_samples() const {
    return std::accumulate(dropped_.begin(), dropped_.end(), std::uint64_t{0});
}

std::optional<Vector2i> FilmState::first_dropped_pixel() const {
    const auto first = std::find_if(dropped_.begin(), dropped_.end(), [](auto n) { return n > 0; });
    if (first == dropped_.end()) return {};
    const int index = static_cast<int>(first - dropped_.begin());
    return sampled_.offset + Vector2i(index % sampled_.size.x, index / sampled_.size.x);
}

std::size_t FilmState::empty_pixels() const {
    std::size_t result = 0;
    for (std::size_t i = 0; i < pixel_count(); ++i) {
        const std::size_t k = sampled_index(i);
        result += weight(k, {0, 2}, 0) + (bin_count() > 2 ? weight(k, {0, 2}, 1) : 0) == 0;
    }
    return result;
}

void FilmState::merge(const FilmState& next) {
    if (!(layout_ == next.layout_)) {
        throw Error("the two films differ in size, crop window, filter or layers");
    }
    for (std::size_t i = 0; i < dropped_.size(); ++i) {
        const std::uint64_t end = first_sample_ + samples(i);
        if (end == next.first_sample_) continue;
        throw Error(fmt::format(
            "samples {} to {} of a pixel cannot be followed by samples {} to {}: {}", first_sample_,
            end, next.first_sample_, next.first_sample_ + next.samples(i),
            end < next.first_sample_ ? "those between are missing" : "some would count twice"));
    }
    for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i].add(next.sums_[i]);
    for (std::size_t i = 0; i < weights_.size(); ++i) weights_[i] += next.weights_[i];
    for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += next.counts_[i];
    for (std::size_t i = 0; i < squares_.size(); ++i) squares_[i].add(next.squares_[i]);
    for (std::size_t i = 0; i < dropped_.size(); ++i) dropped_[i] += next.dropped_[i];
}

double FilmState::value(std::size_t i, Halves halves, std::size_t channel) const {
    double part[2] = {0, 0};
    std::int64_t weights[2] = {0, 0};
    ExactSum unfiltered;
    for (std::size_t sign = 0; sign < bin_count() / 2; ++sign) {
        ExactSum filtered;
        for (std::size_t h = halves.first; h < halves.first + halves.count; ++h) {
            const ExactSum* sums = &sums_[(bin_count() * i + h + 2 * sign) * sum_count()];
            filtered.add(sums[channel]);
            if (layout_.unfiltered && channel < 3) unfiltered.add(sums[channel_count() + channel]);
        }
        weights[sign] = weight(i, halves, sign);
        if (weights[sign] > 0) part[sign] = filtered.value() / static_cast<double>(weights[sign]);
    }
    double result = weights[0] > 0 ? part[0] : part[1];
    if (weights[0] > 0 && weights[1] > 0) result += layout_.negative_weight * (part[0] - part[1]);
    const std::uint64_t samples = finite_samples(i, halves);
    if (samples > 0) result += unfiltered.value() / static_cast<double>(samples);
    return result;
}

double FilmState::half_mean(std::size_t pixel, int half, std::size_t channel) const {
    return value(sampled_index(pixel), {static_cast<std::size_t>(half), 1}, channel);
}

double FilmState::mean(std::size_t pixel, std::size_t channel) const {
    return value(sampled_index(pixel), {0, 2}, channel);
}

std::vector<std::string> FilmState::channel_names() const {
    std::vector<std::string> names = {"R", "G", "B", "A"};
    names.insert(names.end(), layout_.layers.begin(), layout_.layers.end());
    return names;
}

ImageFile FilmState::resolve(const CropWindow& window) const {
    ImageFile file;
    file.width = window.size.x;
    file.height = window.size.y;
    file.x = window.offset.x;
    file.y = window.offset.y;
    file.full_width = layout_.full_size.x;
    file.full_height = layout_.full_size.y;
    std::vector<std::size_t> pixels;
    for (int y = 0; y < window.size.y; ++y) {
        for (int x = 0; x < window.size.x; ++x) {
            pixels.push_back(sampled_index(window.offset + Vector2i(x, y)));
        }
    }
    std::size_t channel = 0;
    for (const std::string& name : channel_names()) {
        std::vector<float> values;
        for (const std::size_t i : pixels) {
            values.push_back(static_cast<float>(value(i, {0, 2}, channel)));
        }
        file.planes.push_back({.name = name, .samples = std::move(values)});
        ++channel;
    }
    if (dropped_samples() > 0) {
        std::vector<std::uint32_t> dropped;
        for (const std::size_t i : pixels) dropped.push_back(dropped_[i]);
        file.planes.push_back({.name = "samples.dropped", .samples = std::move(dropped)});
    }
    return file;
}

/// The sum of the weights of all samples, in the unit of the squares.
double FilmState::total_weight(std::size_t i) const {
    const std::int64_t negative = bin_count() > 2 ? weight(i, {0, 2}, 1) : 0;
    return static_cast<double>(weight(i, {0, 2}, 0) - negative) *
           std::ldexp(1.0, -FilmTile::coarse_shift);
}

std::optional<ErrorEstimate> FilmState::error() const {
    NoisyImage image = {.width = layout_.crop.size.x,
                        .height = layout_.crop.size.y,
                        .reach = layout_.reach + layout_.block - 1,
                        .correlation = layout_.noise_correlation,
                        .samples = std::accumulate(counts_.begin(), counts_.end(), 0.0),
                        .chance_luminance = layout_.chance_luminance};
    image.mean.resize(3 * pixel_count());
    image.squares.resize(pixel_count());
    image.deviation.resize(3 * pixel_count(), std::numeric_limits<float>::quiet_NaN());
    bool measurable = false;
    for (std::size_t pixel = 0; pixel < pixel_count(); ++pixel) {
        const std::size_t i = sampled_index(pixel);
        const auto a = static_cast<double>(weight(i, {0, 1}, 0));
        const auto b = static_cast<double>(weight(i, {1, 1}, 0));
        if (!(a > 0 && b > 0)) {
            const bool one_half = counts_[2 * i] == 0 || counts_[2 * i + 1] == 0;
            if (one_half && dropped_[i] == 0) return {};
            continue;
        }
        measurable = true;
        image.squares[pixel] = static_cast<float>(squares_[i].value() / sqr(total_weight(i)));
        // 1/2 for equal halves; else for variances in inverse proportion to the sizes.
        const double factor = std::sqrt(a * b) / (a + b);
        for (std::size_t c = 0; c < 3; ++c) {
            const double difference = value(i, {0, 1}, c) - value(i, {1, 1}, c);
            image.mean[3 * pixel + c] = static_cast<float>(value(i, {0, 2}, c));
            image.deviation[3 * pixel + c] = static_cast<float>(factor * std::abs(difference));
        }
    }
    if (!measurable) return {};
    return estimate_error(image);
}

}  // namespace lucerna
