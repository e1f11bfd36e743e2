// SPDX-License-Identifier: Apache-2.0
#include "core/render/film_state.h"

#include "core/plugin/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <numeric>

namespace lucerna {

namespace {

bool all_finite(const PixelSample& sample) {
    return is_finite(sample.radiance) && std::isfinite(sample.alpha) &&
           std::all_of(sample.layers.begin(), sample.layers.end(),
                       [](float x) { return std::isfinite(x); });
}

}  // namespace

FilmState::FilmState(FilmLayout layout, std::uint64_t first_sample)
    : layout_(std::move(layout)), first_sample_(first_sample) {
    const std::size_t pixels = static_cast<std::size_t>(layout_.crop.size.x) *
                               static_cast<std::size_t>(layout_.crop.size.y);
    try {
        sums_.resize(pixels * bin_count() * channel_count());
        counts_.resize(pixels * bin_count());
        dropped_.resize(pixels);
    } catch (const std::bad_alloc&) {
        const std::size_t bytes =
            pixels * (bin_count() * (channel_count() * sizeof(ExactSum) + 4) + 4);
        throw Error(
            fmt::format("not enough memory for a film of {} × {} pixels and {} channels, "
                        "which needs {} MiB; render less of it with --crop",
                        layout_.crop.size.x, layout_.crop.size.y, channel_count(), bytes >> 20));
    }
}

void FilmState::add(std::size_t pixel, bool negative, const PixelSample& sample) {
    if (!all_finite(sample)) {
        ++dropped_[pixel];
        return;
    }
    const std::size_t half = (first_sample_ + samples(pixel)) & 1;
    const std::size_t bin = pixel * bin_count() + half + (negative ? 2 : 0);
    ++counts_[bin];
    ExactSum* sum = sums_.data() + bin * channel_count();
    for (int c = 0; c < 3; ++c) (sum++)->add(static_cast<double>(sample.radiance[c]));
    (sum++)->add(static_cast<double>(sample.alpha));
    for (const float x : sample.layers) (sum++)->add(static_cast<double>(x));
}

std::uint64_t FilmState::finite_samples(std::size_t pixel, Halves halves) const {
    std::uint64_t result = 0;
    for (std::size_t bin = 0; bin < bin_count(); ++bin) {
        const int half = static_cast<int>(bin & 1);
        if (half < halves.first || half >= halves.first + halves.count) continue;
        result += counts_[pixel * bin_count() + bin];
    }
    return result;
}

std::uint64_t FilmState::samples(std::size_t pixel) const {
    return dropped_[pixel] + finite_samples(pixel, {0, 2});
}

std::uint64_t FilmState::complete_samples() const {
    std::uint64_t result = samples(0);
    for (std::size_t i = 1; i < pixel_count(); ++i) result = std::min(result, samples(i));
    return result;
}

std::uint64_t FilmState::most_samples() const {
    std::uint64_t result = 0;
    for (std::size_t i = 0; i < pixel_count(); ++i) result = std::max(result, samples(i));
    return result;
}

std::uint64_t FilmState::dropped_samples() const {
    return std::accumulate(dropped_.begin(), dropped_.end(), std::uint64_t{0});
}

std::optional<Vector2i> FilmState::first_dropped_pixel() const {
    const auto first = std::find_if(dropped_.begin(), dropped_.end(), [](auto n) { return n > 0; });
    if (first == dropped_.end()) return {};
    const int index = static_cast<int>(first - dropped_.begin());
    const int width = layout_.crop.size.x;
    return layout_.crop.offset + Vector2i(index % width, index / width);
}

std::size_t FilmState::empty_pixels() const {
    std::size_t result = 0;
    for (std::size_t i = 0; i < pixel_count(); ++i) result += finite_samples(i, {0, 2}) == 0;
    return result;
}

void FilmState::merge(const FilmState& next) {
    if (!(layout_ == next.layout_)) {
        throw Error("the two films differ in size, crop window, filter or layers");
    }
    for (std::size_t i = 0; i < pixel_count(); ++i) {
        const std::uint64_t end = first_sample_ + samples(i);
        if (end == next.first_sample_) continue;
        throw Error(fmt::format(
            "samples {} to {} of a pixel cannot be followed by samples {} to {}: {}", first_sample_,
            end, next.first_sample_, next.first_sample_ + next.samples(i),
            end < next.first_sample_ ? "those between are missing" : "some would count twice"));
    }
    for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i].add(next.sums_[i]);
    for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += next.counts_[i];
    for (std::size_t i = 0; i < dropped_.size(); ++i) dropped_[i] += next.dropped_[i];
}

