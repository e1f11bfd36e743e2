// SPDX-License-Identifier: Apache-2.0
#include "core/image/read_image.h"

#include <gtest/gtest.h>

#include "core/base/atomic_file.h"
#include "core/image/exr.h"
#include "core/image/png.h"
#include "tests/core/image/damage.h"
#include "tests/paths.h"

namespace lucerna {
namespace {

TEST(ReadImage, TheContentDecidesNotTheName) {
    const TemporaryFolder folder;
    Image pixel(1, 1);
    pixel.set_rgb(0, 0, {0.25f, 2, -3});
    ImageFile file;
    add_layer(file, pixel);
    write_exr(folder / "a.png", file);
    write_png(folder / "b.exr", {.width = 1, .height = 1, .pixels = {255, 0, 51}});
    write_file_atomically(folder / "c.jpg",
                          std::string("#?RGBE\n\n-Y 1 +X 1\n\x03\x02\x01\x88", 23));

    EXPECT_EQ(read_image(folder / "a.png").rgb(0, 0), Color(0.25f, 2, -3));
    EXPECT_FALSE(read_image(folder / "a.png").srgb_encoded);
    EXPECT_EQ(read_image(folder / "b.exr").rgb(0, 0), Color(1, 0, 0.2f));
    EXPECT_TRUE(read_image(folder / "b.exr").srgb_encoded);
    EXPECT_EQ(read_image(folder / "c.jpg").rgb(0, 0), Color(3, 2, 1));
}

TEST(ReadImage, P3_ThePictureIsTheDisplayWindow) {
    const TemporaryFolder folder;
    const auto read = [&](int x, int y, ExrWindow window) {
        ImageFile file{.x = x, .y = y, .full_width = 4, .full_height = 3};
        Image part(2, 2, {"Y"});
        part.pixels = {1, 2, 3, 4};
        add_layer(file, part);
        write_exr(folder / "part.exr", file);
        return read_image(folder / "part.exr", window);
    };
    const Image inside = read(1, 1, ExrWindow::display);
    EXPECT_EQ(inside.width, 4);
    EXPECT_EQ(inside.pixels, (std::vector<float>{0, 0, 0, 0,  //
                                                 0, 1, 2, 0,  //
                                                 0, 3, 4, 0}));
    EXPECT_EQ(read(1, 1, ExrWindow::data).pixels, (std::vector<float>{1, 2, 3, 4}));
    // What lies beyond the display window is not seen.
    EXPECT_EQ(read(-1, 2, ExrWindow::display).pixels,
              (std::vector<float>{0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0}));
    EXPECT_EQ(read(9, -5, ExrWindow::display).pixels, std::vector<float>(12));
}

TEST(ReadImage, P7_WhereAllIsInLayersTheFirstColourIsThePicture) {
    const TemporaryFolder folder;
    const auto plane = [](const char* name, float value) {
        return Plane{name, std::vector<float>{value}};
    };
    write_exr(
        folder / "layers.exr",
        {.width = 1,
         .height = 1,
         .planes = {plane("Scene.Depth.Z", 9), plane("Scene.Main.A", 1), plane("Scene.Main.B", 4),
                    plane("Scene.Main.G", 3), plane("Scene.Main.R", 2), plane("Scene.Z.B", 8),
                    plane("Scene.Z.G", 7), plane("Scene.Z.R", 6)}});
    const Image image = read_image(folder / "layers.exr");
    EXPECT_EQ(image.pixels, (std::vector<float>{2, 3, 4, 1}));
    EXPECT_EQ(image.notice, "all its channels are in layers, of which \"Scene.Main\" is used");

    // Names of channels may be small, or whole words.
    write_exr(folder / "small.exr",
              {.width = 1,
               .height = 1,
               .planes = {plane("a.z", 9), plane("b.b", 4), plane("b.g", 3), plane("b.r", 2),
                          plane("c.blue", 7), plane("c.green", 6), plane("c.red", 5)}});
    const Image small = read_image(folder / "small.exr");
    EXPECT_EQ(small.pixels, (std::vector<float>{2, 3, 4}));
    EXPECT_EQ(small.notice, "all its channels are in layers, of which \"b\" is used");
}

TEST(ReadImage, P3_PlainFormatsAreKnownByTheirContent) {
    const TemporaryFolder folder;
    using namespace std::string_literals;
    write_file_atomically(folder / "a.png", "Pf\n1 1\n-1\n\0\0\x80\x3f"s);
    write_file_atomically(folder / "b.png", "P6 1 1 255\nabc"s);
    const std::string gray_tga = "\0\0\3\0\0\0\0\0\0\0\0\0\1\0\1\0\x08\0\xff"s;
    write_file_atomically(folder / "c.tga", gray_tga);
    write_file_atomically(folder / "c.png", gray_tga + "\0\0\0\0\0\0\0\0TRUEVISION-XFILE.\0"s);
    for (const char* name : {"a.png", "c.tga", "c.png"}) {
        EXPECT_EQ(read_image(folder / name).pixels, std::vector<float>{1}) << name;
    }
    EXPECT_EQ(read_image(folder / "b.png").pixels[0], 'a' / 255.0f);
}

TEST(ReadImage, SaysWhatIsWrong) {
    const TemporaryFolder folder;
    const auto message = [](const std::filesystem::path& path) {
        const std::string text = file_error([&] { read_image(path); });
        EXPECT_TRUE(text.starts_with(path.string())) << text;
        return text;
    };
    write_file_atomically(folder / "text.png", "a text");
    write_file_atomically(folder / "empty.png", "");
    write_file_atomically(folder / "short.jpg", "\xff\xd8\xff");
    ImageFile only_a_layer{.width = 1, .height = 1};
    only_a_layer.planes.push_back({"albedo.R", std::vector<float>{1}});
    write_exr(folder / "layer.exr", only_a_layer);

    EXPECT_NE(message(folder / "text.png").find("convert it to OpenEXR"), std::string::npos);
    EXPECT_NE(message(folder / "empty.png").find("is empty"), std::string::npos);
    EXPECT_NE(message(folder / "short.jpg").find("it is damaged"), std::string::npos);
    EXPECT_NE(message(folder / "layer.exr").find("albedo"), std::string::npos);
    EXPECT_NE(message(folder / "none.exr").find("no such file"), std::string::npos);
    EXPECT_NE(message(folder.path()).find("directory"), std::string::npos);
}

}  // namespace
}  // namespace lucerna
