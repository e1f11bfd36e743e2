// SPDX-License-Identifier: Apache-2.0
#include "core/image/plain_formats.h"

#include <gtest/gtest.h>

#include <bit>

#include "core/base/file_bytes.h"
#include "tests/core/image/damage.h"
#include "tests/paths.h"

namespace lucerna {
namespace {

Image bmp(const Bytes& bytes) { return decode_bmp(bytes, "damaged.img"); }
Image tga(const Bytes& bytes) { return decode_tga(bytes, "damaged.img"); }
Image map(const Bytes& bytes) { return decode_portable_map(bytes, "damaged.img"); }

void append(Bytes& bytes, std::uint32_t value, int size) {
    for (int i = 0; i < size; ++i, value >>= 8) bytes.push_back(value & 0xff);
}
Bytes operator+(Bytes a, const Bytes& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/// `palette` and `rows` follow the header.
Bytes bmp_file(std::uint32_t width, std::uint32_t height, std::uint32_t bits, const Bytes& palette,
               const Bytes& rows, std::uint32_t compression = 0) {
    Bytes file = bytes_of("BM");
    append(file, 0, 8);
    append(file, static_cast<std::uint32_t>(54 + palette.size()), 4);
    append(file, 40, 4);
    append(file, width, 4);
    append(file, height, 4);
    append(file, 1, 2);
    append(file, bits, 2);
    append(file, compression, 4);
    append(file, 0, 12);
    append(file, static_cast<std::uint32_t>(palette.size() / 4), 4);
    append(file, 0, 4);
    return file + palette + rows;
}

/// Blue, green, red.
const Bytes bmp_colors = bmp_file(2, 2, 24, {}, from_hex("0000ff00ff000000ff0000ffffff0000"));

TEST(Bmp, P3_RowsRunUpwardsUnlessTheHeightIsNegative) {
    const Image image = bmp(bmp_colors);
    EXPECT_EQ(image.rgb(0, 1), Color(1, 0, 0));
    EXPECT_EQ(image.rgb(1, 1), Color(0, 1, 0));
    EXPECT_EQ(image.rgb(0, 0), Color(0, 0, 1));
    EXPECT_EQ(image.rgb(1, 0), Color(1, 1, 1));
    EXPECT_TRUE(image.srgb_encoded);
    EXPECT_TRUE(image.eight_bits);
    const Image down = bmp(bmp_file(1, ~0u, 32, {}, from_hex("3300ff00")));
    EXPECT_EQ(down.rgb(0, 0), Color(1, 0, 0.2f));
}

TEST(Bmp, P3_PalettesAreLookedUp) {
    const Bytes palette = from_hex("0000ff0000ff0000ff000000");
    EXPECT_EQ(bmp(bmp_file(2, 1, 8, palette, from_hex("01020000"))).rgb(1, 0), Color(0, 0, 1));
    EXPECT_EQ(bmp(bmp_file(3, 1, 4, palette, from_hex("01200000"))).rgb(2, 0), Color(0, 0, 1));
    const Image bits = bmp(bmp_file(10, 1, 1, from_hex("00000000ffffff00"), from_hex("80400000")));
    for (int x = 0; x < 10; ++x) EXPECT_EQ(bits.rgb(x, 0).x, x == 0 || x == 9 ? 1 : 0) << x;
    EXPECT_EQ(file_error([&] { bmp(bmp_file(1, 1, 8, palette, from_hex("03000000"))); }),
              "damaged.img: is a damaged BMP picture: a pixel lies beyond its palette; get it "
              "again");
}

TEST(Bmp, DamagedAndCompressedOnesAreRefused) {
    expect_prefixes_refused(bmp_colors, [](const Bytes& b) { bmp(b); });
    EXPECT_GT(count_refused_mutants(bmp_colors, [](const Bytes& b) { bmp(b); }), 20);
    EXPECT_EQ(file_error([&] { bmp(bmp_file(1, 1, 8, {}, {}, 1)); }),
              "damaged.img: is a BMP picture with compression, which is not read; save it as PNG");
}

Bytes tga_header(int type, std::uint32_t width, std::uint32_t height, int bits, int descriptor,
                 std::uint32_t colors = 0) {
    Bytes file = {0, static_cast<std::uint8_t>(colors > 0), static_cast<std::uint8_t>(type)};
    append(file, 0, 2);
    append(file, colors, 2);
    append(file, colors > 0 ? 24 : 0, 1);
    append(file, 0, 4);
    append(file, width, 2);
    append(file, height, 2);
    append(file, static_cast<std::uint32_t>(bits), 1);
    append(file, static_cast<std::uint32_t>(descriptor), 1);
    return file;
}

/// A run of two pixels, and two as they are.
const Bytes tga_runs = tga_header(10, 2, 2, 24, 0) + from_hex("810000ff0100ff00ff0000");

TEST(Tga, P3_RunsAndOrientationsAreFollowed) {
    const Image image = tga(tga_runs);
    EXPECT_EQ(image.rgb(0, 1), Color(1, 0, 0));
    EXPECT_EQ(image.rgb(1, 1), Color(1, 0, 0));
    EXPECT_EQ(image.rgb(0, 0), Color(0, 1, 0));
    EXPECT_EQ(image.rgb(1, 0), Color(0, 0, 1));
    const Bytes pixels = from_hex("0000ff80ff000040");
    for (const int descriptor : {0x00, 0x10, 0x20, 0x30}) {
        const Image plain = tga(tga_header(2, 2, 1, 32, descriptor) + pixels);
        const int first = (descriptor & 0x10) != 0 ? 1 : 0;
        EXPECT_EQ(plain.rgb(first, 0), Color(1, 0, 0)) << descriptor;
        EXPECT_EQ(plain.rgb(1 - first, 0), Color(0, 0, 1)) << descriptor;
        EXPECT_EQ(plain.at(first, 0)[3], 128 / 255.0f);
    }
    EXPECT_EQ(tga(tga_header(3, 1, 2, 8, 0) + from_hex("00ff")).pixels, (std::vector<float>{1, 0}));
    const Image indexed = tga(tga_header(1, 2, 1, 8, 0, 2) + from_hex("0000ff00ff000100"));
    EXPECT_EQ(indexed.rgb(0, 0), Color(0, 1, 0));
    EXPECT_EQ(indexed.rgb(1, 0), Color(1, 0, 0));
}

TEST(Tga, DamagedOnesAreRefused) {
    // 15 bits are not read, be it in pixels or in a palette.
    EXPECT_THROW(tga(tga_header(2, 1, 1, 16, 0) + from_hex("ff7f")), FileError);
    EXPECT_THROW(tga(tga_header(3, 1, 1, 16, 0) + from_hex("ff7f")), FileError);
    expect_prefixes_refused(tga_runs, [](const Bytes& b) { tga(b); });
    EXPECT_GT(count_refused_mutants(tga_runs, [](const Bytes& b) { tga(b); }), 20);
}

TEST(PortableMap, P3_IntegersAreEncodedAndFloatsAreNot) {
    const Bytes pixels = bytes_of("P6 # made by hand\n2 1\n255\n") + from_hex("ff000033ff00");
    const Image color = map(pixels);
    EXPECT_EQ(color.pixels, (std::vector<float>{1, 0, 0, 0.2f, 1, 0}));
    EXPECT_TRUE(color.srgb_encoded);
    const Image grey = map(bytes_of("P5\n1 2\n65535\n") + from_hex("ffff3333"));
    EXPECT_EQ(grey.pixels, (std::vector<float>{1, 0.2f}));
    EXPECT_FALSE(grey.eight_bits);

    // Rows of floats run upwards; the sign of the scale is the order of their bytes, and its size a
    // factor.
    const Image little = map(bytes_of("Pf\n1 2\n-1.0\n") + from_hex("0000803f00000040"));
    const Image big = map(bytes_of("Pf\n1 2\n1.0\n") + from_hex("3f80000040000000"));
    EXPECT_EQ(little.pixels, (std::vector<float>{2, 1}));
    EXPECT_EQ(big.pixels, little.pixels);
    EXPECT_EQ(map(bytes_of("Pf\n1 1\n-2.0\n") + from_hex("00004040")).pixels,
              (std::vector<float>{6}));
    EXPECT_FALSE(little.srgb_encoded);
    expect_prefixes_refused(pixels, [](const Bytes& b) { map(b); });
    EXPECT_GT(count_refused_mutants(pixels, [](const Bytes& b) { map(b); }), 20);
}

TEST(PortableMap, FloatsAreWrittenAsTheyAre) {
    const TemporaryFolder folder;
    const auto written = [&](const Image& image) {
        write_portable_float_map(folder / "a.pfm", image);
        return read_file_bytes(folder / "a.pfm");
    };
    Image grey(1, 2, {"Y"});
    grey.pixels = {2, 1};
    EXPECT_EQ(written(grey), bytes_of("Pf\n1 2\n-1.0\n") + from_hex("0000803f00000040"));
    Image color(1, 2);
    color.pixels = {1e-30f, -2, 3e30f, 0.1f, infinity, 0};
    EXPECT_EQ(map(written(color)).pixels, color.pixels);
    EXPECT_THROW(written(Image(1, 1, {"R", "G", "B", "A"})), Error);
    EXPECT_THROW(write_portable_float_map(folder / "missing" / "a.pfm", grey), FileError);
}

}  // namespace
}  // namespace lucerna
