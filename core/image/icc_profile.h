// SPDX-License-Identifier: Apache-2.0
/// Colour profiles in pictures: those of primaries and curves (ICC.1:2022, 8.3.3) are followed.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/image/image.h"

namespace lucerna {

/// Sets what the profile says of the values of the picture: the primaries, unless they are those of
/// sRGB, and the curve, if it is that of sRGB or a power and the same for all channels. Returns
/// what to tell of a picture that is taken as sRGB in spite of its profile; else nothing.
std::string follow_icc_profile(std::span<const std::uint8_t> profile, Image& image);

}  // namespace lucerna
