// SPDX-License-Identifier: Apache-2.0
#include "core/image/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <span>

#include "core/base/error.h"

namespace lucerna {

namespace {

constexpr std::int64_t max_side = 65536;
/// Below this many bytes in memory an image is never suspicious.
constexpr std::int64_t always_accepted = std::int64_t(1) << 30;
/// No compression in use shrinks a picture more than this.
constexpr std::int64_t max_compression = 4096;

std::string_view layer_of(std::string_view plane) {
    const std::size_t dot = plane.rfind('.');
    return dot == std::string_view::npos ? std::string_view() : plane.substr(0, dot);
}

std::string_view channel_of(std::string_view plane) {
    return plane.substr(plane.rfind('.') + 1);  // npos + 1 is 0
}

/// Names of channels as OpenEXR has them for what others call "r", "red" or "Red".
std::string standard_name(std::string_view channel) {
    std::string name(channel);
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
    for (const char* const known : {"red", "green", "blue", "alpha", "r", "g", "b", "a"}) {
        if (name == known) return std::string(1, static_cast<char>(std::toupper(name[0])));
    }
    return std::string(channel);
}

/// Colour first, then alpha, then everything else. Z is depth, but for what has an X, too.
std::size_t channel_rank(std::string_view channel, bool is_xyz) {
    constexpr std::array<std::string_view, 5> rgb{"R", "G", "B", "Y", "A"};
    constexpr std::array<std::string_view, 4> xyz{"X", "Y", "Z", "A"};
    const std::span<const std::string_view> order =
        is_xyz ? std::span<const std::string_view>(xyz) : rgb;
    return std::size_t(std::ranges::find(order, channel) - order.begin());
}

/// Empty if the first channels are a colour or a grey, else what is made of them.
std::string notice_of_channels(const std::vector<std::string>& names) {
    const auto begins = [&](const std::vector<std::string>& first) {
        return names.size() >= first.size() &&
               std::equal(first.begin(), first.end(), names.begin());
    };
    if (names.size() < 2 || begins({"R", "G", "B"}) || begins({"X", "Y", "Z"}) || begins({"Y"})) {
        return {};
    }
    return fmt::format("its channels are {}; {}", join(names),
                       names.size() < 3 ? fmt::format("\"{}\" is taken as grey", names[0])
                                        : "the first three are taken as red, green and blue");
}

}  // namespace

Image::Image(int width_, int height_, std::vector<std::string> channels_)
    : width(width_), height(height_), channels(std::move(channels_)) {
    if (width <= 0 || height <= 0) {
        throw Error(
            fmt::format("an image of {} x {} pixels: both must be positive", width, height));
    }
    pixels.resize(pixel_count() * channels.size());
}

void Image::set_rgb(int x, int y, Color color) {
    float* p = at(x, y);
    p[0] = color.x;
    if (channels.size() < 3) return;
    p[1] = color.y;
    p[2] = color.z;
}

std::optional<std::size_t> Image::channel(std::string_view name) const {
    const auto found = std::find(channels.begin(), channels.end(), name);
    if (found == channels.end()) return {};
    return std::size_t(found - channels.begin());
}

const Plane* ImageFile::plane(std::string_view name) const {
    for (const Plane& p : planes) {
        if (p.name == name) return &p;
    }
    return nullptr;
}

std::vector<std::string> ImageFile::layers() const {
    std::vector<std::string> names;
    for (const Plane& p : planes) {
        const std::string layer(layer_of(p.name));
        if (std::find(names.begin(), names.end(), layer) == names.end()) names.push_back(layer);
    }
    return names;
}

Image to_image(const ImageFile& file, std::string_view layer) {
    std::vector<const Plane*> chosen;
    for (const Plane& p : file.planes) {
        if (layer_of(p.name) == layer) chosen.push_back(&p);
    }
    if (chosen.empty()) {
        throw Error(fmt::format("there is no layer \"{}\" in the image; there are: \"{}\"", layer,
                                join(file.layers(), "\", \"")));
    }
    const auto name_of = [](const Plane* p) { return standard_name(channel_of(p->name)); };
    const auto has = [&](const char* name) {
        return std::ranges::find(chosen, name, name_of) != chosen.end();
    };
    const bool is_xyz = has("X") && has("Y") && has("Z") && !has("R");
    std::stable_sort(chosen.begin(), chosen.end(), [&](const Plane* a, const Plane* b) {
        return channel_rank(name_of(a), is_xyz) < channel_rank(name_of(b), is_xyz);
    });

    std::vector<std::string> names;
    for (const Plane* p : chosen) names.push_back(name_of(p));
    const std::string notice = notice_of_channels(names);
    Image image(file.width, file.height, std::move(names));
    image.chromaticities = file.chromaticities;
    image.notice = file.notice + (file.notice.empty() || notice.empty() ? "" : "; ") + notice;
    for (std::size_t c = 0; c < chosen.size(); ++c) {
        const auto interleave = [&](const auto& samples) {
            if (samples.size() != image.pixel_count()) {
                throw Error(fmt::format("channel \"{}\" has {} samples instead of {}",
                                        chosen[c]->name, samples.size(), image.pixel_count()));
            }
            for (std::size_t i = 0; i < samples.size(); ++i) {
                image.pixels[i * chosen.size() + c] = static_cast<float>(samples[i]);
            }
        };
        std::visit(interleave, chosen[c]->samples);
    }
    return image;
}

Image one_channel(const Image& image, std::size_t index) {
    Image result = image;
    result.channels = {"Y"};
    result.pixels.resize(image.pixel_count());
    const std::size_t stride = image.channel_count();
    for (std::size_t i = 0; i < result.pixels.size(); ++i) {
        result.pixels[i] = image.pixels[i * stride + index];
    }
    if (image.channels[index] == "A") {
        result.srgb_encoded = false;
        result.gamma = 1;
    }
    return result;
}

Image placed(const Image& image, Vector2i offset, Vector2i size) {
    Image result = image;
    result.width = size.x;
    result.height = size.y;
    result.pixels.assign(result.pixel_count() * result.channel_count(), 0);
    const int left = std::max(offset.x, 0), right = std::min(offset.x + image.width, size.x);
    const int top = std::max(offset.y, 0), bottom = std::min(offset.y + image.height, size.y);
    if (left >= right) return result;
    const auto row = static_cast<std::ptrdiff_t>(image.channel_count()) * (right - left);
    for (int y = top; y < bottom; ++y) {
        std::copy_n(image.at(left - offset.x, y - offset.y), row, result.at(left, y));
    }
    return result;
}

void add_layer(ImageFile& file, const Image& image, std::string_view layer, bool half) {
    if (file.planes.empty() && file.width == 0 && file.height == 0) {
        file.width = image.width;
        file.height = image.height;
    }
    if (file.width != image.width || file.height != image.height) {
        throw Error(fmt::format("layer \"{}\" has {} x {} pixels, the file has {} x {}", layer,
                                image.width, image.height, file.width, file.height));
    }
    const std::size_t stride = image.channel_count();
    for (std::size_t c = 0; c < stride; ++c) {
        const std::string& channel = image.channels[c];
        Plane plane{.name = layer.empty() ? channel : fmt::format("{}.{}", layer, channel),
                    .half = half};
        if (file.plane(plane.name)) {
            throw Error(fmt::format("the channel \"{}\" is there twice", plane.name));
        }
        std::vector<float> samples(image.pixel_count());
        for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = image.pixels[i * stride + c];
        plane.samples = std::move(samples);
        file.planes.push_back(std::move(plane));
    }
}

void check_image_size(const std::string& name, std::int64_t width, std::int64_t height,
                      std::int64_t channels, std::size_t file_bytes) {
    if (width <= 0 || height <= 0 || channels <= 0) {
        throw FileError(
            fmt::format("{}: it says it has {} x {} pixels of {} channels: it is damaged", name,
                        width, height, channels));
    }
    if (width > max_side || height > max_side || channels > max_side) {
        throw FileError(fmt::format(
            "{}: it says it has {} x {} pixels of {} channels, more than the {} that can be read; "
            "it is damaged, or must be scaled down first",
            name, width, height, channels, max_side));
    }
    // At most 2^48 samples, so 2^50 bytes.
    const std::int64_t bytes = width * height * channels * std::int64_t(sizeof(float));
    if (bytes > always_accepted && bytes / max_compression > std::int64_t(file_bytes)) {
        throw FileError(
            fmt::format("{}: it says it has {} x {} pixels of {} channels ({} MiB), but it is only "
                        "{} bytes long: it is damaged, get it again",
                        name, width, height, channels, bytes >> 20, file_bytes));
    }
}

}  // namespace lucerna
