// SPDX-License-Identifier: Apache-2.0
#include "core/image/plain_formats.h"

#include "core/base/atomic_file.h"
#include "core/base/error.h"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <string_view>

namespace lucerna {

namespace {

/// The bytes of a file, of which none beyond the end is read.
class Source {
public:
    Source(std::span<const std::uint8_t> bytes, const std::string& name, std::string_view format)
        : bytes_(bytes), name_(name), format_(format) {}

    [[noreturn]] void damaged(std::string_view why) const {
        throw FileError(
            fmt::format("{}: is a damaged {} picture: {}; get it again", name_, format_, why));
    }
    [[noreturn]] void refuse(std::string_view what) const {
        throw FileError(fmt::format("{}: is a {} picture {}, which is not read; save it as PNG",
                                    name_, format_, what));
    }

    std::span<const std::uint8_t> take(std::size_t count) {
        if (count > bytes_.size() - at_) damaged("it ends too early");
        at_ += count;
        return bytes_.subspan(at_ - count, count);
    }
    std::uint8_t byte() { return take(1)[0]; }
    /// Little-endian.
    std::uint32_t number(std::size_t size) {
        std::uint32_t value = 0;
        const std::span<const std::uint8_t> b = take(size);
        for (std::size_t i = 0; i < size; ++i) value |= std::uint32_t{b[i]} << (8 * i);
        return value;
    }
    void skip_to(std::size_t place) {
        if (place > bytes_.size()) damaged("it ends too early");
        at_ = place;
    }
    /// Up to the next white space, which is taken, too; comments of portable maps are left out.
    std::string word() {
        std::string text;
        for (;;) {
            const std::uint8_t c = byte();
            const bool space = c == ' ' || (c >= '\t' && c <= '\r');
            if (c == '#' && text.empty()) {
                while (byte() != '\n') {
                }
            } else if (!space) {
                text += static_cast<char>(c);
                if (text.size() > 32) damaged("its header has no numbers");
            } else if (!text.empty()) {
                return text;
            }
        }
    }

