// SPDX-License-Identifier: Apache-2.0
#include "core/image/color.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "core/base/error.h"
#include "core/image/builtin_ocio.h"
#include "tests/paths.h"

namespace lucerna {
namespace {

void expect_color(Color actual, Color expected, float tolerance = 2e-5f) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(actual[c], expected[c], tolerance) << "channel " << c;
}

/// The environment as a test needs it; restored afterwards.
class Environment {
public:
    explicit Environment(const char* ocio) {
        if (const char* old = std::getenv("OCIO")) old_ = old;
        ocio ? setenv("OCIO", ocio, 1) : unsetenv("OCIO");
    }
    ~Environment() { old_.empty() ? unsetenv("OCIO") : setenv("OCIO", old_.c_str(), 1); }

private:
    std::string old_;
};

std::string error_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    ADD_FAILURE() << "no Error was thrown";
    return "";
}

TEST(Srgb, CurveIsTheStandardsOne) {
    EXPECT_NEAR(srgb_to_linear(0.5f), 0.21404114f, 1e-7);
    EXPECT_NEAR(linear_to_srgb(0.18f), 0.46135613f, 1e-6);
    EXPECT_NEAR(srgb_to_linear(0.04045f), 0.04045f / 12.92f, 1e-9);
    EXPECT_EQ(srgb_to_linear(1.0f), 1.0f);
    EXPECT_EQ(linear_to_srgb(0.0f), 0.0f);
    EXPECT_EQ(linear_to_srgb(-0.5f), -linear_to_srgb(0.5f));
    for (int i = 0; i <= 1000; ++i) {
        const float v = static_cast<float>(i) / 1000;
        EXPECT_NEAR(linear_to_srgb(srgb_to_linear(v)), v, 2e-6) << v;
    }
    // Every byte survives being decoded and shown again.
    const ColorConfig config;
    Image bytes(256, 1);
    for (int i = 0; i < 256; ++i) bytes.set_rgb(i, 0, Color(static_cast<float>(i) / 255));
    bytes.srgb_encoded = true;
    config.to_rendering(bytes);
    EXPECT_FALSE(bytes.srgb_encoded);
    const Image8 shown = config.display(bytes);
    for (std::size_t i = 0; i < 256; ++i) EXPECT_EQ(shown.pixels[3 * i], i);
}

TEST(Chromaticities, MatrixAgreesWithPublishedOnes) {
    const Matrix3d same = rec709_from(Chromaticities::rec709());
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(same[i][i], 1, 1e-12);
    // ACES AP1 primaries and white; the same numbers as OpenColorIO's ACEScg below.
    const Chromaticities ap1{{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}};
    expect_color(Color(rec709_from(ap1)[0]), {1.705051f, -0.130256f, -0.024003f}, 1e-4f);
    expect_color(Color(rec709_from(ap1) * Vector3d(1)), Color(1), 1e-6f);
    Chromaticities flat = ap1;
    flat.blue = (flat.red + flat.green) * 0.5;
    EXPECT_THROW(rec709_from(flat), Error);
}

TEST(ColorConfig, ConvertsToTheRenderingSpace) {
    const Environment none(nullptr);
    const ColorConfig config = ColorConfig::choose();
    EXPECT_EQ(config.source(), "built-in");
    EXPECT_EQ(config.rendering_space(), "Linear Rec.709 (sRGB)");
    expect_color(config.to_rendering(Color(1, 0, 0), "ACEScg"),
                 {1.705051f, -0.130256f, -0.024003f});
    expect_color(config.to_rendering(Color(1, 0, 0), "lin_ap1"),
                 {1.705051f, -0.130256f, -0.024003f});
    expect_color(config.to_rendering(Color(0.5f), "sRGB"), Color(0.214041f));
    expect_color(config.to_rendering(Color(0.5f), "g22_rec709"), Color(std::pow(0.5f, 2.2f)));
    EXPECT_EQ(config.to_rendering(Color(2, -1, 0.5f), "raw"), Color(2, -1, 0.5f));
    EXPECT_EQ(config.to_rendering(Color(2, -1, 0.5f), "lin_rec709"), Color(2, -1, 0.5f));
}

