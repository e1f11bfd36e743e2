// SPDX-License-Identifier: Apache-2.0
/// The smaller commands as users run them: plugins, diff, tonemap, info.
#include "core/image/exr.h"
#include "core/image/png.h"
#include "core/interfaces/command.h"
#include "tests/commands/process.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

namespace fs = std::filesystem;

class ToolsTest : public testing::Test {
protected:
    std::string run(const std::vector<std::string>& words, int expected = exit_code::success) {
        Process process(folder.path(), words);
        EXPECT_EQ(process.wait(), expected) << process.errors();
        errors = process.errors();
        return process.output();
    }
    static void expect_words(const std::string& text, const std::vector<std::string>& words) {
        for (const std::string& word : words) {
            EXPECT_NE(text.find(word), std::string::npos) << "\"" << word << "\" in:\n" << text;
        }
    }
    void write_picture(const char* name, float value, float corner) const {
        Image image(4, 3);
        for (float& x : image.pixels) x = value;
        image.set_rgb(0, 0, Color(corner));
        ImageFile file;
        add_layer(file, image);
        file.metadata["artist"] = std::string("nobody");
        write_exr(folder / name, file);
    }

    TemporaryFolder folder;
    std::string errors;
};

TEST_F(ToolsTest, program_tells_what_it_can_do) {
    expect_words(run({"--help"}), {"render", "plugins", "diff", "tonemap", "info"});
    run({}, exit_code::usage);
    run({"rendr"}, exit_code::usage);
    expect_words(errors, {"did you mean \"render\"?"});
}

TEST_F(ToolsTest, every_command_has_help) {
    for (const char* verb : {"render", "plugins", "diff", "tonemap", "info"}) {
        expect_words(run({verb, "--help"}), {std::string("lucerna ") + verb, "--help"});
        run({verb, "--no-such-option"}, exit_code::usage);
    }
}

TEST_F(ToolsTest, plugins_are_listed_and_described) {
    expect_words(run({"plugins"}), {"bsdf", "diffuse", "light_sampler", "command", "render"});
    expect_words(run({"plugins", "bsdf"}), {"diffuse", "dielectric"});
    for (const char* name : {"bsdf/diffuse", "bsdfs/diffuse", "diffuse"}) {
        expect_words(run({"plugins", name}), {"reflectance", "default", "[0, 1]", "diffuse.so"});
    }
    expect_words(run({"plugins", "--json", "path"}),
                 {"\"schema\": 1", "\"max_depth\"", "\"default\": \"-1\""});
    run({"plugins", "bsdf/difuse"}, exit_code::usage);
    expect_words(errors, {"diffuse"});
    run({"plugins", "difuse"}, exit_code::usage);
    expect_words(errors, {"did you mean \"diffuse\"?"});
}

TEST_F(ToolsTest, M1_broken_plugins_are_listed_with_the_reason) {
    fs::create_directories(folder / "plugins/bsdfs");
    std::ofstream(folder / "plugins/bsdfs/ruin.so") << "not a library";
    expect_words(run({"plugins", "--plugins", "plugins"}), {"ruin", "CANNOT BE LOADED", "path"});
    run({"plugins", "--plugins", "plugins", "bsdf/ruin"}, exit_code::plugin);
}

TEST_F(ToolsTest, diff_measures) {
    write_picture("a.exr", 1, 1);
    write_picture("b.exr", 1, 1.5f);
    expect_words(run({"diff", "a.exr", "a.exr", "--max-relmse", "0"}), {"relMSE 0\n"});
    // One of twelve pixels is off by 0.5: (0.5)² / (1 + 0.01) / 12.
    expect_words(run({"diff", "b.exr", "a.exr", "--max-relmse", "0.1"}), {"relMSE 0.020627"});
    run({"diff", "b.exr", "a.exr", "--max-relmse", "0.01"}, exit_code::comparison);
    expect_words(run({"diff", "b.exr", "a.exr", "--json"}), {"\"relative_mse\": 0.020627"});
}

