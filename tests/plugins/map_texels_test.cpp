// SPDX-License-Identifier: Apache-2.0
/// Colours of environment maps are kept exactly, in 16 bits or in 32.
#include "plugins/emitters/map_texels.h"

#include "core/base/parallel.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

/// Whether each texel is read as it was given, by a thread that renders.
void expect_exact(const std::vector<Color>& colors, int width) {
    const MapTexels texels(colors, width);
    Workers(1).run(1, [&](std::int64_t) {
        for (std::size_t i = 0; i < colors.size(); ++i) {
            const auto column = static_cast<int>(i) % width, row = static_cast<int>(i) / width;
            EXPECT_EQ(to_vector3(texels(column, row)), colors[i]) << i;
        }
    });
}

TEST(MapTexels, AllHalvesAreExact) {
    std::vector<Color> colors;
    for (int i = 0; i < 0x7c00; ++i) {  // all that are finite and not negative
        const int exponent = i >> 10, mantissa = i & 1023;
        const float value = exponent == 0
                                ? std::ldexp(static_cast<float>(mantissa), -24)
                                : std::ldexp(static_cast<float>(1024 + mantissa), exponent - 25);
        colors.emplace_back(value, 0.0f, 1.0f);
    }
    expect_exact(colors, 31);  // 31,744 = 31 · 1024
}

TEST(MapTexels, NumbersThatHalvesCannotHoldAreExact) {
    for (const float one : {1 / 3.0f, 1e-7f, 65520.0f, 1e9f, 0x1p-25f}) {
        std::vector<Color> colors(7 * 5, Color(0.5f));
        colors[17].y = one;
        expect_exact(colors, 7);
    }
}

}  // namespace
}  // namespace lucerna
