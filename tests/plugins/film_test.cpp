// SPDX-License-Identifier: Apache-2.0
/// What every film must satisfy, and what hdrfilm writes.
#include "core/interfaces/film.h"
#include "core/image/color.h"
#include "core/image/exr.h"
#include "core/image/png.h"
#include "core/image/read_image.h"
#include "tests/plugins/workshop.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

std::string film(const std::string& type, const std::string& body = "") {
    return fmt::format("<film type='{}'>{}</film>", type, body);
}

/// Two pixels with alpha, a layer and metadata.
ImageFile picture() {
    const auto plane = [](const char* name, float left, float right) {
        return Plane{.name = name, .samples = std::vector<float>{left, right}};
    };
    return {.width = 2,
            .height = 1,
            .planes = {plane("R", 0.1f, 2), plane("G", 0.2f, 0), plane("B", 0.3f, 1e6f),
                       plane("A", 1, 0.25f), plane("albedo.R", 0.5f, 0.7f)},
            .metadata = {{"lucerna:note", std::string("hello")}}};
}

std::vector<float> values(const ImageFile& file, std::string_view name) {
    const Plane* plane = file.plane(name);
    return plane ? std::get<std::vector<float>>(plane->samples) : std::vector<float>();
}

class Films : public testing::Test {
protected:
    /// What a film makes of the picture.
    ImageFile written(const std::string& body) {
        const auto path = folder_ / "image.exr";
        workshop_.make<Film>(film("hdrfilm", body)).write(picture(), path);
        return read_exr(path);
    }

    Workshop workshop_;
    TemporaryFolder folder_;
};

TEST_F(Films, DefaultsAreThoseOfMitsuba) {
    for (const std::string& name : workshop_.registry().names("film")) {
        SCOPED_TRACE(name);
        const Film& f = workshop_.make<Film>(film(name));
        EXPECT_EQ(f.size(), Vector2i(768, 576));
        EXPECT_EQ(f.crop(), (CropWindow{.offset = {0, 0}, .size = {768, 576}}));
        EXPECT_EQ(f.rfilter().radius(), 2);
        EXPECT_TRUE(std::string(f.extension()) == ".exr" || std::string(f.extension()) == ".png");
    }
}

TEST_F(Films, WriteAndReplaceTheirFile) {
    for (const std::string& name : workshop_.registry().names("film")) {
        SCOPED_TRACE(name);
        const Film& f = workshop_.make<Film>(film(name));
        const auto path = folder_ / (name + f.extension());
        f.write(picture(), path);
        f.write(picture(), path);
        EXPECT_GT(std::filesystem::file_size(path), 0u);
        EXPECT_THROW(f.write(picture(), folder_ / "missing" / "a.exr"), FileError);
    }
}

TEST_F(Films, H9_CropIsPartOfTheImage) {
    const std::string window = whole("width", 100) + whole("height", 50) +
                               whole("crop_offset_x", 10) + whole("crop_offset_y", 20) +
                               whole("crop_width", 30) + whole("crop_height", 30);
    const Film& f = workshop_.make<Film>(film("hdrfilm", window));
    EXPECT_EQ(f.size(), Vector2i(100, 50));
    EXPECT_EQ(f.crop(), (CropWindow{.offset = {10, 20}, .size = {30, 30}}));
    const auto refused = [](const std::string& body) {
        return refusal(film("hdrfilm", whole("width", 100) + body));
    };
    EXPECT_NE(refused(whole("crop_offset_x", 1)).find("does not fit"), std::string::npos);
    EXPECT_NE(refused(whole("crop_width", 101)), "");
    EXPECT_NE(refused(whole("crop_offset_x", -1) + whole("crop_width", 5)), "");
    EXPECT_NE(refused(whole("crop_width", 0)), "");
    EXPECT_NE(refusal(film("hdrfilm", whole("width", 0))), "");
    EXPECT_NE(refusal(film("hdrfilm", whole("height", 100000))), "");
}

TEST_F(Films, PixelFormatsChooseChannels) {
    const std::string exact = word("component_format", "float32");
    const ImageFile rgb = written(exact);
    EXPECT_EQ(values(rgb, "R"), (std::vector<float>{0.1f, 2}));
    EXPECT_EQ(values(rgb, "B"), (std::vector<float>{0.3f, 1e6f}));
    EXPECT_FALSE(rgb.plane("A"));
    EXPECT_EQ(values(rgb, "albedo.R"), (std::vector<float>{0.5f, 0.7f}));
    EXPECT_EQ(std::get<std::string>(rgb.metadata.at("lucerna:note")), "hello");

    const ImageFile rgba = written(exact + word("pixel_format", "rgba"));
    EXPECT_EQ(values(rgba, "A"), (std::vector<float>{1, 0.25f}));

    const ImageFile grey = written(exact + word("pixel_format", "luminance_alpha"));
    EXPECT_FALSE(grey.plane("R"));
    EXPECT_EQ(values(grey, "Y").at(0), luminance(Color(0.1f, 0.2f, 0.3f)));
    EXPECT_EQ(values(grey, "A"), (std::vector<float>{1, 0.25f}));
    EXPECT_TRUE(grey.plane("albedo.R"));
    EXPECT_FALSE(written(word("pixel_format", "luminance")).plane("A"));
    EXPECT_NE(refusal(film("hdrfilm", word("pixel_format", "rgbb"))).find("did you mean"),
              std::string::npos);
}

