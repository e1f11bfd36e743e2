// SPDX-License-Identifier: Apache-2.0
#include "core/image/jpeg_notice.h"

#include "core/image/icc_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace lucerna {

namespace {

using Bytes = std::span<const std::uint8_t>;

/// `count` bytes as a number; 0 if they are not all there.
std::uint32_t number_at(Bytes bytes, std::size_t offset, std::size_t count, bool little_endian) {
    if (offset > bytes.size() || bytes.size() - offset < count) return 0;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < count; ++i) {
        value = value << 8 | bytes[offset + (little_endian ? count - 1 - i : i)];
    }
    return value;
}

bool starts_with(Bytes bytes, std::string_view text) {
    return bytes.size() >= text.size() &&
           std::equal(text.begin(), text.end(), bytes.begin(),
                      [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

/// Orientation (0x0112) in the first directory of a TIFF structure: 1 is upright.
std::uint32_t orientation(Bytes tiff) {
    constexpr std::size_t entry = 12;
    const bool little = starts_with(tiff, "II");
    const std::size_t directory = number_at(tiff, 4, 4, little);
    const std::size_t count = number_at(tiff, directory, 2, little);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = directory + 2 + i * entry;
        if (number_at(tiff, at, 2, little) == 0x0112) return number_at(tiff, at + 8, 2, little);
    }
    return 1;
}

std::string segment_notice(std::uint8_t marker, Bytes segment, Image& image) {
    using namespace std::string_view_literals;
    constexpr std::string_view exif = "Exif\0\0"sv, icc = "ICC_PROFILE\0\1"sv;
    if (marker == 0xe1 && starts_with(segment, exif)) {
        const std::uint32_t turned = orientation(segment.subspan(exif.size()));
        if (turned < 2 || turned > 8) return "";
        return fmt::format(
            "its EXIF data ask for it to be turned (orientation {}); its pixels are "
            "taken as they are stored",
            turned);
    }
    // One byte follows: the number of parts of the profile. The tags are in the first.
    if (marker == 0xe2 && starts_with(segment, icc) && segment.size() > icc.size()) {
        return follow_icc_profile(segment.subspan(icc.size() + 1), image);
    }
    return "";
}

}  // namespace

std::string jpeg_notice(Bytes file, Image& image) {
    std::string notice;
    constexpr std::uint8_t start_of_scan = 0xda;
    for (std::size_t at = 2; at + 4 <= file.size() && file[at] == 0xff;) {
        const std::uint8_t marker = file[at + 1];
        const std::size_t size = number_at(file, at + 2, 2, false);
        if (marker == start_of_scan || size < 2 || size > file.size() - at - 2) break;
        const std::string more = segment_notice(marker, file.subspan(at + 4, size - 2), image);
        if (!more.empty()) notice += (notice.empty() ? "" : "; ") + more;
        at += 2 + size;
    }
    return notice;
}

}  // namespace lucerna
