// SPDX-License-Identifier: Apache-2.0
/// Pictures as text in a page: halves in base 64.
#pragma once

#include "core/image/image.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace lucerna {

/// IEEE 754 half precision, to nearest, ties to even; beyond ±65504 the largest half, since the
/// pictures are finite and should stay so.
std::uint16_t half_bits(float value);

std::string base64(std::string_view bytes);

/// Red, green and blue of all pixels as halves, low byte first.
std::string encoded_picture(const Image& image);

}  // namespace lucerna