TEST_F(Films, H8_HalfPrecisionIsFiniteAndFloatExact) {
    const ImageFile half = written("");
    EXPECT_EQ(values(half, "B").at(1), 65504);
    EXPECT_NEAR(values(half, "R").at(0), 0.1f, 1e-4f);
    EXPECT_NE(values(half, "R").at(0), 0.1f);
    EXPECT_EQ(values(written(word("component_format", "float32")), "B").at(1), 1e6f);
}

TEST_F(Films, LayersThatAreNoColoursKeep32Bits) {
    const auto half = [&](const std::string& body, const char* name) {
        ImageFile image = picture();
        image.planes.push_back({.name = "depth", .samples = std::vector<float>{0.1f, 1e6f}});
        image.planes.push_back({.name = "nn.X", .samples = std::vector<float>{0.1f, 0}});
        const auto path = folder_ / "layers.exr";
        workshop_.make<Film>(film("hdrfilm", body)).write(image, path);
        return read_exr(path).plane(name)->half;
    };
    EXPECT_TRUE(half("", "R"));
    EXPECT_TRUE(half("", "albedo.R"));
    EXPECT_FALSE(half("", "depth"));
    EXPECT_FALSE(half("", "nn.X"));
    EXPECT_TRUE(half(word("component_format", "float16"), "depth"));
    EXPECT_FALSE(half(word("component_format", "float32"), "R"));
}

/// As Mitsuba 3 does; the white of Rec.709 has the XYZ of D65.
TEST_F(Films, XyzIsThatOfRec709) {
    const ImageFile xyz =
        written(word("pixel_format", "xyz") + word("component_format", "float32"));
    EXPECT_FALSE(xyz.plane("R"));
    EXPECT_FALSE(xyz.plane("A"));
    EXPECT_NEAR(values(xyz, "X").at(1), 2 * 0.412391 + 1e6 * 0.180481, 1);
    EXPECT_NEAR(values(xyz, "Y").at(0), luminance(Color(0.1f, 0.2f, 0.3f)), 1e-7);
    EXPECT_NEAR(values(xyz, "Z").at(0), 0.1 * 0.019331 + 0.2 * 0.119195 + 0.3 * 0.950532, 1e-6);
    const ImageFile xyza = written(word("pixel_format", "xyza"));
    EXPECT_EQ(values(xyza, "A"), (std::vector<float>{1, 0.25f}));
    EXPECT_TRUE(xyza.plane("X")->half);
    // Read again, it is the picture.
    Image image = to_image(xyz);
    ColorConfig().to_rendering(image);
    EXPECT_NEAR(image.rgb(0, 0).x, 0.1f, 1e-6f);
    EXPECT_NEAR(image.rgb(0, 0).z, 0.3f, 1e-6f);
}

TEST_F(Films, PfmHoldsTheColourIn32Bits) {
    const auto pfm = [&](const std::string& body) {
        const Film& f = workshop_.make<Film>(film("hdrfilm", word("file_format", "pfm") + body));
        EXPECT_STREQ(f.extension(), ".pfm");
        f.write(picture(), folder_ / "a.pfm");
        return read_image(folder_ / "a.pfm");
    };
    EXPECT_EQ(pfm("").pixels, (std::vector<float>{0.1f, 0.2f, 0.3f, 2, 0, 1e6f}));
    EXPECT_EQ(workshop_.warnings(), "");
    EXPECT_EQ(pfm(word("pixel_format", "luminance")).pixels.at(0),
              luminance(Color(0.1f, 0.2f, 0.3f)));
    EXPECT_EQ(pfm(word("pixel_format", "xyza") + word("component_format", "float16")).pixels.at(5),
              1e6f);
    for (const char* words : {"have 32 bits", "has no alpha", "only OpenEXR files"}) {
        EXPECT_NE(workshop_.warnings().find(words), std::string::npos) << workshop_.warnings();
    }
}

TEST_F(Films, FormatsThatAreNotThereAreErrorsThatTellWhatIs) {
    EXPECT_NE(refusal(film("hdrfilm", word("file_format", "rgbe")))
                  .find("it can be: openexr, exr, png, pfm"),
              std::string::npos);
    EXPECT_NE(refusal(film("hdrfilm", word("component_format", "uint32")))
                  .find("it can be: float16, float32"),
              std::string::npos);
    EXPECT_NE(
        refusal(film("hdrfilm", word("pixel_format", "multichannel"))).find("rgba, xyz, xyza"),
        std::string::npos);
}

TEST_F(Films, LdrfilmWritesAnEncodedPNG) {
    const Film& f =
        workshop_.make<Film>(film("ldrfilm", word("pixel_format", "rgba") + number("exposure", 1)));
    EXPECT_NE(workshop_.warnings().find("\"exposure\" has no effect"), std::string::npos);
    EXPECT_STREQ(f.extension(), ".png");
    f.write(picture(), folder_ / "a.png");
    const Image png = read_png(folder_ / "a.png");
    ASSERT_EQ(png.channels.size(), 4u);
    EXPECT_NEAR(png.at(0, 0)[0], linear_to_srgb(0.1f), 0.5f / 255);
    EXPECT_EQ(png.at(1, 0)[0], 1);
    EXPECT_EQ(png.at(1, 0)[1], 0);
    EXPECT_NEAR(png.at(1, 0)[3], 0.25f, 0.5f / 255);

    workshop_.make<Film>(film("ldrfilm")).write(picture(), folder_ / "b.png");
    EXPECT_EQ(read_png(folder_ / "b.png").channels.size(), 3u);
    EXPECT_STREQ(workshop_.make<Film>(film("ldrfilm", word("file_format", "exr"))).extension(),
                 ".exr");
}

}  // namespace
}  // namespace lucerna
