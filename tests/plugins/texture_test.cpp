// SPDX-License-Identifier: Apache-2.0
/// What every texture must satisfy, tried on all that the registry finds, and what pictures show.
#include "core/interfaces/texture.h"
#include "core/base/atomic_file.h"
#include "core/image/color.h"
#include "core/image/exr.h"
#include "core/image/png.h"
#include "core/math/sequences.h"
#include "plugins/commands/contracts/texture.h"
#include "tests/core/image/damage.h"
#include "tests/plugins/workshop.h"
#include "tests/statistics.h"
#include "tests/vol_writer.h"

#include <map>

namespace lucerna {
namespace {

std::string texture(const std::string& type, const std::string& body = "") {
    return fmt::format("<texture type='{}'>{}</texture>", type, body);
}
std::string bitmap(const std::string& file, const std::string& body = "") {
    return texture("bitmap", word("filename", file) + body);
}
std::string to_uv(const std::string& steps) {
    return "<transform name='to_uv'>" + steps + "</transform>";
}
const std::string raw = "<boolean name='raw' value='true'/>";
const std::string nearest = word("filter_type", "nearest");

std::string text_of_hex(const std::string& hex) {
    const Bytes bytes = from_hex(hex);
    return {bytes.begin(), bytes.end()};
}

class Textures : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder = new TemporaryFolder;
        // Red and green above, blue and white below.
        write_png(*folder / "corners.png", {.width = 2,
                                            .height = 2,
                                            .pixels = {255, 0, 0, 0, 255, 0,  //
                                                       0, 0, 255, 255, 255, 255}});
        write_png(*folder / "grey.png", {.width = 1, .height = 1, .pixels = {128, 128, 128}});
        Image noise(5, 3);
        Rng rng(1);
        for (float& v : noise.pixels) v = 4 * rng.next_float() - 1;
        ImageFile file;
        add_layer(file, noise);
        write_exr(*folder / "noise.exr", file);
        Image broken(2, 1, {"Y"});
        broken.pixels = {std::numeric_limits<float>::quiet_NaN(), 3};
        ImageFile broken_file;
        add_layer(broken_file, broken);
        write_exr(*folder / "broken.exr", broken_file);
    }
    static void TearDownTestSuite() { delete folder; }

    const Texture& make(const std::string& xml) { return workshop_.make<Texture>(xml); }

    /// Every texture with defaults, and some with parameters that are hard.
    std::vector<std::string> all() {
        const std::map<std::string, std::string> bodies = {
            {"bitmap", word("filename", "noise.exr")},
            {"mesh_attribute", word("name", "vertex_color")},
            {"rawconstant", number("value", 0.3)}};
        std::vector<std::string> list;
        for (const std::string& name : workshop_.registry().names("texture")) {
            const auto body = bodies.find(name);
            list.push_back(texture(name, body == bodies.end() ? "" : body->second));
        }
        for (const char* wrap : {"repeat", "mirror", "clamp"}) {
            const std::string wrap_mode = word("wrap_mode", wrap);
            list.push_back(bitmap("noise.exr", wrap_mode + to_uv("<rotate z='1' angle='30'/>"
                                                                 "<scale x='2' y='-3'/>")));
            list.push_back(bitmap("corners.png", wrap_mode + raw));
            list.push_back(bitmap("grey.png", wrap_mode));
            list.push_back(bitmap("noise.exr", wrap_mode + nearest));
        }
        list.push_back(texture("checkerboard", to_uv("<scale value='4'/>")));
        list.push_back(texture("rawconstant", "<vector name='value' value='-1, 2, 0.5'/>"));
        return list;
    }

    static inline TemporaryFolder* folder = nullptr;
    Workshop workshop_{folder->path()};
};

TEST_F(Textures, StayBelowTheirMaximumAndFinite) {
    for (const std::string& xml : all()) {
        EXPECT_TRUE(holds(contracts::texture_values(make(xml), {}))) << xml;
    }
}

TEST_F(Textures, RawConstantsAreOneNumberOrThree) {
    const Texture& three =
        make(texture("rawconstant", "<vector name='value' x='-1' y='2' z='0.5'/>"));
    EXPECT_EQ(three.color({0.3f, 0.4f}), Color(-1, 2, 0.5f));
    EXPECT_EQ(three.real({0, 0}), luminance({-1, 2, 0.5f}));
    EXPECT_EQ(make(texture("rawconstant", number("value", 0.3))).color({0, 0}), Color(0.3f));
    EXPECT_NE(refusal(texture("rawconstant", "<rgb name='value' value='1'/>")), "");
    EXPECT_NE(refusal(texture("rawconstant")), "");
}

