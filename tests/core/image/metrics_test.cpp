// SPDX-License-Identifier: Apache-2.0
#include "core/image/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/base/error.h"
#include "core/image/color.h"

namespace lucerna {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();

Image constant(int width, int height, Color color) {
    Image image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) image.set_rgb(x, y, color);
    }
    return image;
}

/// A picture with values over four decades, and a noisy copy.
std::pair<Image, Image> noisy_pair(int width, int height, float scale = 1) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> uniform(0, 1);
    Image reference(width, height), image(width, height);
    for (std::size_t i = 0; i < reference.pixels.size(); ++i) {
        const float r = std::exp(9 * uniform(random) - 6);
        const float noise = uniform(random) - 0.5f;
        reference.pixels[i] = scale * r;
        image.pixels[i] = scale * (r + r * noise);
    }
    return {image, reference};
}

TEST(Metrics, FormulasByHand) {
    Image reference(2, 1), image(2, 1);
    reference.pixels = {1, 2, 3, 0, 0, 6};  // mean 2, epsilon 0.04
    image.pixels = {2, 2, 3, 0, 1, 4};
    const Comparison c = compare_images(image, reference);
    EXPECT_DOUBLE_EQ(c.reference_mean, 2);
    EXPECT_DOUBLE_EQ(c.epsilon, 0.04);
    EXPECT_NEAR(c.finite.mse, (1 + 1 + 4) / 6.0, 1e-12);
    EXPECT_NEAR(c.finite.rmse, 1, 1e-12);
    EXPECT_NEAR(c.finite.relmse, (1 / 1.04 + 1 / 0.04 + 4 / 36.04) / 6, 1e-12);
    // On the display (2 -> 1, 2 -> 1): only one channel differs, 0 against 1.
    EXPECT_NEAR(c.finite.psnr, -10 * std::log10(1 / 6.0), 1e-4);
    EXPECT_EQ(c.all.mse, c.finite.mse);
    EXPECT_EQ(c.pixels, 2u);
}

TEST(Metrics, EqualImagesHaveNoError) {
    const Image image = noisy_pair(20, 10).first;
    const Comparison c = compare_images(image, image);
    EXPECT_EQ(c.finite.mse, 0);
    EXPECT_EQ(c.finite.relmse, 0);
    EXPECT_EQ(c.finite.trimmed_share, 0);
    EXPECT_EQ(c.finite.psnr, HUGE_VAL);
    // Black on black is equal too, not 0/0.
    const Image black = constant(4, 4, Color(0));
    EXPECT_EQ(compare_images(black, black).finite.relmse, 0);
    EXPECT_EQ(compare_images(constant(4, 4, Color(1)), black).finite.relmse, HUGE_VAL);
}

TEST(Metrics, RelativeErrorDoesNotDependOnExposure) {
    const auto [image, reference] = noisy_pair(50, 40);
    const auto [brighter, bright_reference] = noisy_pair(50, 40, 1024);
    const Comparison a = compare_images(image, reference);
    const Comparison b = compare_images(brighter, bright_reference);
    EXPECT_GT(a.finite.relmse, 0.01);
    EXPECT_NEAR(b.finite.relmse / a.finite.relmse, 1, 1e-6);
    EXPECT_NEAR(b.finite.mse / a.finite.mse, 1024.0 * 1024.0, 1e-6 * 1024 * 1024);
}

TEST(Metrics, ANonFinitePixelNeverImprovesAnything) {
    const auto [image, reference] = noisy_pair(40, 30);
    const Comparison clean = compare_images(image, reference);
    for (const float bad : {nan_value, inf, -inf}) {
        Image broken = image;
        broken.set_rgb(7, 3, {1, bad, 1});
        const Comparison c = compare_images(broken, reference);
        EXPECT_EQ(c.non_finite, 1u);
        EXPECT_EQ(c.non_finite_reference, 0u);
        EXPECT_EQ(c.all.mse, HUGE_VAL);
        EXPECT_EQ(c.all.rmse, HUGE_VAL);
        EXPECT_EQ(c.all.relmse, HUGE_VAL);
        EXPECT_EQ(c.all.trimmed_relmse, HUGE_VAL);
        EXPECT_EQ(c.all.psnr, -HUGE_VAL);
        // The mean is over 1199 pixels: dividing by all 1200 would be a better score.
        const Vector3d d = Vector3d(image.rgb(7, 3)) - Vector3d(reference.rgb(7, 3));
        const double others = clean.finite.mse * 1200 - glm::dot(d, d) / 3;
        EXPECT_NEAR(c.finite.mse, others / 1199, 1e-12 * clean.finite.mse);
    }
    Image broken_reference = reference;
    broken_reference.set_rgb(0, 0, Color(nan_value));
    const Comparison c = compare_images(image, broken_reference);
    EXPECT_EQ(c.non_finite_reference, 1u);
    EXPECT_TRUE(std::isfinite(c.finite.relmse));
    EXPECT_EQ(c.all.relmse, HUGE_VAL);
}

