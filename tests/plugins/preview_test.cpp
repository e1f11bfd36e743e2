// SPDX-License-Identifier: Apache-2.0
/// What previews send: the bytes of tev's protocol, pictures for pages, curves of the error.
#include "plugins/previews/error_history.h"
#include "plugins/previews/place.h"
#include "plugins/previews/reduced_image.h"
#include "plugins/previews/tev_packets.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace lucerna {
namespace {

std::string hexadecimal(const std::string& bytes) {
    std::string text;
    for (const char byte : bytes) text += fmt::format("{:02x}", static_cast<unsigned char>(byte));
    return text;
}

// tevclient 1.0.4: packet.create_image("r", 2, 1, ["R", "G", "B"]),
// packet.update_image("r", [[[1, .5, .25], [2, -1, .125]]], ["R", "G", "B"], 5, 7, False),
// packet.close_image("r").
TEST(TevPackets, AreThoseOfTevsOwnClient) {
    EXPECT_EQ(hexadecimal(tev_create_image("r", Vector2i(2, 1))),
              "1a000000040172000200000001000000030000005200"
              "47004200");
    Image image(3, 2);
    image.set_rgb(1, 1, Color(1, 0.5f, 0.25f));
    image.set_rgb(2, 1, Color(2, -1, 0.125f));
    EXPECT_EQ(
        hexadecimal(tev_update_image("r", image, Vector2i(4, 6), Vector2i(1, 1), Vector2i(2, 1))),
        "6a00000006007200030000005200470042000500000007000000020000000100000000000000000000000"
        "1000000000000000200000000000000030000000000000003000000000000000300000000000000000080"
        "3f0000003f0000803e00000040000080bf0000003e");
    EXPECT_EQ(hexadecimal(tev_close_image("r")), "07000000027200");
}

TEST(PreviewPlace, IsWhatTheCommandLineSays) {
    const auto text = [](const char* words) { return parse_place(words, {"here", 7}).text(); };
    EXPECT_EQ(text(""), "here:7");
    EXPECT_EQ(text("80"), "here:80");
    EXPECT_EQ(text("there"), "there:7");
    EXPECT_EQ(text("there:80"), "there:80");
    EXPECT_EQ(text("10.0.0.1:65535"), "10.0.0.1:65535");
    EXPECT_EQ(text("[::1]"), "[::1]:7");
    EXPECT_EQ(text("[::1]:80"), "[::1]:80");
    for (const char* wrong :
         {":", ":80", "there:", "there:0", "there:65536", "there:8x", "there:-1", "99999999999",
          "[::1", "[::1]80", "[]:80", "there:80:80"}) {
        EXPECT_THROW(parse_place(wrong, {"here", 7}), Error) << wrong;
    }
}

TEST(ReducedImage, KeepsTheMean) {
    Image image(5, 3);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = float(i);
    const Image half = reduced(image, 2);
    ASSERT_EQ(half.width, 3);
    ASSERT_EQ(half.height, 2);
    // (0 + 3 + 15 + 18) / 4, and in the corner a pixel by itself.
    EXPECT_EQ(half.rgb(0, 0), Color(9, 10, 11));
    EXPECT_EQ(half.rgb(2, 1), image.rgb(4, 2));
}

TEST(ReducedImage, IsReducedOnlyIfItIsTooLarge) {
    Image image(5, 3);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = float(i);
    const std::string whole = reduced_picture_bytes(image, 5);
    ASSERT_EQ(whole.size(), 8 + 5 * 3 * 12u);
    EXPECT_EQ(hexadecimal(whole.substr(0, 8)), "0500000003000000");
    EXPECT_EQ(std::memcmp(whole.data() + 8, image.pixels.data(), whole.size() - 8), 0);
    EXPECT_EQ(hexadecimal(reduced_picture_bytes(image, 4).substr(0, 8)), "0300000002000000");
    EXPECT_EQ(hexadecimal(reduced_picture_bytes(image, 2).substr(0, 8)), "0200000001000000");
}

TEST(ErrorHistory, KeepsItsEndsInAFewPoints) {
    ErrorHistory history;
    RenderStatus status;
    history.add(status);
    EXPECT_EQ(history.json().line(), "[]\n");
    for (int i = 1; i <= 5000; ++i) {
        status.seconds = i;
        status.error = ErrorEstimate{.relative_mse = 1.0 / i};
        history.add(status);
        history.add(status);  // the same error, looked at twice
        EXPECT_LE(history.size(), ErrorHistory::most_points);
    }
    EXPECT_GT(history.size(), ErrorHistory::most_points / 2);
    const std::string text = history.json().line();
    EXPECT_EQ(text.substr(0, 10), "[[1.0,1.0]");
    EXPECT_TRUE(text.ends_with(",[5000.0,0.0002]]\n")) << text;
}

}  // namespace
}  // namespace lucerna
