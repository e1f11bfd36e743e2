// SPDX-License-Identifier: Apache-2.0
#include "core/image/flip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "core/base/error.h"

namespace lucerna {
namespace {

Image constant(int width, int height, Color color) {
    Image image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) image.set_rgb(x, y, color);
    }
    return image;
}

/// A checkerboard with ramps, and a copy with noise from an integer formula.
std::pair<Image, Image> pictures() {
    constexpr int width = 20, height = 14;
    Image reference(width, height), image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const bool odd = (x / 5 + y / 5) % 2 != 0;
            const Color base(static_cast<float>(x) / width * 0.5f + 0.25f, odd ? 0.5f : 0.125f,
                             static_cast<float>(y) / 16);
            Color noise;
            for (int c = 0; c < 3; ++c) {
                noise[c] = static_cast<float>((x * 73 + y * 151 + c * 199 + 93) % 257) / 256;
            }
            reference.set_rgb(x, y, base);
            image.set_rgb(x, y, 0.75f * base + 0.25f * noise);
        }
    }
    return {image, reference};
}

TEST(Flip, AgreesWithADirectEvaluationOfThePaper) {
    // Computed apart from this code: two-dimensional kernels in full, double precision, Python.
    const auto [image, reference] = pictures();
    const Flip standard = flip(image, reference);
    EXPECT_NEAR(standard.mean, 0.3099210589, 2e-5);
    EXPECT_NEAR(standard.map.rgb(0, 0).x, 0.4970972829, 1e-4);
    EXPECT_NEAR(standard.map.rgb(9, 7).x, 0.3090197190, 1e-4);
    EXPECT_NEAR(standard.map.rgb(19, 13).x, 0.2259980478, 1e-4);
    const Flip near = flip(image, reference, 20);
    EXPECT_NEAR(near.mean, 0.4061852445, 2e-5);
    EXPECT_NEAR(near.map.rgb(9, 7).x, 0.6405874430, 1e-4);
}

TEST(Flip, EndsOfTheScale) {
    const Image green = constant(8, 8, {0, 1, 0}), blue = constant(8, 8, {0, 0, 1});
    EXPECT_NEAR(flip(green, blue).mean, 1, 1e-5);  // the largest difference, by construction
    const Image black = constant(8, 8, Color(0)), white = constant(8, 8, Color(1));
    EXPECT_NEAR(flip(white, black).mean, 0.96738, 1e-5);
    EXPECT_EQ(flip(green, green).mean, 0);
    const auto [image, reference] = pictures();
    EXPECT_EQ(flip(image, image).mean, 0);
}

TEST(Flip, IsSymmetric) {
    const auto [image, reference] = pictures();
    EXPECT_DOUBLE_EQ(flip(image, reference).mean, flip(reference, image).mean);
}

TEST(Flip, TheEyeForgivesFineNoiseFromAfar) {
    Image fine(64, 64), coarse(64, 64);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            fine.set_rgb(x, y, Color((x + y) % 2 ? 0.15f : 0.25f));
            coarse.set_rgb(x, y, Color((x / 16 + y / 16) % 2 ? 0.15f : 0.25f));
        }
    }
    const Image grey = constant(64, 64, Color(0.2f));
    EXPECT_LT(flip(fine, grey).mean, 0.5 * flip(coarse, grey).mean);
    EXPECT_LT(flip(fine, grey, 200).mean, 0.5 * flip(fine, grey, 10).mean);
}

TEST(Flip, ExposureIsAppliedBeforeTheDisplayClips) {
    const Image dark = constant(4, 4, Color(0.01f)), black = constant(4, 4, Color(0));
    EXPECT_LT(flip(dark, black).mean, flip(dark, black, flip_pixels_per_degree, 4).mean);
    EXPECT_EQ(flip(constant(4, 4, Color(5)), constant(4, 4, Color(1))).mean, 0);
    EXPECT_GT(flip(constant(4, 4, Color(5)), constant(4, 4, Color(1)), 67, -4).mean, 0.1);
}

TEST(Flip, NonFinitePixelsCountInFull) {
    const Image grey = constant(10, 10, Color(0.5f));
    Image broken = grey;
    broken.set_rgb(5, 5, Color(std::numeric_limits<float>::quiet_NaN()));
    broken.set_rgb(2, 5, Color(std::numeric_limits<float>::infinity()));
    const Flip result = flip(broken, grey);
    EXPECT_EQ(result.non_finite, 2u);
    EXPECT_EQ(result.map.rgb(5, 5).x, 1);
    EXPECT_EQ(result.map.rgb(2, 5).x, 1);
    EXPECT_TRUE(std::isfinite(result.mean));
    EXPECT_NEAR(result.mean_all, (result.mean * 98 + 2) / 100, 1e-12);
    for (const float v : result.map.pixels) EXPECT_TRUE(v >= 0 && v <= 1);
}

TEST(Flip, RefusesNonsense) {
    EXPECT_THROW(flip(Image(2, 3), Image(3, 2)), Error);
    EXPECT_THROW(flip(Image(2, 2), Image(2, 2), 0), Error);
    EXPECT_THROW(flip(Image(2, 2), Image(2, 2), std::nan("")), Error);
}

}  // namespace
}  // namespace lucerna
