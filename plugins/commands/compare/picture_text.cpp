// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/compare/picture_text.h"

#include <bit>

namespace lucerna {

std::uint16_t half_bits(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const auto sign = static_cast<std::uint16_t>((bits >> 16) & 0x8000u);
    const std::uint32_t magnitude = bits & 0x7fffffffu;
    if (magnitude >= 0x477ff000u) return static_cast<std::uint16_t>(sign | 0x7bffu);
    // Below the smallest normal half: adding 0.5 aligns the mantissa with multiples of 2^-24.
    if (magnitude < 0x38800000u) {
        const float aligned = std::bit_cast<float>(magnitude) + 0.5f;
        const std::uint32_t steps = std::bit_cast<std::uint32_t>(aligned) - 0x3f000000u;
        return static_cast<std::uint16_t>(sign | steps);
    }
    const std::uint32_t rounded = magnitude + 0xfffu + ((magnitude >> 13) & 1u);
    return static_cast<std::uint16_t>(sign | ((rounded - 0x38000000u) >> 13));
}

std::string base64(std::string_view bytes) {
    constexpr std::string_view digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto byte = k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u;
            group = (group << 8) | byte;
        }
        for (std::size_t k = 0; k < 4; ++k) {
            text += k <= count ? digits[(group >> (18 - 6 * k)) & 63u] : '=';
        }
    }
    return text;
}

std::string encoded_picture(const Image& image) {
    std::string bytes;
    bytes.reserve(6 * image.pixel_count());
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const Color color = image.rgb(i);
        for (int c = 0; c < 3; ++c) {
            const std::uint16_t half = half_bits(color[c]);
            bytes += static_cast<char>(half & 0xff);
            bytes += static_cast<char>(half >> 8);
        }
    }
    return base64(bytes);
}

}  // namespace lucerna
