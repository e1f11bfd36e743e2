// SPDX-License-Identifier: Apache-2.0
#include "core/image/jpeg.h"

#include <gtest/gtest.h>

#include "tests/core/image/damage.h"

namespace lucerna {
namespace {

/// 16 x 16 pixels, progressive, quality 95: red 200 on the left and 20 on the right, green 40 above
/// and 160 below, blue 90.
const Bytes quarters = from_hex(
    "ffd8ffe000104a46494600010100000100010000ffdb00430002010101010102010101020202020204030202"
    "02020504040304060506060605060606070908060709070606080b08090a0a0a0a0a06080b0c0b0a0c090a0a"
    "0affdb004301020202020202050303050a0706070a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a"
    "0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0affc200110800100010030111000211010311"
    "01ffc4001500010100000000000000000000000000000708ffc4001701010101010000000000000000000000"
    "0008060307ffda000c030100021003100000013bcd3027784bbe0e7d404ef897ffc400141001000000000000"
    "00000000000000000020ffda00080101000105021fffc40014110100000000000000000000000000000020ff"
    "da0008010301013f011fffc40014110100000000000000000000000000000020ffda0008010201013f011fff"
    "c40014100100000000000000000000000000000020ffda0008010100063f021fffc400141001000000000000"
    "00000000000000000020ffda0008010100013f211fffda000c03010002000300000010000fffc40014110100"
    "000000000000000000000000000020ffda0008010301013f101fffc400141101000000000000000000000000"
    "00000020ffda0008010201013f101fffc40014100100000000000000000000000000000020ffda0008010100"
    "013f101fffd9");

Image decode(const Bytes& bytes) { return decode_jpeg(bytes, "damaged.img"); }

TEST(Jpeg, ReadsColours) {
    const Image image = decode(quarters);
    ASSERT_EQ(image.width, 16);
    ASSERT_EQ(image.height, 16);
    EXPECT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B"}));
    EXPECT_TRUE(image.srgb_encoded);
    const auto expect_near = [&](int x, int y, Color expected) {
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.rgb(x, y)[c] * 255, expected[c], 3) << x << y;
    };
    expect_near(2, 2, {200, 40, 90});
    expect_near(13, 2, {20, 40, 90});
    expect_near(2, 13, {200, 160, 90});
    expect_near(13, 13, {20, 160, 90});
}

/// The picture with a segment behind its first marker.
Bytes with_segment(const std::string& hex) {
    Bytes file = quarters;
    const Bytes segment = from_hex(hex);
    file.insert(file.begin() + 2, segment.begin(), segment.end());
    return file;
}

TEST(Jpeg, TellsThatExifWouldTurnThePixels) {
    EXPECT_EQ(decode(quarters).notice, "");
    // TIFF with one entry: tag 0x0112, type 3, count 1, the orientation; either order of bytes.
    const auto big = [](const std::string& value) {
        return with_segment(
            "ffe10022457869660000"
            "4d4d002a00000008"
            "0001"
            "011200030000000100" +
            value +
            "0000"
            "00000000");
    };
    const Bytes little = with_segment(
        "ffe10022457869660000"
        "49492a0008000000"
        "0100"
        "1201030001000000"
        "08000000"
        "00000000");
    const Image turned = decode(big("06"));
    EXPECT_NE(turned.notice.find("orientation 6"), std::string::npos) << turned.notice;
    EXPECT_EQ(turned.pixels, decode(quarters).pixels);
    EXPECT_EQ(decode(big("01")).notice, "");
    EXPECT_NE(decode(little).notice.find("orientation 8"), std::string::npos);
    // Offsets beyond the end of the segment.
    EXPECT_EQ(decode(with_segment("ffe10010457869660000"
                                  "4d4d002affffffff"))
                  .notice,
              "");
}

TEST(Jpeg, RefusesEveryShortenedFile) {
    // The end marker itself may be missing: nothing is lost without it.
    const Bytes body(quarters.begin(), quarters.end() - 4);
    expect_prefixes_refused(body, [](const Bytes& b) { decode(b); });
}

TEST(Jpeg, SurvivesDamage) {
    const int refused = count_refused_mutants(quarters, [](const Bytes& b) { decode(b); });
    EXPECT_GT(refused, 20);
    EXPECT_LT(refused, 200);
}

/// 16 x 16 pixels, as Adobe stores them: the paper that cyan leaves bare is 40 / 255, magenta 200,
/// yellow 160, black 200.
const Bytes cmyk_picture = from_hex(
    "ffd8ffee000e41646f626500640000000002ffdb004300020101010101020101010202020202040302020202"
    "0504040304060506060605060606070908060709070606080b08090a0a0a0a0a06080b0c0b0a0c090a0a0aff"
    "db004301020202020202050303050a0706070a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a"
    "0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0affc0001408001000100401110002110103110104"
    "1100ffc400160001010100000000000000000000000000000709ffc400141001000000000000000000000000"
    "00000000ffc400160101010100000000000000000000000000000509ffc40014110100000000000000000000"
    "000000000000ffda000e040100021103110400003f0095a1b4d1a40000000fffd9");

TEST(Jpeg, ReadsCmykAsIdealInks) {
    const Image image = decode(cmyk_picture);
    ASSERT_EQ(image.channels.size(), 3u);
    EXPECT_NE(image.notice.find("CMYK"), std::string::npos);
    const Color expected(40 * 200 / 255.0f, 200 * 200 / 255.0f, 160 * 200 / 255.0f);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.rgb(7, 7)[c] * 255, expected[c], 2);
}

}  // namespace
}  // namespace lucerna
