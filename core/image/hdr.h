// SPDX-License-Identifier: Apache-2.0
/// Radiance RGBE pictures (.hdr), as many environment maps are.
/// G. Ward, "Real Pixels", Graphics Gems II, 1991; Radiance's "filefmts".
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/image/image.h"

namespace lucerna {

/// Reads flat, old and new run-length encoded pictures in any of the four orientations that keep
/// rows horizontal. The values are mantissa · 2^(exponent − 136), linear, in the PRIMARIES of the
/// file; EXPOSURE is not divided out, as in other renderers, which a notice tells. Throws FileError
/// with the name of the file and what to do for damaged files, XYZE and other orientations.
Image read_hdr(const std::filesystem::path& path);

/// The same from memory; `name` is what errors call it.
Image decode_hdr(std::span<const std::uint8_t> bytes, const std::string& name);

}  // namespace lucerna