    Image image(std::int64_t width, std::int64_t height, std::vector<std::string> channels) const {
        check_image_size(name_, width, height, static_cast<std::int64_t>(channels.size()),
                         bytes_.size());
        Image image(static_cast<int>(width), static_cast<int>(height), std::move(channels));
        image.srgb_encoded = true;
        image.eight_bits = true;
        return image;
    }

private:
    std::span<const std::uint8_t> bytes_;
    const std::string& name_;
    std::string_view format_;
    std::size_t at_ = 0;
};

std::vector<std::string> channels_of(std::size_t count) {
    if (count == 1) return {"Y"};
    if (count == 3) return {"R", "G", "B"};
    return {"R", "G", "B", "A"};
}

/// Sets a pixel from grey, or from blue, green, red and perhaps alpha.
void set_pixel(Image& image, int x, int y, std::span<const std::uint8_t> bgr) {
    float* const p = image.at(x, y);
    for (std::size_t c = 0; c < image.channel_count(); ++c) {
        const std::size_t from = c < 3 && bgr.size() >= 3 ? 2 - c : c;
        p[c] = static_cast<float>(bgr[from]) / 255;
    }
}

}  // namespace

Image decode_bmp(std::span<const std::uint8_t> bytes, const std::string& name) {
    Source source(bytes, name, "BMP");
    source.skip_to(10);
    const std::size_t pixels = source.number(4);
    const std::size_t header = source.number(4);
    if (header < 40) source.refuse("of OS/2");
    const auto width = static_cast<std::int32_t>(source.number(4));
    const auto signed_height = static_cast<std::int32_t>(source.number(4));
    const bool top_down = signed_height < 0;
    const std::int64_t height = std::abs(std::int64_t{signed_height});
    source.number(2);  // planes
    const std::uint32_t bits = source.number(2);
    const std::uint32_t compression = source.number(4);
    source.take(12);  // bytes of the pixels, pixels for each metre
    const std::uint32_t used_colors = source.number(4);
    constexpr std::uint32_t bit_fields = 3;
    if (compression == bit_fields && bits == 32) {
        source.skip_to(54);
        if (source.number(4) != 0xff0000 || source.number(4) != 0xff00 ||
            source.number(4) != 0xff) {
            source.refuse("with an unusual order of its channels");
        }
    } else if (compression != 0) {
        source.refuse("with compression");
    }
    if (bits != 1 && bits != 4 && bits != 8 && bits != 24 && bits != 32) {
        source.refuse(fmt::format("of {} bits for each pixel", bits));
    }
    std::span<const std::uint8_t> palette;
    if (bits <= 8) {
        source.skip_to(14 + header);
        const std::uint32_t colors = used_colors == 0 ? 1u << bits : used_colors;
        if (colors > 1u << bits) source.damaged("its palette is too large");
        palette = source.take(std::size_t{4} * colors);
    }
    // The fourth byte of 32 bits has a meaning in newer headers only.
    Image image = source.image(width, height, channels_of(3));
    source.skip_to(pixels);
    const std::size_t row_bytes = (static_cast<std::size_t>(width) * bits + 31) / 32 * 4;
    for (int row = 0; row < image.height; ++row) {
        const std::span<const std::uint8_t> data = source.take(row_bytes);
        const int y = top_down ? row : image.height - 1 - row;
        for (int x = 0; x < image.width; ++x) {
            const auto i = static_cast<std::size_t>(x);
            if (bits > 8) {
                set_pixel(image, x, y, data.subspan(i * bits / 8, 3));
                continue;
            }
            const std::size_t bit = i * bits;
            const std::size_t color =
                (data[bit / 8] >> (8 - bits - bit % 8)) & ((std::size_t{1} << bits) - 1);
            if (4 * color >= palette.size()) source.damaged("a pixel lies beyond its palette");
            set_pixel(image, x, y, palette.subspan(4 * color, 3));
        }
    }
    return image;
}

Image decode_tga(std::span<const std::uint8_t> bytes, const std::string& name) {
    Source source(bytes, name, "TGA");
    const std::size_t id_bytes = source.byte();
    const bool has_palette = source.byte() == 1;
    const std::uint8_t type = source.byte();
    const std::size_t first_color = source.number(2), colors = source.number(2);
    const std::uint32_t color_bits = source.byte();
    source.take(4);  // its place on the screen
    const std::int64_t width = source.number(2), height = source.number(2);
    const std::uint32_t pixel_bits = source.byte();
    const std::uint8_t descriptor = source.byte();
    const bool top_down = (descriptor & 0x20) != 0, right_to_left = (descriptor & 0x10) != 0;
    const int kind = type & 7;
    const bool runs = (type & 8) != 0;
    if ((type & ~11) != 0 || kind == 0) source.refuse(fmt::format("of type {}", type));
    const bool indexed = kind == 1;
    const std::uint32_t bits = indexed ? color_bits : pixel_bits;
    if (bits != 8 && bits != 24 && bits != 32) {
        source.refuse(fmt::format("of {} bits for each color", bits));
    }
    if (indexed && pixel_bits != 8) {
        source.refuse(fmt::format("with indices of {} bits", pixel_bits));
    }
    if (indexed ? !has_palette : (kind == 3) != (bits == 8)) {
        source.damaged("its header contradicts itself");
    }
    // A color of 15 bits fills two bytes, also in a palette that is not used.
    const std::size_t color_bytes = (color_bits + 7) / 8, pixel_bytes = pixel_bits / 8;
    const std::size_t bytes_of_color = bits / 8;
    source.take(id_bytes);
    const std::span<const std::uint8_t> palette =
        source.take(has_palette ? colors * color_bytes : 0);
    Image image = source.image(width, height, channels_of(bytes_of_color));
    std::size_t left = 0;  // pixels of the present run or stretch
    bool repeats = false;
    std::span<const std::uint8_t> pixel;
    for (int row = 0; row < image.height; ++row) {
        for (int column = 0; column < image.width; ++column) {
            bool is_new = true;
            if (runs) {
                if (left == 0) {
                    const std::uint8_t packet = source.byte();
                    repeats = packet >= 128;
                    left = packet % 128 + std::size_t{1};
                } else {
                    is_new = !repeats;
                }
                --left;
            }
            if (is_new) {
                pixel = source.take(pixel_bytes);
                if (indexed) {
                    const std::size_t place = pixel[0] - first_color;  // wraps if it is below
                    if (place >= colors) source.damaged("a pixel lies beyond its palette");
                    pixel = palette.subspan(place * color_bytes, color_bytes);
                }
            }
            set_pixel(image, right_to_left ? image.width - 1 - column : column,
                      top_down ? row : image.height - 1 - row, pixel);
        }
    }
    return image;
}

Image decode_portable_map(std::span<const std::uint8_t> bytes, const std::string& name) {
    Source source(bytes, name, "Netpbm");
    const std::string type = source.word();
    const auto number = [&](auto value) {
        const std::string text = source.word();
        const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (code != std::errc() || end != text.data() + text.size()) {
            source.damaged(fmt::format("\"{}\" should be a number", text));
        }
        return value;
    };
    const bool floats = type == "PF" || type == "Pf";
    if (!floats && type != "P5" && type != "P6") source.refuse("of type " + type);
    const int width = number(0), height = number(0);
    const std::size_t channels = type == "PF" || type == "P6" ? 3 : 1;
    if (floats) {
        const double scale = number(0.0);
        if (scale == 0 || !std::isfinite(scale)) source.damaged("its scale is not a number");
        const auto factor = static_cast<float>(std::abs(scale));
        Image image = source.image(width, height, channels_of(channels));
        image.srgb_encoded = false;
        image.eight_bits = false;
        for (int y = height - 1; y >= 0; --y) {
            float* p = image.at(0, y);
            for (std::size_t i = 0; i < static_cast<std::size_t>(width) * channels; ++i) {
                const std::uint32_t stored = source.number(4);
                p[i] =
                    factor * std::bit_cast<float>(scale < 0 ? stored : __builtin_bswap32(stored));
            }
        }
        return image;
    }
    const int largest = number(0);
    if (largest < 1 || largest > 65535) source.damaged("its largest value is not in 1 … 65535");
    const bool wide = largest > 255;
    Image image = source.image(width, height, channels_of(channels));
    image.eight_bits = largest == 255;
    for (float& value : image.pixels) {
        const int high = wide ? source.byte() : 0;
        value = static_cast<float>(std::min(256 * high + source.byte(), largest)) /
                static_cast<float>(largest);
    }
    return image;
}

void write_portable_float_map(const std::filesystem::path& path, const Image& image) {
    const std::size_t channels = image.channel_count();
    if (channels != 1 && channels != 3) {
        throw Error(
            fmt::format("a portable float map has one or three channels, not {}", channels));
    }
    // A negative scale: little-endian. The lowest row comes first.
    std::string bytes =
        fmt::format("{}\n{} {}\n-1.0\n", channels == 3 ? "PF" : "Pf", image.width, image.height);
    bytes.reserve(bytes.size() + 4 * image.pixels.size());
    for (int y = image.height - 1; y >= 0; --y) {
        const float* row = image.at(0, y);
        for (std::size_t i = 0; i < static_cast<std::size_t>(image.width) * channels; ++i) {
            const auto value = std::bit_cast<std::uint32_t>(row[i]);
            for (const int shift : {0, 8, 16, 24}) {
                bytes += static_cast<char>(static_cast<std::uint8_t>(value >> shift));
            }
        }
    }
    write_file_atomically(path, bytes);
}

}  // namespace lucerna
