// SPDX-License-Identifier: Apache-2.0
/// What an ICC profile in a picture says, as far as it must be told: profiles are not applied.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace lucerna {

/// What to tell of a picture that is taken as sRGB in spite of this profile; empty if the profile
/// is one of grey, or has the primaries of sRGB (ICC.1:2022, 9.2: rXYZ, gXYZ, bXYZ).
std::string icc_notice(std::span<const std::uint8_t> profile);

}  // namespace lucerna
