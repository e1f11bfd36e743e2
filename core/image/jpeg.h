// SPDX-License-Identifier: Apache-2.0
/// JPEG files. jpeg.cpp is the only user of libjpeg-turbo.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/image/image.h"

namespace lucerna {

/// Reads a grey, colour or CMYK JPEG into channels "Y" or "RGB", in [0, 1], marked as sRGB encoded
/// or as its colour profile says. A notice tells of an orientation and of a profile that are not
/// followed, and of CMYK. Throws FileError with the name of the file and what to do for damaged
/// files.
Image read_jpeg(const std::filesystem::path& path);

/// The same from memory; `name` is what errors call it.
Image decode_jpeg(std::span<const std::uint8_t> bytes, const std::string& name);

}  // namespace lucerna
