// SPDX-License-Identifier: Apache-2.0
/// A comparison as a page: one HTML file with everything in it. The page is
/// plugins/commands/report, put together when Lucerna is built; here its data are added.
#pragma once

#include "core/base/json.h"
#include "plugins/commands/comparison/comparison.h"

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

namespace lucerna {

/// The page without data, made by plugins/commands/report/embed.cmake.
extern const unsigned char report_page[];
extern const std::size_t report_page_size;

/// IEEE 754 half precision, to nearest, ties to even; beyond ±65504 the largest half, since the
/// pictures are finite and should stay so.
inline std::uint16_t half_bits(float value) {
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

inline std::string base64(std::string_view bytes) {
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

/// Red, green and blue of all pixels as halves, low byte first.
inline std::string encoded_picture(const Image& image) {
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

/// A block of data that no browser runs. In JSON, "<" can stand in strings only.
inline std::string data_block(const std::string& id, const std::string& type,
                              const std::string& content) {
    std::string escaped;
    escaped.reserve(content.size());
    for (const char c : content) escaped += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return "<script type=\"" + type + "\" id=\"" + id + "\">" + escaped + "</script>\n";
}

inline std::string to_html(const ComparisonResult& result, const Json& report) {
    std::string data = data_block("report", "application/json", report.text());
    data += data_block("picture-0", "text/plain", encoded_picture(result.reference.image));
    int number = 0;
    for (const VariantRuns& variant : result.variants) {
        data += data_block("picture-" + std::to_string(++number), "text/plain",
                           encoded_picture(variant.picture));
    }
    std::string page(reinterpret_cast<const char*>(report_page), report_page_size);
    constexpr std::string_view marker = "<!-- data -->";
    return page.replace(page.find(marker), marker.size(), data);
}

}  // namespace lucerna
