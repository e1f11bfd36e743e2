// SPDX-License-Identifier: Apache-2.0
/// Pictures as textures and environments read them.
#pragma once

#include "core/base/huge_pages.h"
#include "core/image/color.h"
#include "core/math/half.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace lucerna {

/// Pixels in one or three channels, linear or raw. They lie in square tiles, so that the four
/// around a point are mostly in one line of the cache: 4 × 4 texels, or 8 × 8 grey values of 8
/// bits. Pictures of 8 bits are kept as such and decoded by a table; other numbers are kept in 16
/// bits if these hold all of them exactly.
class Texels {
public:
    Texels() = default;
    Texels(Image image, bool raw)
        : width_(image.width), height_(image.height), channels_(image.channels.size() < 3 ? 1 : 3) {
        const bool own_primaries =
            image.chromaticities && *image.chromaticities != Chromaticities::rec709();
        const bool as_bytes = image.eight_bits && (raw || channels_ == 1 || !own_primaries);
        if (as_bytes) {
            fill_table(image, raw);
        } else {
            ColorConfig().to_rendering(image, raw ? "raw" : "auto");
        }
        const bool as_halves = !as_bytes && fits_in_halves(image);
        stride_ = channels_ == 1 ? 1 : as_bytes || as_halves ? 4 : 3;
        shift_ = as_bytes && channels_ == 1 ? 3 : 2;
        tiles_per_row_ = (static_cast<std::size_t>(width_ - 1) >> shift_) + 1;
        const std::size_t tiles_per_column = (static_cast<std::size_t>(height_ - 1) >> shift_) + 1;
        const std::size_t numbers = (tiles_per_row_ * tiles_per_column << 2 * shift_) * stride_;
        if (as_bytes) {
            bytes_.resize(numbers);
            store(image, bytes_, [](float v) { return static_cast<std::uint8_t>(v * 255 + 0.5f); });
        } else if (as_halves) {
            halves_.resize(numbers);
            store(image, halves_, half::bits_of);
        } else {
            floats_.resize(numbers);
            store(image, floats_, [](float v) { return std::isfinite(v) ? v : 0.0f; });
        }
    }

    int width() const { return width_; }
    int height() const { return height_; }
    int channels() const { return channels_; }
    /// Pixels that held a NaN or an infinity, which are taken as 0.
    std::size_t bad() const { return bad_; }
    /// Of each number in memory.
    std::size_t bits() const { return !bytes_.empty() ? 8 : !halves_.empty() ? 16 : 32; }

    /// The place of a texel is that of its column plus that of its row.
    std::size_t column(int x) const {
        const auto i = static_cast<std::size_t>(x);
        return ((i >> shift_ << 2 * shift_) + (i & mask())) * stride_;
    }
    std::size_t row(int y) const {
        const auto i = static_cast<std::size_t>(y);
        return (((i >> shift_) * tiles_per_row_ << 2 * shift_) + ((i & mask()) << shift_)) *
               stride_;
    }
    /// The colour at a place; its last component means nothing.
    FourFloats at(std::size_t place) const {
        if (!bytes_.empty()) {
            const std::uint8_t* const p = bytes_.data() + place;
            if (channels_ == 1) return all_equal(decoded_[p[0]]);
            return FourFloats{decoded_[p[0]], decoded_[p[1]], decoded_[p[2]], 0};
        }
        if (!halves_.empty()) {
            half::Four four{halves_[place]};
            if (channels_ == 1) return all_equal(half::to_floats(four)[0]);
            std::memcpy(&four, halves_.data() + place, sizeof four);
            return half::to_floats(four);
        }
        const float* const p = floats_.data() + place;
        if (channels_ == 1) return all_equal(p[0]);
        return FourFloats{p[0], p[1], p[2], 0};
    }
    Color operator()(int x, int y) const { return to_vector3(at(column(x) + row(y))); }

private:
    static FourFloats all_equal(float v) { return FourFloats{v, v, v, v}; }
    std::size_t mask() const { return (std::size_t{1} << shift_) - 1; }

    bool fits_in_halves(const Image& image) const {
        for (std::size_t i = 0; i < image.pixel_count(); ++i) {
            const Color c = image.rgb(i);
            if (!half::holds(c.x) || !half::holds(c.y) || !half::holds(c.z)) return false;
        }
        return true;
    }

    void fill_table(const Image& image, bool raw) {
        for (int k = 0; k < 256; ++k) {
            const float encoded = static_cast<float>(k) / 255;
            decoded_[static_cast<std::size_t>(k)] = raw ? encoded : decoded(image, encoded);
        }
    }

    template <typename Numbers, typename Convert>
    void store(const Image& image, Numbers& numbers, const Convert& convert) {
        for (int y = 0; y < height_; ++y) {
            for (int x = 0; x < width_; ++x) {
                const Color c = image.rgb(x, y);
                bad_ += is_finite(c) ? 0 : 1;
                const std::size_t place = column(x) + row(y);
                for (int k = 0; k < channels_; ++k) {
                    numbers[place + static_cast<std::size_t>(k)] = convert(c[k]);
                }
            }
        }
    }

    int width_ = 0, height_ = 0, channels_ = 1;
    std::size_t stride_ = 1;  ///< numbers from one texel to the next
    std::size_t shift_ = 0;   ///< a tile has 2^shift_ rows and columns
    std::size_t tiles_per_row_ = 0;
    std::vector<std::uint8_t, HugePages<std::uint8_t>> bytes_;
    std::vector<std::uint16_t, HugePages<std::uint16_t>> halves_;
    std::vector<float, HugePages<float>> floats_;
    std::array<float, 256> decoded_{};
    std::size_t bad_ = 0;
};

}  // namespace lucerna
