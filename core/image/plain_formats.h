// SPDX-License-Identifier: Apache-2.0
/// Pictures in formats that store pixels nearly as they are: BMP, Truevision TGA, and the portable
/// maps PGM, PPM and PFM of Netpbm and Debevec.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/image/image.h"

namespace lucerna {

// Integers are marked as sRGB, the floats of PFM are linear. All throw FileError with the name of
// the file and what to do for damaged files and for kinds that are not read.

/// 1, 4, 8, 24 or 32 bits without compression.
Image decode_bmp(std::span<const std::uint8_t> bytes, const std::string& name);

/// Grey, palette or colour of 8, 24 or 32 bits, plain or run-length encoded.
Image decode_tga(std::span<const std::uint8_t> bytes, const std::string& name);

/// A portable float map (Pf or PF, little-endian) of an image of one or three channels, whose
/// values are stored as they are. The file is there completely or not at all (atomic_file.h).
void write_portable_float_map(const std::filesystem::path& path, const Image& image);

/// The binary ones: P5 and P6 of 8 or 16 bits, Pf and PF of either byte order.
Image decode_portable_map(std::span<const std::uint8_t> bytes, const std::string& name);

}  // namespace lucerna
