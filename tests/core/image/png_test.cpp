// SPDX-License-Identifier: Apache-2.0
#include "core/image/png.h"

#include <gtest/gtest.h>

#include "tests/core/image/damage.h"
#include "tests/paths.h"

namespace lucerna {
namespace {

Image decode(const Bytes& bytes) { return decode_png(bytes, "damaged.img"); }

Image8 pattern(int width, int height, int channel_count) {
    Image8 image{.width = width, .height = height, .channel_count = channel_count};
    const int count = width * height * channel_count;
    for (int i = 0; i < count; ++i) image.pixels.push_back(static_cast<std::uint8_t>(i * 37 + 11));
    return image;
}

TEST(Png, EveryByteComesBack) {
    for (const int channel_count : {3, 4}) {
        const Image8 written = pattern(17, 9, channel_count);
        const std::string bytes = encode_png(written);
        EXPECT_NE(bytes.find("sRGB"), std::string::npos);
        const Image read = decode(bytes_of(bytes));
        ASSERT_EQ(read.width, 17);
        ASSERT_EQ(read.height, 9);
        ASSERT_EQ(read.channel_count(), static_cast<std::size_t>(channel_count));
        EXPECT_TRUE(read.srgb_encoded);
        for (std::size_t i = 0; i < written.pixels.size(); ++i) {
            ASSERT_EQ(read.pixels[i], static_cast<float>(written.pixels[i]) / 255.0f) << i;
        }
    }
}

TEST(Png, FileIsWrittenAndRead) {
    const TemporaryFolder folder;
    write_png(folder / "a.png", pattern(3, 2, 3));
    EXPECT_EQ(read_png(folder / "a.png").at(2, 1)[2],
              static_cast<float>((17 * 37 + 11) & 255) / 255);
}

TEST(Png, SixteenBitsAreKept) {
    const Image image = decode(from_hex(
        "89504e470d0a1a0a0000000d494844520000000200000001100000000081d9fc150000000d49444154789c"
        "636064faff1f00030c02021b01adb70000000049454e44ae426082"));
    EXPECT_EQ(image.channels, std::vector<std::string>{"Y"});
    EXPECT_EQ(image.pixels, (std::vector<float>{258.0f / 65535.0f, 1.0f}));
}

TEST(Png, P3_PaletteAndTransparencyAreLookedUp) {
    const Image image = decode(from_hex(
        "89504e470d0a1a0a0000000d494844520000000200000002010300000048789f6700000006504c5445ff00"
        "000080400cfccbd80000000274524e53ff335a67515c0000000c49444154789c637060680000014400c1"
        "3a7a1c560000000049454e44ae426082"));
    ASSERT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B", "A"}));
    EXPECT_EQ(image.rgb(0, 0), Color(1, 0, 0));
    EXPECT_EQ(image.rgb(1, 0), Color(0, 128 / 255.0f, 64 / 255.0f));
    EXPECT_EQ(image.at(1, 0)[3], 51 / 255.0f);
    EXPECT_EQ(image.rgb(1, 1), Color(1, 0, 0));
}

TEST(Png, InterlacedRowsAreSorted) {
    const Image image = decode(from_hex(
        "89504e470d0a1a0a0000000d4948445200000002000000010800000001a64e10c00000000c49444154789c"
        "633066f80f00019c0133f52b14c60000000049454e44ae426082"));
    EXPECT_EQ(image.pixels, (std::vector<float>{0.2f, 1}));
}

/// A picture of one pixel, grey 128, with other chunks before the pixels.
Image grey_with(const std::string& chunks) {
    return decode(from_hex("89504e470d0a1a0a0000000d49484452000000010000000108000000003a7e9b55" +
                           chunks +
                           "0000000a4944415478da6368000000820081da45083b0000000049454e44ae426082"));
}

TEST(Png, P3_GammaSaysHowValuesAreEncoded) {
    const std::string srgb = "000000017352474200aece1ce9",
                      linear = "0000000467414d41000186a031e8965f";
    EXPECT_FALSE(grey_with(linear).srgb_encoded);
    EXPECT_EQ(grey_with(linear).gamma, 1);
    EXPECT_EQ(grey_with(linear).pixels.at(0), 128.0f / 255);
    EXPECT_TRUE(grey_with("").srgb_encoded);
    EXPECT_TRUE(grey_with(srgb + linear).srgb_encoded);
    // 0.45455 stands for sRGB; 0.55556 is a power.
    EXPECT_TRUE(grey_with("0000000467414d410000b18f0bfc6105").srgb_encoded);
    const Image mac = grey_with("0000000467414d410000d904dcb2da02");
    EXPECT_FALSE(mac.srgb_encoded);
    EXPECT_NEAR(mac.gamma, 1.8f, 1e-4f);
}

TEST(Png, PrimariesAreRead) {
    const Image image = decode(from_hex(
        "89504e470d0a1a0a0000000d4948445200000001000000010802000000907753de0000000467414d41000186"
        "a031e8965f000000206348524d00007a2600008084000109a000007d000000678400010d8800003a98000017"
        "70f1f8ca570000000c4944415478da63f8cfc0000003010100f70341430000000049454e44ae426082"));
    ASSERT_TRUE(image.chromaticities);
    const Chromaticities p3{{0.68, 0.32}, {0.265, 0.69}, {0.15, 0.06}, {0.3127, 0.3290}};
    EXPECT_EQ(*image.chromaticities, p3);
    EXPECT_EQ(image.rgb(0, 0), Color(1, 0, 0));
}

TEST(Png, AProfileOfOtherPrimariesIsTold) {
    // One pixel (255, 128, 0) with a profile of Adobe RGB.
    const Image image = decode(from_hex(
        "89504e470d0a1a0a0000000d4948445200000001000000010802000000907753de00000079694343504164"
        "6f626520524742000078da6360607892979f97cac4c0c0909b575214e4eea4101119a5c0800412938b0b18"
        "f0826fd7181841f4655d06d2017311d04220bd028845d221ec3d207612847d01c446b8698e040383ff5206"
        "06963f0831935e0686053a0c0cfc5311626a860c0c02fa0c0cfbe60000c83d1c0b0cc944770000000c4944"
        "415478da63f8dfc0000004010180fbd7cbf10000000049454e44ae426082"));
    EXPECT_NE(image.notice.find("ICC profile"), std::string::npos);
    EXPECT_TRUE(image.srgb_encoded);
    EXPECT_EQ(image.rgb(0, 0), Color(1, 128.0f / 255, 0));
}

TEST(Png, RefusesEveryShortenedFile) {
    const Bytes file = bytes_of(encode_png(pattern(5, 4, 3)));
    expect_prefixes_refused(file, [](const Bytes& b) { decode(b); });
}

TEST(Png, SurvivesDamage) {
    const Bytes file = bytes_of(encode_png(pattern(8, 8, 4)));
    // Checksums see nearly everything; what is left are changes after the pixels.
    EXPECT_GT(count_refused_mutants(file, [](const Bytes& b) { decode(b); }), 150);
}

TEST(Png, RefusesSizesThatTheFileCannotHold) {
    const Bytes huge = from_hex(
        "89504e470d0a1a0a0000000d494844520000ea600000ea60080600000080d275420000000c494441547"
        "89c6360a03d00000064000186643c350000000049454e44ae426082");
    EXPECT_NE(file_error([&] { decode(huge); }).find("60000 x 60000"), std::string::npos);
    const Bytes beyond = from_hex(
        "89504e470d0a1a0a0000000d49484452000186a0000000010800000000781549090000000c494441547"
        "89c6360a03d00000064000186643c350000000049454e44ae426082");
    const std::string message = file_error([&] { decode(beyond); });
    EXPECT_NE(message.find("limit"), std::string::npos) << message;
}

TEST(Png, RefusesToWriteNonsense) {
    EXPECT_THROW(encode_png(Image8{}), Error);
    Image8 short_of_a_byte = pattern(2, 2, 3);
    short_of_a_byte.pixels.pop_back();
    EXPECT_THROW(encode_png(short_of_a_byte), Error);
    EXPECT_THROW(encode_png(pattern(2, 2, 2)), Error);
}

}  // namespace
}  // namespace lucerna