TEST(ColorConfig, OwnCurveAgreesWithOpenColorIO) {
    // A copy of the built-in as the user's file goes through OpenColorIO for everything.
    const Environment none(nullptr);
    const TemporaryFolder folder;
    std::ofstream(folder / "copy.ocio") << builtin_ocio;
    const ColorConfig own;
    const ColorConfig user = ColorConfig::choose((folder / "copy.ocio").string());
    EXPECT_EQ(user.source(), (folder / "copy.ocio").string());
    EXPECT_EQ(user.rendering_space(), "Linear Rec.709 (sRGB)");
    for (const float v : {0.0f, 0.003f, 0.04f, 0.2f, 0.7f, 1.0f}) {
        expect_color(own.to_rendering(Color(v), "sRGB"), user.to_rendering(Color(v), "sRGB"));
    }
    Image ramp(64, 1);
    for (int x = 0; x < 64; ++x) ramp.set_rgb(x, 0, Color(static_cast<float>(x) / 50, 0.3f, 0.01f));
    const Image8 a = own.display(ramp), b = user.display(ramp);
    for (std::size_t i = 0; i < a.pixels.size(); ++i) EXPECT_NEAR(a.pixels[i], b.pixels[i], 1) << i;
}

TEST(ColorConfig, ViewsHaveTheKnownValues) {
    const ColorConfig config;
    Image grey(1, 1);
    grey.set_rgb(0, 0, Color(0.18f));
    EXPECT_EQ(config.display(grey).pixels[0], 118);  // 0.461356 · 255 = 117.6
    EXPECT_EQ(config.display(grey, "sRGB - Display/ACES 1.0 - SDR Video").pixels[0], 91);  // 0.3560
    EXPECT_EQ(config.display(grey, "ACES 1.0 - SDR Video").pixels[1], 91);
    EXPECT_EQ(config.display(grey, "Raw").pixels[0], 46);
    EXPECT_EQ(config.display(grey, "", 2).pixels[0], 221);  // 0.72 -> 0.8672
    grey.set_rgb(0, 0, Color(16));
    EXPECT_EQ(config.display(grey, "ACES 1.0 - SDR Video").pixels[2], 255);
}

TEST(ColorConfig, DisplayClampsAndCountsWhatIsNotFinite) {
    const ColorConfig config;
    const float inf = std::numeric_limits<float>::infinity();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    Image image(4, 1, {"R", "G", "B", "A"});
    image.pixels = {nan, inf, -inf, 0.5f, 7, -7, 0.5f, 2, 0, 0, nan, nan, 1e30f, 1, 0, 1};
    for (const char* view : {"", "ACES 1.0 - SDR Video", "Raw"}) {
        const Image8 shown = config.display(image, view);
        ASSERT_EQ(shown.channel_count, 4);
        EXPECT_EQ(shown.non_finite, 2u) << view;
        EXPECT_EQ(shown.pixels[3], 128) << view;
        EXPECT_EQ(shown.pixels[7], 255) << view;
    }
    // The NaN in blue stays there, though the view mixes channels.
    image.pixels[8] = 0.5f;
    EXPECT_GT(config.display(image, "ACES 1.0 - SDR Video").pixels[8], 50);
    const Image8 shown = config.display(image);
    EXPECT_EQ(shown.pixels[0], 0);
    EXPECT_EQ(shown.pixels[1], 255);
    EXPECT_EQ(shown.pixels[2], 0);
    EXPECT_EQ(shown.pixels[4], 255);
    EXPECT_EQ(shown.pixels[5], 0);
}

