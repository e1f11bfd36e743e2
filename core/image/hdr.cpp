// SPDX-License-Identifier: Apache-2.0
#include "core/image/hdr.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <new>
#include <string_view>

#include "core/base/error.h"
#include "core/base/file_bytes.h"

namespace lucerna {

namespace {

using Rgbe = std::array<std::uint8_t, 4>;

Color to_color(const Rgbe& p) {
    if (p[3] == 0) return Color(0);
    const float scale = std::ldexp(1.0f, int{p[3]} - 136);
    return Color(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])) *
           scale;
}

class HdrReader {
public:
    HdrReader(std::span<const std::uint8_t> bytes, const std::string& name)
        : bytes_(bytes), name_(name) {}

    Image read() {
        read_header();
        read_resolution();
        Image image(width_, height_);
        image.chromaticities = primaries_;
        if (exposure_ != 1) {
            image.notice = fmt::format(
                "its values were multiplied by an EXPOSURE of {:g}, which is "
                "not divided out",
                exposure_);
        }
        std::vector<Rgbe> row(static_cast<std::size_t>(width_));
        for (int y = 0; y < height_; ++y) {
            read_row(row);
            for (int x = 0; x < width_; ++x) {
                image.set_rgb(flip_x_ ? width_ - 1 - x : x, flip_y_ ? height_ - 1 - y : y,
                              to_color(row[static_cast<std::size_t>(x)]));
            }
        }
        return image;
    }

private:
    [[noreturn]] void damaged(std::string_view why) const {
        throw FileError(
            fmt::format("{}: is a damaged Radiance picture: {}; get it again", name_, why));
    }

    std::uint8_t next() {
        if (position_ >= bytes_.size()) damaged("it ends too early");
        return bytes_[position_++];
    }

    std::string line() {
        std::string text;
        for (char c = char(next()); c != '\n'; c = char(next())) {
            if (text.size() > 4096) damaged("a line of its header is too long");
            if (c != '\r') text += c;
        }
        return text;
    }

    void read_header() {
        if (!line().starts_with("#?")) damaged("it does not begin with #?");
        for (std::string text = line(); !text.empty(); text = line()) {
            if (text.starts_with("EXPOSURE=")) exposure_ *= numbers_of<1>(text)[0];
            if (text.starts_with("PRIMARIES=")) {
                const auto c = numbers_of<8>(text);
                primaries_ = {{c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}, {c[6], c[7]}};
            }
            if (!text.starts_with("FORMAT=")) continue;
            if (text == "FORMAT=32-bit_rle_xyze") {
                throw FileError(
                    fmt::format("{}: stores XYZ; convert it to RGB (ra_xyze -r)", name_));
            }
            if (text != "FORMAT=32-bit_rle_rgbe") damaged("its format is \"" + text + "\"");
        }
    }

    /// The numbers behind the = of a line of the header.
    template <std::size_t count>
    std::array<double, count> numbers_of(std::string_view text) const {
        std::array<double, count> numbers{};
        std::string_view rest = text.substr(text.find('=') + 1);
        for (double& number : numbers) {
            rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
            const auto [end, code] =
                std::from_chars(rest.data(), rest.data() + rest.size(), number);
            if (code != std::errc() || !std::isfinite(number)) {
                damaged(fmt::format("\"{}\" has not {} numbers", text, count));
            }
            rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
        }
        return numbers;
    }

    /// "-Y 512 +X 1024": rows from top to bottom, pixels from left to right.
    void read_resolution() {
        const std::string text = line();
        const auto axis = [&](std::size_t at, char letter) {
            return at + 2 < text.size() && (text[at] == '-' || text[at] == '+') &&
                   text[at + 1] == letter && text[at + 2] == ' ';
        };
        const std::size_t second = text.find(' ', 3) + 1;
        if (axis(0, 'X') && second > 0 && axis(second, 'Y')) {
            throw FileError(
                fmt::format("{}: is stored in columns; turn it upright (pfilt)", name_));
        }
        if (!axis(0, 'Y') || second == 0 || !axis(second, 'X')) {
            damaged("there is no size where it should be");
        }
        height_ = number(std::string_view(text).substr(3, second - 4));
        width_ = number(std::string_view(text).substr(second + 3));
        flip_y_ = text[0] == '+';
        flip_x_ = text[second] == '-';
        // A row of RGBE takes at least two bytes for every 127 equal ones.
        check_image_size(name_, width_, height_, 3, bytes_.size());
    }

    int number(std::string_view text) const {
        int value = 0;
        const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (code != std::errc() || end != text.data() + text.size())
            damaged("its size is no number");
        return value;
    }

    void read_row(std::vector<Rgbe>& row) {
        Rgbe first{next(), next(), next(), next()};
        const bool new_style = first[0] == 2 && first[1] == 2 && first[2] < 128;
        if (!new_style || row.size() < 8 || row.size() > 0x7fff) return read_old_row(row, first);
        if (std::size_t(first[2]) << 8 != row.size() - first[3])
            damaged("a row has the wrong length");
        for (std::size_t component = 0; component < 4; ++component) read_runs(row, component);
    }

    /// One component of a row: a count above 128 repeats one byte, others are followed by as many.
    void read_runs(std::vector<Rgbe>& row, std::size_t component) {
        for (std::size_t x = 0; x < row.size();) {
            const std::uint8_t code = next();
            const bool run = code > 128;
            const std::size_t count = run ? code - 128u : code;
            if (count == 0 || count > row.size() - x) damaged("a run leaves its row");
            std::uint8_t value = run ? next() : std::uint8_t{0};
            for (std::size_t i = 0; i < count; ++i) {
                if (!run) value = next();
                row[x++][component] = value;
            }
        }
    }

    /// Whole pixels; (1, 1, 1, n) repeats the last pixel n times, and if several of them follow
    /// each other, each counts 256 times more than the one before.
    void read_old_row(std::vector<Rgbe>& row, Rgbe pixel) {
        unsigned shift = 0;
        for (std::size_t x = 0; x < row.size();) {
            if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
                if (shift > 16) damaged("a run leaves its row");
                const std::size_t count = std::size_t(pixel[3]) << shift;
                if (x == 0 || count > row.size() - x) damaged("a run leaves its row");
                for (std::size_t i = 0; i < count; ++i, ++x) row[x] = row[x - 1];
                shift += 8;
            } else {
                row[x++] = pixel;
                shift = 0;
            }
            if (x < row.size()) pixel = {next(), next(), next(), next()};
        }
    }

    std::span<const std::uint8_t> bytes_;
    const std::string& name_;
    std::size_t position_ = 0;
    int width_ = 0, height_ = 0;
    double exposure_ = 1;  ///< product of all that the header names
    std::optional<Chromaticities> primaries_;
    bool flip_x_ = false, flip_y_ = false;
};

}  // namespace

Image decode_hdr(std::span<const std::uint8_t> bytes, const std::string& name) {
    try {
        return HdrReader(bytes, name).read();
    } catch (const std::bad_alloc&) {
        throw FileError(fmt::format("{}: does not fit into memory", name));
    }
}

Image read_hdr(const std::filesystem::path& path) {
    return decode_hdr(read_file_bytes(path), path.string());
}

}  // namespace lucerna
