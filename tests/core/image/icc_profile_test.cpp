// SPDX-License-Identifier: Apache-2.0
#include "core/image/icc_profile.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string_view>
#include <vector>

namespace lucerna {
namespace {

using Bytes = std::vector<std::uint8_t>;

void append(Bytes& bytes, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) {
        bytes.push_back(static_cast<std::uint8_t>(value >> shift));
    }
}
void append(Bytes& bytes, std::string_view four) {
    bytes.insert(bytes.end(), four.begin(), four.end());
}

/// A header, three tags, and their values: the primaries in XYZ under D50.
Bytes profile(std::string_view space, const std::array<std::array<double, 3>, 3>& primaries) {
    Bytes bytes(16);
    append(bytes, space);
    bytes.resize(128);
    append(bytes, 3);
    constexpr std::array<std::string_view, 3> names{"rXYZ", "gXYZ", "bXYZ"};
    for (std::uint32_t i = 0; i < 3; ++i) {
        append(bytes, names[i]);
        append(bytes, 132 + 3 * 12 + i * 20);
        append(bytes, 20);
    }
    for (const auto& xyz : primaries) {
        append(bytes, "XYZ ");
        append(bytes, 0);
        for (const double x : xyz)
            append(bytes, static_cast<std::uint32_t>(std::lround(x * 65536)));
    }
    return bytes;
}

const Bytes srgb = profile(
    "RGB ",
    {{{0.43607, 0.22249, 0.01392}, {0.38515, 0.71687, 0.09708}, {0.14307, 0.06061, 0.7141}}});
const Bytes adobe = profile(
    "RGB ",
    {{{0.60974, 0.31111, 0.01947}, {0.20528, 0.62567, 0.06087}, {0.14919, 0.06322, 0.74457}}});

TEST(IccProfile, OnlyOtherPrimariesThanThoseOfSrgbAreTold) {
    EXPECT_EQ(icc_notice(srgb), "");
    EXPECT_NE(icc_notice(adobe).find("convert it to sRGB"), std::string::npos);
    EXPECT_EQ(icc_notice(profile("GRAY", {})), "");
}

TEST(IccProfile, ShortenedOnesAreOtherOnes) {
    for (std::size_t size = 0; size < srgb.size(); ++size) {
        const Bytes shortened(srgb.begin(), srgb.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_NE(icc_notice(shortened), "") << size;
    }
    Bytes endless = srgb;
    endless[128] = endless[129] = 0xff;  // billions of tags
    EXPECT_EQ(icc_notice(endless), "");
}

}  // namespace
}  // namespace lucerna
