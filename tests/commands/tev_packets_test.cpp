// SPDX-License-Identifier: Apache-2.0
/// The packets for tev, byte by byte as its own client library writes them (tevclient 1.0.4 for
/// Python: create_image, update_image and close_image with the same arguments).
#include "plugins/previews/tev_packets.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace lucerna {
namespace {

std::string hex(const std::string& bytes) {
    std::string text;
    for (const char c : bytes) text += fmt::format("{:02x}", static_cast<unsigned char>(c));
    return text;
}

TEST(TevPackets, are_those_of_its_client_library) {
    EXPECT_EQ(hex(tev_create_image("a.exr", {5, 4})),
              "1e000000"                // length
              "0401"                    // create, and select
              "612e65787200"            // "a.exr"
              "0500000004000000"        // width, height
              "03000000520047004200");  // three channels
    Image image(3, 1);
    image.set_rgb(1, 0, Color(1, 2, 3));
    image.set_rgb(2, 0, Color(0.5f, -1, 0));
    EXPECT_EQ(hex(tev_update_image("a.exr", image, {2, 2}, {1, 0}, {2, 1})),
              "6e000000"
              "0600"  // update, version 3, without selecting
              "612e65787200"
              "03000000520047004200"
              "03000000020000000200000001000000"                  // x, y, width, height
              "000000000000000001000000000000000200000000000000"  // offsets
              "030000000000000003000000000000000300000000000000"  // strides
              "0000803f0000004000004040"                          // 1, 2, 3
              "0000003f000080bf00000000");                        // 0.5, -1, 0
    EXPECT_EQ(hex(tev_close_image("a.exr")), "0b00000002612e65787200");
}

}  // namespace
}  // namespace lucerna
