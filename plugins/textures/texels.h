// SPDX-License-Identifier: Apache-2.0
/// The picture of a bitmap texture in memory.
#pragma once

#include "core/image/color.h"

#include <array>

namespace lucerna {

/// Pixels in one or three channels, linear or raw. A picture that came from 8-bit numbers is kept
/// as such, in a quarter of the memory, and decoded by a table.
class Texels {
public:
    Texels() = default;
    Texels(Image image, bool raw)
        : width_(image.width), height_(image.height), channels_(image.channels.size() < 3 ? 1 : 3) {
        if (image.srgb_encoded && take_bytes(image)) {
            for (int k = 0; k < 256; ++k) {
                const float encoded = static_cast<float>(k) / 255;
                decoded_[static_cast<std::size_t>(k)] = raw ? encoded : srgb_to_linear(encoded);
            }
            return;
        }
        ColorConfig().to_rendering(image, raw ? "raw" : "auto");
        floats_.reserve(image.pixel_count() * static_cast<std::size_t>(channels_));
        for (std::size_t i = 0; i < image.pixel_count(); ++i) {
            const Color c = image.rgb(i);
            bad_ += is_finite(c) ? 0 : 1;
            for (int k = 0; k < channels_; ++k) floats_.push_back(std::isfinite(c[k]) ? c[k] : 0);
        }
    }

    int width() const { return width_; }
    int height() const { return height_; }
    int channels() const { return channels_; }
    /// Pixels that held a NaN or an infinity, which are taken as 0.
    std::size_t bad() const { return bad_; }
    std::size_t bytes() const { return bytes_.size() + floats_.size() * sizeof(float); }

    Color operator()(int x, int y) const {
        const std::size_t i = (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                               static_cast<std::size_t>(x)) *
                              static_cast<std::size_t>(channels_);
        if (channels_ == 1) return Color(value(i));
        return {value(i), value(i + 1), value(i + 2)};
    }

private:
    float value(std::size_t i) const { return bytes_.empty() ? floats_[i] : decoded_[bytes_[i]]; }

    /// False if the numbers are not k / 255.
    bool take_bytes(const Image& image) {
        std::vector<std::uint8_t> bytes;
        bytes.reserve(image.pixel_count() * static_cast<std::size_t>(channels_));
        for (std::size_t i = 0; i < image.pixel_count(); ++i) {
            const Color c = image.rgb(i);
            for (int k = 0; k < channels_; ++k) {
                const float nearest = std::round(c[k] * 255);
                if (!(std::abs(c[k] * 255 - nearest) < 1e-3f)) return false;
                bytes.push_back(static_cast<std::uint8_t>(nearest));
            }
        }
        bytes_ = std::move(bytes);
        return true;
    }

    int width_ = 0, height_ = 0, channels_ = 1;
    std::vector<std::uint8_t> bytes_;
    std::vector<float> floats_;
    std::array<float, 256> decoded_{};
    std::size_t bad_ = 0;
};

}  // namespace lucerna