TEST(ColorConfig, GreyAndAlphaStayWhatTheyAre) {
    const ColorConfig config;
    Image grey(1, 1, {"Y", "A"});
    grey.pixels = {0.5f, 0.5f};
    grey.srgb_encoded = true;
    Image through_ocio = grey;
    config.to_rendering(grey);
    config.to_rendering(through_ocio, "Gamma 2.2 Rec.709 - Texture");
    EXPECT_NEAR(grey.pixels[0], 0.214041f, 1e-6);
    EXPECT_EQ(grey.pixels[1], 0.5f);
    EXPECT_NEAR(through_ocio.pixels[0], std::pow(0.5f, 2.2f), 1e-5);
    EXPECT_EQ(through_ocio.pixels[1], 0.5f);
    EXPECT_EQ(config.display(grey).channel_count, 4);
}

TEST(ColorConfig, AutoFollowsTheChromaticitiesOfTheFile) {
    const ColorConfig config;
    Image image(1, 1);
    image.set_rgb(0, 0, {1, 0, 0});
    image.chromaticities =
        Chromaticities{{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}};
    config.to_rendering(image);
    expect_color(image.rgb(0, 0), {1.705051f, -0.130256f, -0.024003f}, 1e-4f);
    EXPECT_FALSE(image.chromaticities);
}

TEST(ColorConfig, ChoiceFollowsTheOrder) {
    const TemporaryFolder folder;
    for (const char* name : {"cli.ocio", "env.ocio", "scene.ocio"}) {
        std::ofstream(folder / name) << builtin_ocio;
    }
    const std::string cli = (folder / "cli.ocio").string(), env = (folder / "env.ocio").string();
    const std::string scene = (folder / "scene.ocio").string();
    {
        const Environment set(env.c_str());
        EXPECT_EQ(ColorConfig::choose(cli, scene).source(), cli);
        EXPECT_EQ(ColorConfig::choose("", scene).source(), env);
        EXPECT_EQ(ColorConfig::choose("builtin", scene).source(), "built-in");
        EXPECT_EQ(ColorConfig::choose("none", scene).source(), "none");
    }
    const Environment empty("");
    EXPECT_EQ(ColorConfig::choose("", scene).source(), scene);
    EXPECT_EQ(ColorConfig::choose("", "").source(), "built-in");
    EXPECT_TRUE(ColorConfig::choose("", "").notice().empty());
    const Environment uri("ocio://default");
    const ColorConfig mapped = ColorConfig::choose("", scene);
    EXPECT_EQ(mapped.source(), "built-in");
    EXPECT_NE(mapped.notice().find("ocio://default"), std::string::npos);
}

TEST(ColorConfig, WithoutAConfigurationThereIsSrgbOnly) {
    const ColorConfig config = ColorConfig::choose("none");
    EXPECT_EQ(config.spaces().size(), 3u);
    EXPECT_EQ(config.views().front(), "sRGB - Display/Un-tone-mapped");
    expect_color(config.to_rendering(Color(0.5f), "sRGB"), Color(0.214041f));
    EXPECT_THROW(config.to_rendering(Color(1), "ACEScg"), Error);
    EXPECT_THROW(config.display(Image(1, 1), "ACES 1.0 - SDR Video"), Error);
    EXPECT_NO_THROW(config.display(Image(1, 1)));
}

TEST(ColorConfig, ErrorsListWhatThereIs) {
    const ColorConfig config;
    const std::string space = error_of([&] { config.to_rendering(Color(1), "ACESgc"); });
    EXPECT_NE(space.find("did you mean \"ACEScg\""), std::string::npos) << space;
    EXPECT_NE(space.find("sRGB - Texture"), std::string::npos) << space;
    const std::string view = error_of([&] { config.display(Image(1, 1), "ACES 1.0 - SDR Vide"); });
    EXPECT_NE(view.find("sRGB - Display/ACES 1.0 - SDR Video"), std::string::npos) << view;

    const TemporaryFolder folder;
    std::ofstream(folder / "new.ocio") << "ocio_profile_version: 2.4\nroles: {default: a}\n";
    for (const char* name : {"new.ocio", "missing.ocio"}) {
        const std::string path = (folder / name).string();
        const std::string message = error_of([&] { ColorConfig::choose(path); });
        EXPECT_NE(message.find(path), std::string::npos) << message;
        EXPECT_NE(message.find("builtin"), std::string::npos) << message;
    }
}

