// SPDX-License-Identifier: Apache-2.0
/// The integrator `moment`, and the names of layers.
#include "tests/render_scene.h"

namespace lucerna {
namespace {

const std::string nested = "<integrator type='path' name='a'/><integrator type='depth'/>";

/// Half of the pixels' area sees a lamp of radiance 3, the rest nothing.
std::string half_lit(const std::string& integrator) {
    return integrator +
           xml({.to_world = look({0, 0, 1}, {0, 0, 0}), .fov = 60, .width = 1, .height = 1}) +
           shape("rectangle", scale(10) + translate({10, 0, 0}), diffuse(0) + area_light(3));
}

TEST(Moment, LayersHaveMitsubasNames) {
    const TestScene scene(half_lit("<integrator type='moment'>" + nested + "</integrator>"));
    EXPECT_EQ(scene.scene().integrator().layers(),
              (std::vector<std::string>{"a.X", "a.Y", "a.Z", "_arg_1.depth", "_arg_1.X", "_arg_1.Y",
                                        "_arg_1.Z", "m2_a.X", "m2_a.Y", "m2_a.Z", "m2__arg_1.depth",
                                        "m2__arg_1.X", "m2__arg_1.Y", "m2__arg_1.Z"}));
    const TestScene aov(
        half_lit("<integrator type='aov'><string name='aovs' value='dd.y:depth,nn:sh_normal,uv:uv,"
                 "a:albedo,i:shape_index,p:prim_index'/></integrator>"));
    EXPECT_EQ(aov.scene().integrator().layers(),
              (std::vector<std::string>{"dd.y.T", "nn.X", "nn.Y", "nn.Z", "uv.U", "uv.V", "a.R",
                                        "a.G", "a.B", "i.I", "p.I"}));
}

TEST(Moment, OfATwoValuedPixel) {
    const TestScene scene(half_lit("<integrator type='moment'>" + nested + "</integrator>"));
    const FilmState film = scene.render({.per_pixel = 20000});
    const auto mean = [&](std::size_t channel) { return pixel_statistics(film, channel).mean(); };
    // The film's channels: R, G, B, A and the layers. Y is 3 with probability 1/2.
    EXPECT_NEAR(mean(5), 1.5, 0.05);
    EXPECT_NEAR(mean(12), 3 * mean(5), 1e-4);
    EXPECT_NEAR(mean(0), mean(5), 1e-5);
    // White light of radiance 3: X, Y, Z in the ratios of D65.
    EXPECT_NEAR(mean(4) / mean(5), 0.950456, 1e-5);
    EXPECT_NEAR(mean(6) / mean(5), 1.089058, 1e-5);
    // E[d²] ≥ E[d]², and both of a distance of at least 1.
    EXPECT_GT(mean(14), mean(7));
    EXPECT_NEAR(mean(16), mean(14), 1e-4);
}

TEST(Moment, PixelsShareNoPaths) {
    const std::string room = xml({.to_world = look({0, 0, 1}, {0, 0, 0}), .fov = 60}) +
                             shape("rectangle", scale(10), diffuse(0.5)) + constant_light(1) +
                             sphere({0.5, 0.5, 0.5}, 0.2, diffuse(0.8));
    const auto picture = [&](const std::string& integrator) {
        const TestScene scene(integrator + room);
        const FilmState film = scene.render({.per_pixel = 16});
        return pixel_statistics(film, 0).mean();
    };
    const std::string path = "<integrator type='path'><integer name='reuse' value='";
    const std::string moment = "<integrator type='moment'>";
    EXPECT_EQ(picture(moment + path + "4'/></integrator></integrator>"),
              picture(moment + path + "4'/></integrator><integrator type='depth'/></integrator>"));
    EXPECT_NEAR(picture(moment + path + "4'/></integrator></integrator>"),
                picture(path + "1'/></integrator>"), 0.005);
}

}  // namespace
}  // namespace lucerna
