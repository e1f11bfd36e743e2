// SPDX-License-Identifier: Apache-2.0
#include "core/image/exr.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "tests/core/image/damage.h"
#include "tests/paths.h"

namespace lucerna {
namespace {

ImageFile decode(const Bytes& bytes) { return decode_exr(bytes, "damaged.img"); }

/// Beauty as half, a float layer, ids, all kinds of metadata, a crop.
ImageFile everything(int width, int height) {
    ImageFile file{.width = width, .height = height, .x = 3, .y = 5};
    file.full_width = width + 10;
    file.full_height = height + 20;
    const std::size_t count = std::size_t(width) * std::size_t(height);
    for (const char* name : {"R", "G", "B"}) {
        std::vector<float> samples(count);
        for (std::size_t i = 0; i < count; ++i) samples[i] = static_cast<float>(i % 64) / 8;
        file.planes.push_back({name, std::move(samples), true});
    }
    std::vector<float> depth(count);
    std::vector<std::uint32_t> ids(count);
    for (std::size_t i = 0; i < count; ++i) {
        depth[i] = std::sqrt(static_cast<float>(i)) * 1e-7f;
        ids[i] = 4000000000u + static_cast<std::uint32_t>(i * 2654435761u % 1000);
    }
    file.planes.push_back({"depth.Z", std::move(depth)});
    file.planes.push_back({"id", std::move(ids)});
    file.metadata["scene"] = std::string("<scene> ü\n");
    file.metadata["samples"] = -17;
    file.metadata["relative error"] = 0.1234567890123456;
    file.metadata[std::string(200, 'n')] = 1;
    return file;
}

void expect_equal(const ImageFile& a, const ImageFile& b) {
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(a.x, b.x);
    EXPECT_EQ(a.y, b.y);
    EXPECT_EQ(a.full_width, b.full_width);
    EXPECT_EQ(a.full_height, b.full_height);
    EXPECT_EQ(a.metadata, b.metadata);
    ASSERT_EQ(a.planes.size(), b.planes.size());
    for (const Plane& plane : a.planes) {
        const Plane* other = b.plane(plane.name);
        ASSERT_TRUE(other) << plane.name;
        EXPECT_EQ(plane.half, other->half) << plane.name;
        EXPECT_EQ(plane.samples, other->samples) << plane.name;
    }
}

TEST(Exr, EverythingComesBack) {
    for (const ExrCompression compression : {ExrCompression::zip, ExrCompression::piz}) {
        const ImageFile written = everything(37, 29);
        const ImageFile read = decode(bytes_of(encode_exr(written, compression)));
        expect_equal(written, read);
        ASSERT_TRUE(read.chromaticities);
        EXPECT_NEAR(read.chromaticities->green.y, 0.6, 1e-6);
    }
}

TEST(Exr, FileIsWrittenAndRead) {
    const TemporaryFolder folder;
    const ImageFile written = everything(8, 8);
    EXPECT_EQ(write_exr(folder / "a.exr", written), 0u);
    expect_equal(written, read_exr(folder / "a.exr"));
}

TEST(Exr, OwnChromaticitiesComeBack) {
    ImageFile file = everything(2, 2);
    file.chromaticities =
        Chromaticities{{0.713, 0.293}, {0.165, 0.83}, {0.128, 0.044}, {0.32168, 0.33767}};
    const ImageFile read = decode(bytes_of(encode_exr(file)));
    ASSERT_TRUE(read.chromaticities);
    EXPECT_NEAR(read.chromaticities->white.x, 0.32168, 1e-6);
    EXPECT_NEAR(read.chromaticities->blue.y, 0.044, 1e-6);
}

TEST(Exr, HalfStaysFiniteAndTheClampedAreCounted) {
    ImageFile file{.width = 6, .height = 1};
    const float inf = std::numeric_limits<float>::infinity();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    file.planes.push_back({"R", std::vector<float>{65504, 65519, 70000, -1e30f, inf, nan}, true});
    std::size_t clamped = 0;
    const ImageFile read = decode(bytes_of(encode_exr(file, ExrCompression::zip, &clamped)));
    EXPECT_EQ(clamped, 3u);
    const auto& values = std::get<std::vector<float>>(read.planes[0].samples);
    EXPECT_EQ(values[0], 65504);
    EXPECT_EQ(values[1], 65504);
    EXPECT_EQ(values[2], 65504);
    EXPECT_EQ(values[3], -65504);
    EXPECT_EQ(values[4], inf);  // what was not finite is not hidden
    EXPECT_TRUE(std::isnan(values[5]));
}

TEST(Exr, RefusesEveryShortenedFile) {
    const Bytes file = bytes_of(encode_exr(everything(5, 20)));
    expect_prefixes_refused(file, [](const Bytes& b) { decode(b); });
}

TEST(Exr, SurvivesDamage) {
    for (const ExrCompression compression : {ExrCompression::zip, ExrCompression::piz}) {
        const Bytes file = bytes_of(encode_exr(everything(24, 24), compression));
        const int refused = count_refused_mutants(file, [](const Bytes& b) { decode(b); });
        EXPECT_GT(refused, 15);  // PIZ has no checksum
        EXPECT_LT(refused, 200);
    }
}

/// Overwrites what follows `key` with 32 bit numbers.
Bytes patched(Bytes file, std::string_view key, std::size_t skip,
              const std::vector<std::int32_t>& values) {
    const auto at = std::search(file.begin(), file.end(), key.begin(), key.end());
    EXPECT_NE(at, file.end()) << key;
    std::memcpy(&*at + key.size() + skip, values.data(), 4 * values.size());
    return file;
}

TEST(Exr, L9_RefusesHugeSizesAtOnce) {
    using namespace std::string_view_literals;
    const Bytes file = bytes_of(encode_exr(everything(4, 4)));
    for (const std::int32_t size : {60000, 100000, 1000000, std::numeric_limits<int>::max()}) {
        Bytes huge = patched(file, "dataWindow\0box2i\0"sv, 4, {0, 0, size - 1, size - 1});
        huge = patched(huge, "displayWindow\0box2i\0"sv, 4, {0, 0, size - 1, size - 1});
        EXPECT_FALSE(file_error([&] { decode(huge); }).empty());
    }
    const Bytes inverted = patched(file, "dataWindow\0box2i\0"sv, 4, {5, 5, 1, 1});
    EXPECT_FALSE(file_error([&] { decode(inverted); }).empty());
}

/// Sizes, offsets, counts and flags of known attacks are numbers in the header and in the table
/// behind it that are zero, negative or huge.
TEST(Exr, L11_ExtremeNumbersAnywhereInTheHeaderDoNoHarm) {
    for (const ExrCompression compression : {ExrCompression::zip, ExrCompression::piz}) {
        const Bytes file = bytes_of(encode_exr(everything(8, 8), compression));
        int refused = 0;
        for (std::size_t at = 4; at + 4 < std::min<std::size_t>(file.size(), 1500); ++at) {
            for (const std::int32_t value : {0, -1, 0x7fffffff, -0x7fffffff - 1, 0x10000001}) {
                Bytes attack = file;
                std::memcpy(attack.data() + at, &value, 4);
                try {
                    decode(attack);
                } catch (const FileError& error) {
                    ++refused;
                    ASSERT_TRUE(std::string_view(error.what()).starts_with("damaged.img: "));
                }
            }
        }
        EXPECT_GT(refused, 500);
    }
}

TEST(Exr, OfMipmapsTheLargestIsRead) {
    // 3 x 2 pixels in tiles of 2 x 2, with the levels 2 x 1 and 1 x 1.
    const ImageFile file = decode(from_hex(
        "762f3101020200006368616e6e656c730063686c6973740013000000590002000000000000000100000001"
        "00000000636f6d7072657373696f6e00636f6d7072657373696f6e0001000000006461746157696e646f77"
        "00626f783269001000000000000000000000000200000001000000646973706c617957696e646f7700626f"
        "7832690010000000000000000000000002000000010000006c696e654f72646572006c696e654f72646572"
        "000100000000706978656c417370656374526174696f00666c6f617400040000000000803f73637265656e"
        "57696e646f7743656e746572007632660008000000000000000000000073637265656e57696e646f775769"
        "64746800666c6f617400040000000000803f74696c65730074696c65646573630009000000020000000200"
        "0000010049010000000000006d010000000000008901000000000000000000000000000000000000000000"
        "0010000000000000000000803f000040400000804001000000000000000000000000000000080000000000"
        "00400000a04000000000000000000100000001000000040000000000c842"));
    EXPECT_EQ(file.width, 3);
    EXPECT_EQ(file.height, 2);
    EXPECT_EQ(std::get<std::vector<float>>(file.planes.at(0).samples),
              (std::vector<float>{0, 1, 2, 3, 4, 5}));
    EXPECT_EQ(file.notice, "");
}

TEST(Exr, OfSeveralPartsTheFirstIsReadAndThatIsTold) {
    // Two parts of one pixel, 3 and 4.
    const ImageFile file = decode(from_hex(
        "762f3101021000006368616e6e656c730063686c6973740013000000590002000000000000000100000001"
        "000000006368756e6b436f756e7400696e74000400000001000000636f6d7072657373696f6e00636f6d70"
        "72657373696f6e0001000000006461746157696e646f7700626f7832690010000000000000000000000000"
        "00000000000000646973706c617957696e646f7700626f7832690010000000000000000000000000000000"
        "000000006c696e654f72646572006c696e654f726465720001000000006e616d6500737472696e67000100"
        "000061706978656c417370656374526174696f00666c6f617400040000000000803f73637265656e57696e"
        "646f7743656e746572007632660008000000000000000000000073637265656e57696e646f775769647468"
        "00666c6f617400040000000000803f7479706500737472696e67000d0000007363616e6c696e65696d6167"
        "65006368616e6e656c730063686c6973740013000000590002000000000000000100000001000000006368"
        "756e6b436f756e7400696e74000400000001000000636f6d7072657373696f6e00636f6d7072657373696f"
        "6e0001000000006461746157696e646f7700626f7832690010000000000000000000000000000000000000"
        "00646973706c617957696e646f7700626f7832690010000000000000000000000000000000000000006c69"
        "6e654f72646572006c696e654f726465720001000000006e616d6500737472696e67000100000062706978"
        "656c417370656374526174696f00666c6f617400040000000000803f73637265656e57696e646f7743656e"
        "746572007632660008000000000000000000000073637265656e57696e646f77576964746800666c6f6174"
        "00040000000000803f7479706500737472696e67000d0000007363616e6c696e65696d6167650000bd0200"
        "0000000000cd02000000000000000000000000000004000000000040400100000000000000040000000000"
        "8040"));
    EXPECT_EQ(std::get<std::vector<float>>(file.planes.at(0).samples), std::vector<float>{3});
    EXPECT_NE(file.notice.find("2 parts"), std::string::npos);
    EXPECT_EQ(to_image(file).notice, file.notice);
}

/// Made by Imf::RgbaOutputFile with WRITE_YCA: 4 x 4 pixels at (2, 2) of 8 x 8, not compressed.
/// The colour is (0.75, 0.25, 0.5) k / 16 for k = 1 … 16, alpha x / 4.
const Bytes& luminance_chroma() {
    static const Bytes bytes = from_hex(
        "762f3101020000006368616e6e656c730063686c697374004b0000004100010000000000000001000000"
        "010000004259000100000001000000020000000200000052590001000000010000000200000002000000"
        "59000100000000000000010000000100000000636f6d7072657373696f6e00636f6d7072657373696f6e"
        "0001000000006461746157696e646f7700626f7832690010000000020000000200000005000000050000"
        "00646973706c617957696e646f7700626f7832690010000000000000000000000007000000070000006c"
        "696e654f72646572006c696e654f72646572000100000000706978656c417370656374526174696f0066"
        "6c6f617400040000000000803f73637265656e57696e646f7743656e7465720076326600080000000000"
        "00000000000073637265656e57696e646f77576964746800666c6f617400040000000000803f006d0100"
        "00000000008d01000000000000a501000000000000c50100000000000002000000180000000000003400"
        "38003a60356035003c003c0026002a802c002e0300000010000000000000340038003a802f8030403100"
        "320400000018000000000000340038003a60356035003c003cc032803320348034050000001000000000"
        "0000340038003ae0344035a0350036");
    return bytes;
}

TEST(Exr, P3_LuminanceAndChromaBecomeRgb) {
    const ImageFile file = decode(luminance_chroma());
    EXPECT_EQ(file.planes.size(), 4u);
    EXPECT_EQ(Vector2i(file.x, file.y), Vector2i(2, 2));
    EXPECT_EQ(Vector2i(file.full_width, file.full_height), Vector2i(8, 8));
    const Image image = to_image(file);
    EXPECT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B", "A"}));
    for (std::size_t i = 0; i < 16; ++i) {
        const float scale = static_cast<float>(i + 1) / 16;
        const float* const pixel = image.pixels.data() + 4 * i;
        // Halves of which the writer keeps seven bits.
        EXPECT_NEAR(pixel[0], 0.75f * scale, 0.005f * scale);
        EXPECT_NEAR(pixel[1], 0.25f * scale, 0.005f * scale);
        EXPECT_NEAR(pixel[2], 0.5f * scale, 0.005f * scale);
        EXPECT_EQ(pixel[3], static_cast<float>(i % 4) / 4);
    }
}

TEST(Exr, P3_DamagedLuminanceAndChromaAreErrors) {
    expect_prefixes_refused(luminance_chroma(), [](const Bytes& b) { decode(b); });
    EXPECT_GT(count_refused_mutants(luminance_chroma(), [](const Bytes& b) { decode(b); }), 20);
    using namespace std::string_view_literals;
    const auto message = [](const Bytes& bytes) { return file_error([&] { decode(bytes); }); };
    Bytes renamed = luminance_chroma();
    constexpr std::string_view name = "BY\0"sv;
    *std::search(renamed.begin(), renamed.end(), name.begin(), name.end()) = 'C';
    EXPECT_NE(message(renamed).find("no channel \"BY\"; save it as RGB"), std::string::npos);
    // A channel: name, type, four bytes, sampling in x, sampling in y.
    const Bytes fine = patched(luminance_chroma(), "BY\0"sv, 8, {1, 1});
    EXPECT_NE(message(fine).find("a value for 1 x 1 pixels, not for 2 x 2"), std::string::npos);
}

TEST(Exr, RefusesWhatIsNotFlatRgb) {
    using namespace std::string_view_literals;
    ImageFile chroma = everything(4, 4);
    chroma.planes[0].name = "RY";
    const Bytes chroma_alone = bytes_of(encode_exr(chroma));
    EXPECT_NE(file_error([&] { decode(chroma_alone); }).find("save it as RGB"), std::string::npos);

    const Bytes file = bytes_of(encode_exr(everything(4, 4)));
    // A channel: name, type, four bytes, sampling in x, sampling in y.
    const Bytes subsampled = patched(file, "depth.Z\0"sv, 8, {2, 2});
    EXPECT_FALSE(file_error([&] { decode(subsampled); }).empty());

    Bytes deep = file;
    deep[5] |= 0x08;
    EXPECT_NE(file_error([&] { decode(deep); }).find("deep"), std::string::npos);
    EXPECT_FALSE(file_error([&] { decode(bytes_of("\x76\x2f\x31\x01 garbage")); }).empty());
}

TEST(Exr, RefusesToWriteNonsense) {
    const auto with = [](const std::function<void(ImageFile&)>& change) {
        ImageFile file = everything(4, 4);
        change(file);
        return file;
    };
    EXPECT_THROW(encode_exr(with([](auto& f) { f.planes.clear(); })), Error);
    EXPECT_THROW(encode_exr(with([](auto& f) { f.width = 0; })), Error);
    EXPECT_THROW(encode_exr(with([](auto& f) { f.planes[1].name = "R"; })), Error);
    EXPECT_THROW(encode_exr(with([](auto& f) { f.planes[1].samples = std::vector<float>(3); })),
                 Error);
    EXPECT_THROW(encode_exr(with([](auto& f) { f.metadata["compression"] = 1; })), Error);
}

}  // namespace
}  // namespace lucerna