TEST(ColorConfig, L13_TheDecimalCommaOfALocaleDoesNotMatter) {
    const TemporaryFolder folder;
    std::ofstream(folder / "own.ocio") << builtin_ocio;
    const std::string before = std::setlocale(LC_ALL, nullptr);
    bool found = false;
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "fr_FR"}) {
        found = found || std::setlocale(LC_ALL, name);
    }
    const ColorConfig config = ColorConfig::choose((folder / "own.ocio").string());
    const Color acescg = config.to_rendering(Color(1, 0.5f, 0.25f), "ACEScg");
    const Image8 shown = config.display(Image(1, 1), config.views().front());
    std::setlocale(LC_ALL, before.c_str());
    expect_color(acescg, ColorConfig().to_rendering(Color(1, 0.5f, 0.25f), "ACEScg"));
    EXPECT_GT(acescg.x, 1.2f);  // which it would not be if fractions were cut off
    EXPECT_EQ(shown.pixels[0], 0);
    if (!found) GTEST_SKIP() << "no locale with a decimal comma is installed: C was tested";
}

/// OpenColorIO takes them as zero.
TEST(ColorConfig, L14_TablesThatHoldNanAreShownAsBlack) {
    const TemporaryFolder folder;
    std::ofstream(folder / "broken.spi1d")
        << "Version 1\nFrom 0.0 1.0\nLength 3\nComponents 1\n{\n0.25\nnan\nnan\n}\n";
    std::ofstream(folder / "broken.ocio")
        << "ocio_profile_version: 2\nsearch_path: .\nroles:\n  default: linear\n"
           "  scene_linear: linear\n  rendering: linear\nfile_rules:\n"
           "  - !<Rule> {name: Default, colorspace: linear}\n"
           "displays:\n  screen:\n    - !<View> {name: table, colorspace: shown}\n"
           "colorspaces:\n  - !<ColorSpace>\n    name: linear\n    bitdepth: 32f\n"
           "  - !<ColorSpace>\n    name: shown\n    bitdepth: 32f\n"
           "    from_scene_reference: !<FileTransform> {src: broken.spi1d, "
           "interpolation: linear}\n";
    const ColorConfig config = ColorConfig::choose((folder / "broken.ocio").string());
    Image image(2, 1);
    image.set_rgb(0, 0, Color(0));
    image.set_rgb(1, 0, Color(0.8f));
    const Image8 shown = config.display(image, "screen/table");
    EXPECT_EQ(shown.pixels[0], 64);
    EXPECT_EQ(shown.pixels[3], 0);
}

TEST(ColorConfig, UserConfigurationNamesTheRenderingSpace) {
    const TemporaryFolder folder;
    std::string text = builtin_ocio;
    const std::string role = "  rendering: Linear Rec.709 (sRGB)";
    text.replace(text.find(role), role.size(), "  rendering: ACEScg");
    std::ofstream(folder / "acescg.ocio") << text;
    const ColorConfig config = ColorConfig::choose((folder / "acescg.ocio").string());
    EXPECT_EQ(config.rendering_space(), "ACEScg");
    // Automatic input is Rec.709 and comes out as ACEScg; there and back is the identity.
    const Color acescg = config.to_rendering(Color(1, 0, 0), "auto");
    expect_color(ColorConfig().to_rendering(acescg, "ACEScg"), {1, 0, 0});
    EXPECT_GT(acescg.y, 0.01f);
    // The view starts from the rendering space.
    Image image(1, 1);
    image.set_rgb(0, 0, acescg);
    const Image8 shown = config.display(image, "sRGB - Display/Un-tone-mapped");
    EXPECT_EQ(shown.pixels[0], 255);
    EXPECT_LE(shown.pixels[1], 1);
}

}  // namespace
}  // namespace lucerna
