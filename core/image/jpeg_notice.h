// SPDX-License-Identifier: Apache-2.0
/// What the markers of a JPEG file say beside its pixels.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/image/image.h"

namespace lucerna {

/// Sets what a colour profile says of the values of the picture (icc_profile.h). Returns what to
/// tell of a file whose pixels are taken as they are stored: that EXIF would turn them, or that
/// they have a profile that cannot be followed. Empty if there is no such thing.
std::string jpeg_notice(std::span<const std::uint8_t> file, Image& image);

}  // namespace lucerna