/// The pixel that is off is the first of 4 x 3.
TEST_F(ToolsTest, diff_compares_parts) {
    write_picture("a.exr", 1, 1);
    write_picture("b.exr", 1, 1.5f);
    expect_words(run({"diff", "b.exr", "a.exr", "--crop", "1,0,3,3"}), {"relMSE 0\n"});
    expect_words(run({"diff", "b.exr", "a.exr", "--crop", "0,0,2,1"}), {"relMSE 0.123762"});
    run({"diff", "b.exr", "a.exr", "--crop", "2,0,3,1"}, exit_code::failure);
    expect_words(errors, {"--crop 2,0,3,1 is not a part of b.exr, which has 4 x 3 pixels"});
}

TEST_F(ToolsTest, diff_paints_errors) {
    write_picture("a.exr", 1, 1);
    write_picture("b.exr", 1, 1.5f);
    run({"diff", "b.exr", "a.exr", "--error-image", "e.exr"});
    run({"diff", "b.exr", "a.exr", "--error-image", "e.png"});
    EXPECT_NEAR(std::get<std::vector<float>>(read_exr(folder / "e.exr").planes[0].samples)[0],
                0.25 / 1.01, 1e-6);
    EXPECT_EQ(read_png(folder / "e.png").width, 4);
}

TEST_F(ToolsTest, diff_never_hides_pixels_that_are_not_finite) {
    write_picture("a.exr", 1, 1);
    write_picture("b.exr", 1, std::numeric_limits<float>::quiet_NaN());
    expect_words(run({"diff", "b.exr", "a.exr"}), {"not finite: 1 pixels of the image"});
    run({"diff", "b.exr", "a.exr", "--max-relmse", "100"}, exit_code::comparison);
}

TEST_F(ToolsTest, diff_refuses_what_cannot_be_compared) {
    write_picture("a.exr", 1, 1);
    run({"diff", "a.exr"}, exit_code::usage);
    run({"diff", "a.exr", "missing.exr"}, exit_code::file);
    ImageFile small;
    add_layer(small, Image(2, 2));
    write_exr(folder / "small.exr", small);
    run({"diff", "a.exr", "small.exr"}, exit_code::failure);
}

TEST_F(ToolsTest, tonemap_shows_pictures) {
    write_picture("a.exr", 0.18f, 4);
    expect_words(run({"tonemap", "--list"}), {"sRGB"});
    run({"tonemap", "a.exr"});
    const Image plain = read_png(folder / "a.png");
    EXPECT_EQ(plain.pixels[0], 1);
    EXPECT_NEAR(plain.pixels.back(), 0.4614, 0.003);
    run({"tonemap", "a.exr", "b.png", "--exposure", "-2"});
    EXPECT_LT(read_png(folder / "b.png").pixels.back(), plain.pixels.back());
    run({"tonemap", "a.exr", "--view", "nothing"}, exit_code::scene);
    run({"tonemap"}, exit_code::usage);
    run({"tonemap", "a.exr", "a.exr"}, exit_code::usage);
}

TEST_F(ToolsTest, info_tells_what_is_in_a_file) {
    write_picture("a.exr", 1, 1);
    expect_words(run({"info", "a.exr"}), {"4 × 3", "R (float)", "artist = nobody"});
    expect_words(run({"info", "a.exr", "--json"}), {"\"artist\": \"nobody\""});
    std::ofstream(folder / "scene.xml") << small_scene;
    expect_words(run({"info", "scene.xml"}),
                 {"32 × 24", "shapes      2", "lights      1, 1", "bsdfs/diffuse"});
    expect_words(run({"info", "scene.xml", "--json", "-D", "spp=9"}),
                 {"\"shapes\": 2", "\"sample_count\": 9"});
    run({"info", "missing.exr"}, exit_code::file);
    run({"info"}, exit_code::usage);
}

}  // namespace
}  // namespace lucerna
