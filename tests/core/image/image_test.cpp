// SPDX-License-Identifier: Apache-2.0
#include "core/image/image.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace lucerna {
namespace {

TEST(Image, PixelsAreInterleavedRowsFromTheTop) {
    Image image(3, 2);
    image.set_rgb(2, 1, {1, 2, 3});
    EXPECT_EQ(image.pixels[15], 1);
    EXPECT_EQ(image.pixels[17], 3);
    EXPECT_EQ(image.rgb(std::size_t{5}), Color(1, 2, 3));
    EXPECT_EQ(image.channel("B"), 2u);
    EXPECT_FALSE(image.channel("A"));
}

TEST(Image, GreyIsAColour) {
    Image image(1, 1, {"Y", "A"});
    image.pixels = {0.5f, 0.25f};
    EXPECT_EQ(image.rgb(0, 0), Color(0.5f));
}

TEST(Image, NeedsASize) {
    EXPECT_THROW(Image(0, 4), Error);
    EXPECT_THROW(Image(4, -1), Error);
}

ImageFile two_layers() {
    ImageFile file{.width = 2, .height = 1};
    file.planes.push_back({"A", std::vector<float>{1, 1}});
    file.planes.push_back({"B", std::vector<float>{3, 30}});
    file.planes.push_back({"G", std::vector<float>{2, 20}});
    file.planes.push_back({"R", std::vector<float>{1, 10}});
    file.planes.push_back({"light.group.id", std::vector<std::uint32_t>{7, 4000000000u}});
    return file;
}

TEST(Image, OneChannelIsGreyAndAlphaIsNotEncoded) {
    Image image(2, 1, {"R", "G", "B", "A"});
    image.pixels = {1, 2, 3, 4, 5, 6, 7, 8};
    image.srgb_encoded = true;
    const Image green = one_channel(image, 1), alpha = one_channel(image, 3);
    EXPECT_EQ(green.pixels, (std::vector<float>{2, 6}));
    EXPECT_EQ(green.channels, std::vector<std::string>{"Y"});
    EXPECT_TRUE(green.srgb_encoded);
    EXPECT_EQ(alpha.pixels, (std::vector<float>{4, 8}));
    EXPECT_FALSE(alpha.srgb_encoded);
}

TEST(ImageFile, ColourComesFirst) {
    const Image image = to_image(two_layers());
    EXPECT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B", "A"}));
    EXPECT_EQ(image.pixels, (std::vector<float>{1, 2, 3, 1, 10, 20, 30, 1}));
}

/// One pixel, whose values are 1, 2, 3, … in the order of the names.
ImageFile pixel_of(const std::vector<std::string>& names) {
    ImageFile file{.width = 1, .height = 1};
    for (const std::string& name : names) {
        const auto value = static_cast<float>(file.planes.size() + 1);
        file.planes.push_back({name, std::vector<float>{value}});
    }
    return file;
}

TEST(ImageFile, P3_ChannelsAreKnownByAnyOfTheirNames) {
    using Names = std::vector<std::string>;
    using Values = std::vector<float>;
    const Image small = to_image(pixel_of({"a", "b", "g", "r"}));
    EXPECT_EQ(small.channels, (Names{"R", "G", "B", "A"}));
    EXPECT_EQ(small.pixels, (Values{4, 3, 2, 1}));
    EXPECT_EQ(to_image(pixel_of({"Blue", "green", "RED"})).pixels, (Values{3, 2, 1}));
    EXPECT_EQ(to_image(pixel_of({"A", "X", "Y", "Z"})).channels, (Names{"X", "Y", "Z", "A"}));
    EXPECT_EQ(to_image(pixel_of({"A", "B", "G", "R", "Z"})).channels,
              (Names{"R", "G", "B", "A", "Z"}));
    EXPECT_EQ(to_image(pixel_of({"A", "Y", "Z"})).channels, (Names{"Y", "A", "Z"}));
    for (const Names& names : {Names{"R"}, Names{"Z"}, Names{"A", "Y"}, Names{"B", "G", "R"}}) {
        EXPECT_EQ(to_image(pixel_of(names)).notice, "") << names[0];
    }
    EXPECT_EQ(to_image(pixel_of({"G", "R"})).notice,
              "its channels are R, G; \"R\" is taken as grey");
    EXPECT_EQ(to_image(pixel_of({"N", "U", "V"})).notice,
              "its channels are N, U, V; the first three are taken as red, green and blue");
}

TEST(ImageFile, LayersAreNamedBeforeTheLastDot) {
    const ImageFile file = two_layers();
    EXPECT_EQ(file.layers(), (std::vector<std::string>{"", "light.group"}));
    const Image ids = to_image(file, "light.group");
    EXPECT_EQ(ids.channels, std::vector<std::string>{"id"});
    EXPECT_EQ(ids.pixels, (std::vector<float>{7, 4e9f}));
    try {
        to_image(file, "albedo");
        FAIL() << "there is no such layer";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("light.group"), std::string::npos);
    }
}

TEST(ImageFile, LayersAreAddedAndComeBack) {
    Image image(2, 2);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(i);
    ImageFile file;
    add_layer(file, image);
    add_layer(file, image, "albedo", true);
    EXPECT_EQ(to_image(file, "albedo").pixels, image.pixels);
    EXPECT_TRUE(file.plane("albedo.G")->half);
    EXPECT_FALSE(file.plane("G")->half);
    EXPECT_THROW(add_layer(file, image, "albedo"), Error);
    EXPECT_THROW(add_layer(file, Image(2, 3), "normal"), Error);
}

TEST(ImageFile, WrongNumberOfSamplesIsFound) {
    ImageFile file = two_layers();
    file.planes.push_back({"Z", std::vector<float>{1}});
    EXPECT_THROW(to_image(file), Error);
}

TEST(ImageSize, OnlyImpossibleSizesAreRefused) {
    EXPECT_NO_THROW(check_image_size("a", 16384, 8192, 4, 40 << 20));
    EXPECT_NO_THROW(check_image_size("a", 4096, 4096, 4, 300));  // black compresses well
    EXPECT_THROW(check_image_size("a", 65536, 65536, 4, 22 << 10), FileError);
    EXPECT_THROW(check_image_size("a", 65537, 1, 1, 1 << 30), FileError);
    EXPECT_THROW(check_image_size("a", 0, 1, 1, 10), FileError);
    EXPECT_THROW(check_image_size("a", -5, 1, 1, 10), FileError);
}

}  // namespace
}  // namespace lucerna
