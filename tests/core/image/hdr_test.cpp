// SPDX-License-Identifier: Apache-2.0
#include "core/image/hdr.h"

#include <gtest/gtest.h>

#include "tests/core/image/damage.h"

namespace lucerna {
namespace {

Image decode(const Bytes& bytes) { return decode_hdr(bytes, "damaged.img"); }

Bytes with_header(const std::string& size, const Bytes& pixels) {
    Bytes file = bytes_of("#?RADIANCE\n# a comment\nFORMAT=32-bit_rle_rgbe\n\n" + size + "\n");
    file.insert(file.end(), pixels.begin(), pixels.end());
    return file;
}

// 2^(129 - 136) = 1/128.
const Bytes flat_pixels{128, 64, 0, 129, 1, 2, 3, 136, 255, 255, 255, 0, 10, 20, 30, 135};

TEST(Hdr, FlatPixels) {
    const Image image = decode(with_header("-Y 2 +X 2", flat_pixels));
    EXPECT_FALSE(image.srgb_encoded);
    EXPECT_EQ(image.rgb(0, 0), Color(1, 0.5f, 0));
    EXPECT_EQ(image.rgb(1, 0), Color(1, 2, 3));
    EXPECT_EQ(image.rgb(0, 1), Color(0));  // exponent 0 is black, whatever the mantissas
    EXPECT_EQ(image.rgb(1, 1), Color(5, 10, 15));
}

TEST(Hdr, Orientations) {
    EXPECT_EQ(decode(with_header("+Y 2 +X 2", flat_pixels)).rgb(0, 1), Color(1, 0.5f, 0));
    EXPECT_EQ(decode(with_header("-Y 2 -X 2", flat_pixels)).rgb(1, 0), Color(1, 0.5f, 0));
    EXPECT_EQ(decode(with_header("+Y 2 -X 2", flat_pixels)).rgb(1, 1), Color(1, 0.5f, 0));
    const std::string turned = file_error([] { decode(with_header("+X 2 -Y 2", flat_pixels)); });
    EXPECT_NE(turned.find("columns"), std::string::npos) << turned;
}

TEST(Hdr, HeadersAreFollowedOrTold) {
    const auto with = [](const std::string& lines) {
        Bytes file = bytes_of("#?RADIANCE\n" + lines + "FORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n");
        file.insert(file.end(), flat_pixels.begin(), flat_pixels.end());
        return file;
    };
    EXPECT_EQ(decode(with("")).notice, "");
    EXPECT_FALSE(decode(with("")).chromaticities);
    const Image image =
        decode(with("EXPOSURE=2\nEXPOSURE= 0.25\n"
                    "PRIMARIES=0.68 0.32 0.265 0.69 0.15 0.06 0.3127 0.3290\n"));
    EXPECT_EQ(image.rgb(0, 0), Color(1, 0.5f, 0));
    EXPECT_NE(image.notice.find("EXPOSURE of 0.5"), std::string::npos) << image.notice;
    const Chromaticities p3{{0.68, 0.32}, {0.265, 0.69}, {0.15, 0.06}, {0.3127, 0.3290}};
    ASSERT_TRUE(image.chromaticities);
    EXPECT_EQ(*image.chromaticities, p3);
    EXPECT_EQ(decode(with("EXPOSURE=2\nEXPOSURE=0.5\n")).notice, "");
    EXPECT_NE(file_error([&] { decode(with("PRIMARIES=0.6 0.3\n")); }).find("8 numbers"),
              std::string::npos);
}

TEST(Hdr, OldRuns) {
    // A pixel, 2 repeats; then a run of 1 + 1 · 256 repeats in the next row.
    Bytes pixels{1, 2, 3, 136, 1, 1, 1, 2};
    pixels.resize(8 + 4 * 255, 7);  // 255 pixels of (7, 7, 7, 7)
    const Bytes second{9, 9, 9, 136, 1, 1, 1, 1, 1, 1, 1, 1};
    pixels.insert(pixels.end(), second.begin(), second.end());
    const Image image = decode(with_header("-Y 2 +X 258", pixels));
    EXPECT_EQ(image.rgb(2, 0), Color(1, 2, 3));
    EXPECT_LT(image.rgb(3, 0).x, 1e-30f);
    EXPECT_EQ(image.rgb(0, 1), Color(9));
    EXPECT_EQ(image.rgb(257, 1), Color(9));
}

Bytes new_runs() {
    Bytes pixels{2, 2, 0, 10};
    const Bytes red{128 + 10, 5}, green{3, 1, 2, 3, 128 + 7, 9},
        blue{10, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
    const Bytes exponent{128 + 10, 136};
    for (const Bytes& part : {red, green, blue, exponent}) {
        pixels.insert(pixels.end(), part.begin(), part.end());
    }
    return with_header("-Y 1 +X 10", pixels);
}

TEST(Hdr, NewRuns) {
    const Image image = decode(new_runs());
    EXPECT_EQ(image.rgb(0, 0), Color(5, 1, 0));
    EXPECT_EQ(image.rgb(2, 0), Color(5, 3, 2));
    EXPECT_EQ(image.rgb(9, 0), Color(5, 9, 9));
}

TEST(Hdr, RefusesEveryShortenedFile) {
    expect_prefixes_refused(new_runs(), [](const Bytes& b) { decode(b); });
    expect_prefixes_refused(with_header("-Y 2 +X 2", flat_pixels),
                            [](const Bytes& b) { decode(b); });
}

TEST(Hdr, SurvivesDamage) {
    const int refused = count_refused_mutants(new_runs(), [](const Bytes& b) { decode(b); });
    EXPECT_GT(refused, 50);
    EXPECT_LT(refused, 200);
}

TEST(Hdr, RefusesWhatItCannotMean) {
    const auto message = [](const Bytes& file) { return file_error([&] { decode(file); }); };
    EXPECT_NE(message(with_header("-Y 65000 +X 65000", flat_pixels)).find("65000 x 65000"),
              std::string::npos);
    EXPECT_NE(message(with_header("-Y 99999999999 +X 2", flat_pixels)).find("no number"),
              std::string::npos);
    EXPECT_NE(message(with_header("-Y 0 +X 2", flat_pixels)).find("0 pixels"), std::string::npos);
    EXPECT_NE(message(with_header("-Y 2", flat_pixels)).find("size"), std::string::npos);
    EXPECT_NE(message(bytes_of("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n")).find("XYZ"),
              std::string::npos);
    // A run that repeats the pixel before the first one.
    EXPECT_NE(message(with_header("-Y 1 +X 2", {1, 1, 1, 2, 1, 1, 1, 2})).find("run"),
              std::string::npos);
}

}  // namespace
}  // namespace lucerna