TEST_F(Textures, VolumesAreLookedUpByPosition) {
    write_bytes(*folder / "two.vol",
                vol_bytes({.resolution = {2, 1, 1}, .channels = 3},
                          std::vector<float>{0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f}));
    const Texture& t = make(texture(
        "volume", "<volume type='gridvolume' name='volume'>" + word("filename", "two.vol") +
                      nearest + "<transform name='to_world'><scale x='4'/></transform></volume>"));
    Interaction at;
    at.uv = {0.9f, 0.9f};
    at.p = {1, 0.5f, 0.5f};
    EXPECT_EQ(t.color_at(at), Color(0.1f, 0.2f, 0.3f));
    at.p.x = 3;
    EXPECT_EQ(t.color_at(at), Color(0.4f, 0.5f, 0.6f));
    EXPECT_EQ(t.real_at(at), luminance({0.4f, 0.5f, 0.6f}));
    EXPECT_FLOAT_EQ(t.max(), 0.6f);
    EXPECT_EQ(t.attribute(), "position");
    const Texture& constant = make(texture("volume", "<rgb name='volume' value='1, 2, 3'/>"));
    EXPECT_EQ(constant.color_at(at), Color(1, 2, 3));
    EXPECT_EQ(constant.attribute(), "");
}

TEST_F(Textures, PicturesHaveTheirAspect) {
    EXPECT_EQ(make(texture("checkerboard")).aspect(), 1);
    const Texture& noise = make(bitmap("noise.exr"));
    EXPECT_EQ(noise.aspect(), 5 / 3.0f);
}

TEST_F(Textures, MeanIsTheAverageOverTheUnitSquare) {
    for (const std::string& xml :
         {texture("checkerboard"), bitmap("noise.exr"), bitmap("corners.png"),
          bitmap("corners.png", word("wrap_mode", "mirror") + nearest)}) {
        EXPECT_TRUE(holds(contracts::texture_mean(make(xml), {}))) << xml;
    }
}

TEST_F(Textures, GradientsAreThoseOfTheValues) {
    for (const std::string& xml : all()) {
        EXPECT_TRUE(holds(contracts::texture_gradient(make(xml), {}))) << xml;
    }
}

TEST_F(Textures, HugeAndUndefinedCoordinatesDoNoHarm) {
    for (const std::string& xml : all()) {
        EXPECT_TRUE(holds(contracts::texture_extreme_coordinates(make(xml)))) << xml;
    }
}

TEST_F(Textures, PicturesStandUpright) {
    const Texture& t = make(bitmap("corners.png", nearest));
    EXPECT_EQ(t.color({0.25f, 0.75f}), Color(1, 0, 0));
    EXPECT_EQ(t.color({0.75f, 0.75f}), Color(0, 1, 0));
    EXPECT_EQ(t.color({0.25f, 0.25f}), Color(0, 0, 1));
    EXPECT_EQ(t.color({0.75f, 0.25f}), Color(1, 1, 1));
    EXPECT_EQ(t.color({1.25f, -0.25f}), Color(1, 0, 0));
}

TEST_F(Textures, WrapModes) {
    const auto at = [&](const char* mode, Vector2 uv) {
        return make(bitmap("corners.png", nearest + word("wrap_mode", mode))).color(uv);
    };
    EXPECT_EQ(at("repeat", {1.25f, 0.75f}), Color(1, 0, 0));
    EXPECT_EQ(at("mirror", {1.25f, 0.75f}), Color(0, 1, 0));
    EXPECT_EQ(at("mirror", {-0.25f, 0.75f}), Color(1, 0, 0));
    EXPECT_EQ(at("clamp", {1.25f, 0.75f}), Color(0, 1, 0));
    EXPECT_EQ(at("clamp", {-7, 0.75f}), Color(1, 0, 0));
    // Bilinear at the edge u = 0: repeat mixes both columns, the others do not.
    const auto edge = [&](const char* mode) {
        return make(bitmap("corners.png", word("wrap_mode", mode))).color({0, 0.75f});
    };
    EXPECT_EQ(edge("repeat"), Color(0.5f, 0.5f, 0));
    EXPECT_EQ(edge("mirror"), Color(1, 0, 0));
    EXPECT_EQ(edge("clamp"), Color(1, 0, 0));
}