/// Without negative lobes the plain mean. With them, the positive and the negative part of the
/// filter are estimated each by the mean of its own samples (post-stratification): a constant stays
/// exactly constant, and no weight is ever divided by that could cancel to zero.
double FilmState::mean_of(std::size_t pixel, Halves halves, std::size_t channel) const {
    double part[2] = {0, 0};
    std::uint64_t count[2] = {0, 0};
    for (std::size_t sign = 0; sign < bin_count() / 2; ++sign) {
        ExactSum sum;
        for (int half = halves.first; half < halves.first + halves.count; ++half) {
            const std::size_t bin = pixel * bin_count() + static_cast<std::size_t>(half) + 2 * sign;
            sum.add(sums_[bin * channel_count() + channel]);
            count[sign] += counts_[bin];
        }
        if (count[sign] > 0) part[sign] = sum.value() / static_cast<double>(count[sign]);
    }
    if (count[1] == 0) return part[0];
    if (count[0] == 0) return part[1];
    return part[0] + layout_.negative_weight * (part[0] - part[1]);
}

double FilmState::half_mean(std::size_t pixel, int half, std::size_t channel) const {
    return mean_of(pixel, {half, 1}, channel);
}

double FilmState::mean(std::size_t pixel, std::size_t channel) const {
    return mean_of(pixel, {0, 2}, channel);
}

std::vector<std::string> FilmState::channel_names() const {
    std::vector<std::string> names = {"R", "G", "B", "A"};
    names.insert(names.end(), layout_.layers.begin(), layout_.layers.end());
    return names;
}

ImageFile FilmState::resolve() const {
    ImageFile file;
    file.width = layout_.crop.size.x;
    file.height = layout_.crop.size.y;
    file.x = layout_.crop.offset.x;
    file.y = layout_.crop.offset.y;
    file.full_width = layout_.full_size.x;
    file.full_height = layout_.full_size.y;
    std::size_t channel = 0;
    for (const std::string& name : channel_names()) {
        std::vector<float> values(pixel_count());
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = static_cast<float>(mean(i, channel));
        }
        file.planes.push_back({.name = name, .samples = std::move(values)});
        ++channel;
    }
    if (dropped_samples() > 0) {
        file.planes.push_back({.name = "samples.dropped", .samples = dropped_});
    }
    return file;
}

std::optional<ErrorEstimate> FilmState::error() const {
    NoisyImage image = {.width = layout_.crop.size.x, .height = layout_.crop.size.y};
    image.mean.resize(3 * pixel_count());
    image.deviation.resize(3 * pixel_count(), std::numeric_limits<float>::quiet_NaN());
    bool measurable = false;
    for (std::size_t i = 0; i < pixel_count(); ++i) {
        const double a = static_cast<double>(finite_samples(i, {0, 1}));
        const double b = static_cast<double>(finite_samples(i, {1, 1}));
        if (a == 0 || b == 0) {
            if (dropped_[i] == 0) return {};
            continue;
        }
        measurable = true;
        // 1/2 for equal halves; else for variances in inverse proportion to the sizes.
        const double factor = std::sqrt(a * b) / (a + b);
        for (std::size_t c = 0; c < 3; ++c) {
            const double difference = half_mean(i, 0, c) - half_mean(i, 1, c);
            image.mean[3 * i + c] = static_cast<float>(mean(i, c));
            image.deviation[3 * i + c] = static_cast<float>(factor * std::abs(difference));
        }
    }
    if (!measurable) return {};
    return estimate_error(image);
}

}  // namespace lucerna
