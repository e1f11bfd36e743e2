// SPDX-License-Identifier: Apache-2.0
/// OpenEXR files: flat images with named channels (half, float, unsigned) and metadata.
/// exr.cpp is the only user of OpenEXR.
///
/// Metadata are string, int, float and double attributes; floats come back as double. Attributes
/// that describe the file itself ("compression", "dataWindow") are not metadata.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/image/image.h"

namespace lucerna {

/// Lossless both. `zip` shrinks clean data and floats best; `piz` is faster on noisy halves.
enum class ExrCompression { zip, piz };

/// Reads all channels of a flat, scanline or tiled file: of the largest picture, if it has mipmaps;
/// of the first part, if there are several, which a notice tells. Halves become floats; unsigned
/// channels stay. Luminance and chroma (Y, RY, BY) become R, G and B. Throws FileError with the
/// name of the file and what to do, for damaged files, deep data and other subsampled channels.
ImageFile read_exr(const std::filesystem::path& path);

/// The same from memory; `name` is what errors call it.
ImageFile decode_exr(std::span<const std::uint8_t> bytes, const std::string& name);

/// All but the pixels: no planes.
ImageFile decode_exr_header(std::span<const std::uint8_t> bytes, const std::string& name);

/// Writes `file` so that it is there completely or not at all (atomic_file.h), with ZIP unless
/// said otherwise and Rec.709 chromaticities unless `file` has its own. Finite values beyond ±65504
/// in planes marked half are written as ±65504; returns how many there were. Throws Error for
/// planes and metadata that no file can hold, FileError if writing fails.
std::size_t write_exr(const std::filesystem::path& path, const ImageFile& file,
                      ExrCompression compression = ExrCompression::zip);

/// The same into memory. `clamped`, if given, receives the number of values that were clamped.
std::string encode_exr(const ImageFile& file, ExrCompression compression = ExrCompression::zip,
                       std::size_t* clamped = nullptr);

}  // namespace lucerna
