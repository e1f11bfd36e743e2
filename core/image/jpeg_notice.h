// SPDX-License-Identifier: Apache-2.0
/// What the markers of a JPEG file say beside its pixels.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace lucerna {

/// What to tell of a file whose pixels are taken as they are stored: that EXIF would turn them, or
/// that they have a colour profile which is not that of sRGB. Empty if there is no such thing.
std::string jpeg_notice(std::span<const std::uint8_t> file);

}  // namespace lucerna