TEST(Metrics, NothingFiniteIsInfinitelyWrong) {
    const Image broken = constant(3, 3, Color(nan_value));
    const Comparison c = compare_images(broken, constant(3, 3, Color(1)));
    EXPECT_EQ(c.non_finite, 9u);
    EXPECT_EQ(c.finite.mse, HUGE_VAL);
    EXPECT_EQ(c.finite.relmse, HUGE_VAL);
    EXPECT_EQ(c.finite.psnr, -HUGE_VAL);
}

TEST(Metrics, TrimmingTellsWhatItHides) {
    const Image reference = constant(100, 50, Color(1));
    Image image = constant(100, 50, Color(1.1f));
    for (int x = 0; x < 5; ++x) image.set_rgb(x, 7, Color(1000));  // 5 of 5000: the worst 0.1 %
    const Comparison c = compare_images(image, reference);
    EXPECT_EQ(c.trimmed_pixels, 5u);
    EXPECT_NEAR(c.finite.trimmed_relmse, 0.01 / 1.01, 1e-6);
    EXPECT_GT(c.finite.relmse, 900);
    EXPECT_GT(c.finite.trimmed_share, 0.9999);
    // A sixth firefly is not hidden.
    image.set_rgb(50, 7, Color(1000));
    EXPECT_GT(compare_images(image, reference).finite.trimmed_relmse, 100);
    // Below a thousand pixels nothing is dropped.
    const Comparison small = compare_images(constant(10, 10, Color(2)), constant(10, 10, Color(1)));
    EXPECT_EQ(small.trimmed_pixels, 0u);
    EXPECT_EQ(small.finite.trimmed_relmse, small.finite.relmse);
}

TEST(Metrics, MseIsBiasSquaredPlusVariance) {
    const Image reference = constant(200, 100, Color(1));
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0.5, 0.25);
    Image image(200, 100);
    for (float& v : image.pixels) v = static_cast<float>(1 + noise(random));
    EXPECT_NEAR(compare_images(image, reference).finite.mse, 0.25 + 0.0625, 0.005);
}

TEST(Metrics, SizesMustAgree) {
    EXPECT_THROW(compare_images(Image(2, 3), Image(3, 2)), Error);
    EXPECT_THROW(error_image(Image(2, 3), Image(3, 2), 1), Error);
}

TEST(ErrorImage, AveragesToRelmse) {
    const auto [image, reference] = noisy_pair(30, 20);
    const Comparison c = compare_images(image, reference);
    const Image map = error_image(image, reference, c.epsilon);
    double sum = 0;
    for (const float v : map.pixels) sum += double{v};
    EXPECT_NEAR(sum / 600, c.finite.relmse, 1e-6 * c.finite.relmse);
    Image broken = image;
    broken.set_rgb(3, 4, Color(nan_value));
    EXPECT_EQ(error_image(broken, reference, c.epsilon).rgb(3, 4).x, inf);
}

TEST(FalseColour, RunsFromBlackToPaleYellow) {
    Image map(4, 1, {"Y"});
    map.pixels = {0, 0.5f, 1, inf};
    const Image8 painted = false_color(map, 1);
    EXPECT_LT(painted.pixels[0] + painted.pixels[1] + painted.pixels[2], 12);
    EXPECT_NEAR(painted.pixels[3], 183, 8);  // magma(0.5) is (0.716, 0.215, 0.475)
    EXPECT_NEAR(painted.pixels[4], 55, 8);
    EXPECT_NEAR(painted.pixels[5], 121, 8);
    EXPECT_GT(painted.pixels[6], 240);
    EXPECT_GT(painted.pixels[7], 240);
    EXPECT_NEAR(painted.pixels[8], 191, 12);
    EXPECT_EQ(painted.pixels[9] + painted.pixels[10] + painted.pixels[11], 3 * 255);
    EXPECT_EQ(painted.non_finite, 1u);
}

}  // namespace
}  // namespace lucerna