TEST_F(Textures, TransformsMeanWhatTheyMeanInMitsuba) {
    // Mitsuba's v counts downwards: (0.25, 0.25) is the red texel.
    const auto at = [&](const std::string& steps) {
        return make(bitmap("corners.png", nearest + to_uv(steps))).color({0.25f, 0.75f});
    };
    EXPECT_EQ(at("<translate x='0.5'/>"), Color(0, 1, 0));
    EXPECT_EQ(at("<translate y='0.5'/>"), Color(0, 0, 1));
    EXPECT_EQ(at("<matrix value='1 0 0.5  0 1 0  0 0 1'/>"), Color(0, 1, 0));
    EXPECT_EQ(at("<scale x='3'/>"), Color(0, 1, 0));
    EXPECT_EQ(at("<scale value='3'/>"), Color(1, 1, 1));
}

TEST_F(Textures, ColoursAreDecodedAndRawDataAreNot) {
    const float encoded = 128.0f / 255;
    EXPECT_NEAR(make(bitmap("grey.png")).color({0, 0}).x, srgb_to_linear(encoded), 1e-6f);
    EXPECT_EQ(make(bitmap("grey.png", raw)).color({0, 0}).x, encoded);
    EXPECT_EQ(make(bitmap("grey.png", number("gamma", 1))).color({0, 0}).x, encoded);
    EXPECT_NEAR(make(bitmap("grey.png", number("gamma", 2.2))).color({0, 0}).x,
                std::pow(encoded, 2.2f), 1e-6f);
    EXPECT_NE(refusal(bitmap("grey.png", number("gamma", 0)), folder->path()), "");
    // One number of three is their luminance, also if they are raw.
    EXPECT_NEAR(make(bitmap("corners.png", nearest)).real({0.75f, 0.75f}), 0.715169f, 1e-6f);
    EXPECT_NEAR(make(bitmap("corners.png", nearest + raw)).real({0.75f, 0.75f}), 0.715169f, 1e-6f);
}

TEST_F(Textures, PicturesMeanWhatTheirFilesSay) {
    // Grey 128, with a chunk gAMA of 1: linear.
    write_file_atomically(
        *folder / "linear.png",
        text_of_hex("89504e470d0a1a0a0000000d49484452000000010000000108000000003a7e9b"
                    "550000000467414d41000186a031e8965f0000000a4944415478da6368000000"
                    "820081da45083b0000000049454e44ae426082"));
    EXPECT_EQ(make(bitmap("linear.png")).color({0, 0}), Color(128.0f / 255));
    // Red of Display P3, linear: outside of Rec.709. As numbers it stays as it is.
    write_file_atomically(
        *folder / "p3.png",
        text_of_hex(
            "89504e470d0a1a0a0000000d4948445200000001000000010802000000907753de0000000467414d"
            "41000186a031e8965f000000206348524d00007a2600008084000109a000007d000000678400010d"
            "8800003a9800001770f1f8ca570000000c4944415478da63f8cfc0000003010100f7034143000000"
            "0049454e44ae426082"));
    const Color red = make(bitmap("p3.png")).color({0, 0});
    EXPECT_NEAR(red.x, 1.2249f, 1e-4f);
    EXPECT_NEAR(red.y, -0.0420f, 1e-4f);
    EXPECT_NEAR(red.z, -0.0197f, 1e-4f);
    EXPECT_EQ(make(bitmap("p3.png", raw)).color({0, 0}), Color(1, 0, 0));
}

TEST_F(Textures, WhatIsNotFollowedOfAFileIsTold) {
    write_file_atomically(*folder / "exposed.hdr",
                          std::string("#?RGBE\nEXPOSURE=2\n\n-Y 1 +X 1\n\x03\x02\x01\x88", 34));
    make(bitmap("exposed.hdr"));
    EXPECT_NE(workshop_.warnings().find("exposed.hdr: its values were multiplied by an EXPOSURE "
                                        "of 2"),
              std::string::npos)
        << workshop_.warnings();
}

