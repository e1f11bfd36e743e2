// SPDX-License-Identifier: Apache-2.0
/// Pictures in memory are exact, in 16 bits or in 32.
#include "core/image/texels.h"

#include "core/base/parallel.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

/// Each texel is read as it was given, by a thread that renders.
void expect_exact(const Image& image, std::size_t bits) {
    const Texels texels(image, true);
    EXPECT_EQ(texels.bits(), bits);
    Workers(1).run(1, [&](std::int64_t) {
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                EXPECT_EQ(texels(x, y), image.rgb(x, y)) << x << ", " << y;
            }
        }
    });
}

TEST(Texels, AllHalvesAreExact) {
    for (const bool grey : {false, true}) {
        Image image(31, 1024,
                    grey ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"});
        for (int i = 0; i < 31 * 1024; ++i) {  // all that are finite and not negative
            const int exponent = i >> 10, mantissa = i & 1023;
            const float value =
                exponent == 0 ? std::ldexp(static_cast<float>(mantissa), -24)
                              : std::ldexp(static_cast<float>(1024 + mantissa), exponent - 25);
            float* const pixel = image.at(i % 31, i / 31);
            pixel[0] = value;
            if (!grey) pixel[1] = 0, pixel[2] = 65504 - std::floor(value / 32) * 32;
        }
        expect_exact(image, 16);
    }
}

TEST(Texels, NumbersThatHalvesCannotHoldAreExact) {
    for (const float one : {1 / 3.0f, 1e-7f, 65520.0f, 1e9f, 0x1p-25f, -0.5f}) {
        Image image(7, 5);
        std::fill(image.pixels.begin(), image.pixels.end(), 0.5f);
        image.at(3, 2)[1] = one;
        expect_exact(image, 32);
    }
}

}  // namespace
}  // namespace lucerna
