// SPDX-License-Identifier: Apache-2.0
/// PNG files. png.cpp is the only user of libpng.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/image/image.h"

namespace lucerna {

/// Reads any PNG, of 1 to 16 bits, into channels "Y", "YA", "RGB" or "RGBA"; palettes are looked
/// up. Values are stored ones divided by the largest, in [0, 1]. They are marked as encoded by the
/// power and the primaries of gAMA and cHRM, or by those of an ICC profile (icc_profile.h); by sRGB
/// if there is neither, if sRGB overrules them, or if gAMA is 1/2.2, which is written for sRGB.
/// Throws FileError with the name of the file and what to do for damaged files.
Image read_png(const std::filesystem::path& path);

/// The same from memory; `name` is what errors call it.
Image decode_png(std::span<const std::uint8_t> bytes, const std::string& name);

/// Writes 8 bit RGB or RGBA, marked as sRGB, completely or not at all (atomic_file.h).
/// Throws FileError if writing fails.
void write_png(const std::filesystem::path& path, const Image8& image);

/// The same into memory.
std::string encode_png(const Image8& image);

}  // namespace lucerna