TEST_F(Textures, OneChannelOfAPicture) {
    write_png(*folder / "leaf.png",
              {.width = 1, .height = 1, .channel_count = 4, .pixels = {255, 128, 0, 64}});
    const auto value = [&](const char* channel, const std::string& more = "") {
        const Texture& t = make(bitmap("leaf.png", word("channel", channel) + more));
        EXPECT_EQ(t.color({0, 0}), Color(t.real({0, 0})));
        return t.real({0, 0});
    };
    EXPECT_EQ(value("r"), 1);
    EXPECT_NEAR(value("g"), srgb_to_linear(128.0f / 255), 1e-6f);
    EXPECT_EQ(value("G", raw), 128.0f / 255);
    EXPECT_EQ(value("b"), 0);
    EXPECT_EQ(value("a"), 64.0f / 255);  // never encoded
    EXPECT_NE(refusal(bitmap("leaf.png", word("channel", "z")), folder->path())
                  .find("has no channel \"z\"; there are: R, G, B, A"),
              std::string::npos);
    Image depth(1, 1, {"Y"});
    depth.pixels = {0.25f};
    ImageFile file;
    add_layer(file, depth);
    write_exr(*folder / "depth.exr", file);
    EXPECT_EQ(make(bitmap("depth.exr", word("channel", "g"))).real({0, 0}), 0.25f);
}

TEST_F(Textures, EveryTexelIsInItsPlace) {
    for (const int width : {1, 3, 4, 9, 17}) {
        for (const int height : {1, 2, 8, 11}) {
            for (const bool bytes : {false, true}) {
                Image image(width, height);
                Image8 image8{.width = width, .height = height};
                Rng rng(4);
                for (float& v : image.pixels) {
                    const auto byte = static_cast<std::uint8_t>(256 * rng.next_float());
                    image8.pixels.push_back(byte);
                    v = static_cast<float>(byte) / 255;
                }
                ImageFile file;
                add_layer(file, image);
                if (bytes) write_png(*folder / "texels", image8);
                if (!bytes) write_exr(*folder / "texels", file);
                const Texture& color = make(bitmap("texels", raw + nearest));
                const Texture& green = make(bitmap("texels", raw + nearest + word("channel", "g")));
                for (int y = 0; y < height; ++y) {
                    for (int x = 0; x < width; ++x) {
                        const Vector2 uv(
                            (static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                            1 - (static_cast<float>(y) + 0.5f) / static_cast<float>(height));
                        ASSERT_EQ(color.color(uv), image.rgb(x, y)) << width << " x " << height;
                        ASSERT_EQ(green.real(uv), image.rgb(x, y).y) << width << " x " << height;
                    }
                }
            }
        }
    }
}

TEST_F(Textures, C15_PixelsThatAreNotFiniteAreTold) {
    const Texture& t = make(bitmap("broken.exr", nearest));
    EXPECT_NE(workshop_.warnings().find("1 pixels are not finite"), std::string::npos);
    EXPECT_EQ(t.color({0.25f, 0.5f}), Color(0));
    EXPECT_EQ(t.mean(), Color(1.5f));
}

TEST_F(Textures, WrongParametersAreRefused) {
    EXPECT_NE(refusal(texture("bitmap"), folder->path()), "");
    EXPECT_NE(refusal(bitmap("nowhere.png"), folder->path()).find("nowhere.png"),
              std::string::npos);
    EXPECT_NE(refusal(bitmap("grey.png", word("wrap_mode", "miror")), folder->path())
                  .find("did you mean \"mirror\""),
              std::string::npos);
}

TEST_F(Textures, CheckerboardHasTwoByTwoSquares) {
    const Texture& t = make(texture("checkerboard"));
    EXPECT_EQ(t.color({0.25f, 0.75f}), Color(0.4f));
    EXPECT_EQ(t.color({0.75f, 0.75f}), Color(0.2f));
    EXPECT_EQ(t.color({0.75f, 0.25f}), Color(0.4f));
    EXPECT_EQ(t.color({0.25f, 0.25f}), Color(0.2f));
    EXPECT_FLOAT_EQ(t.mean().x, 0.3f);
    const Texture& nested = make(texture(
        "checkerboard", "<texture name='color0' type='bitmap'>" + word("filename", "corners.png") +
                            nearest + "</texture>" + number("color1", 0.1)));
    EXPECT_EQ(nested.color({0.25f, 0.75f}), Color(1, 0, 0));
    EXPECT_FLOAT_EQ(nested.real({0.25f, 0.25f}), 0.1f);
}

}  // namespace
}  // namespace lucerna
