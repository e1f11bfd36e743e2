// SPDX-License-Identifier: Apache-2.0
/// Light samples that go on through mirrors and glass find the same light as paths without them.
#include "core/image/exr.h"
#include "tests/paths.h"
#include "tests/repeated_renders.h"

#include <gtest/gtest.h>

#include <numeric>

namespace lucerna {
namespace {

const std::string glass = "<bsdf type='dielectric'/>";
const std::string mirror = "<bsdf type='conductor'/>";

/// A dim gradient with a sun of one pixel.
void write_sky(const std::filesystem::path& path) {
    Image sky(32, 16);
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 32; ++x) sky.set_rgb(x, y, Color(0.2f + 0.02f * static_cast<float>(y)));
    }
    sky.set_rgb(20, 3, Color(100));
    ImageFile file;
    add_layer(file, sky);
    write_exr(path, file);
}

class SpecularChains : public testing::Test {
protected:
    SpecularChains() { write_sky(folder_ / "sky.exr"); }

    TestScene scene(int chain, const std::string& content, const std::string& inside = "") const {
        return TestScene(
            path_integrator(integer("specular_chain", chain) + integer("max_depth", 7) + inside) +
                "<emitter type='envmap'><string name='filename' value='sky.exr'/></emitter>" +
                content,
            folder_.path());
    }

    TemporaryFolder folder_;
};

/// Panes, mirrors, a glass with a lamp and a matte ball in it, and what light goes straight
/// through: before, in and behind the chains.
std::string still_life() {
    const std::string veil =
        "<bsdf type='mask'><bsdf type='twosided'>" + diffuse(0.6) + "</bsdf></bsdf>";
    return xml({.to_world = look({2.5, 2, 3.5}, {0, 0.5, 0}),
                .fov = 50,
                .width = 12,
                .height = 8}) +
           shape("rectangle", scale(5) + look({0, 0, 0}, {0, 1, 0}), diffuse(0.5)) +
           shape("rectangle", scale(1.5) + look({-2, 1, 0}, {0, 1, 0.5}),
                 "<bsdf type='roughconductor'><float name='alpha' value='0.3'/></bsdf>") +
           shape("rectangle", scale(1) + look({0.5, 0.6, -1.5}, {0, 1, 0}), mirror) +
           shape("cube", "<scale x='1' y='0.02' z='1'/>" + translate({1, 1.2, 0.5}), glass) +
           sphere({0, 0.6, 0}, 0.6, glass) + sphere({0, 0.5, 0}, 0.3, diffuse(0.8)) +
           sphere({0.1, 0.95, 0.1}, 0.05, diffuse(0) + area_light(20)) +
           shape("rectangle", scale(0.5) + look({1, 1.5, 0.5}, {1, 2, 0.6}), veil) +
           shape("rectangle", scale(0.4) + look({1, 0.3, 1.2}, {1, 2, 1}),
                 "<bsdf type='thindielectric'/>") +
           sphere({-1, 0.3, 1}, 0.3, "<bsdf type='plastic'/>");
}

TEST_F(SpecularChains, G11_AgreeWithPathsInEveryPixel) {
    const RepeatedRenders alone(scene(0, still_life()), 256, 0, 48);
    for (const int chain : {1, 4}) {
        const RepeatedRenders with(scene(chain, still_life()), 128, 1000, 48);
        EXPECT_TRUE(image_matches(with.mean, with.variance, alone.mean, alone.variance)) << chain;
    }
}

TEST_F(SpecularChains, G11_AgreeWhenPixelsShareThem) {
    const RepeatedRenders alone(scene(0, still_life()), 256, 0, 48);
    const RepeatedRenders shared(
        scene(4, still_life(), integer("reuse", 4) + integer("emitter_samples", 2)), 64, 2000, 48);
    EXPECT_TRUE(image_matches(shared.mean, shared.variance, alone.mean, alone.variance));
}

/// A second environment would have to be counted in the densities: chains are left alone.
TEST_F(SpecularChains, G11_AgreeUnderTwoEnvironments) {
    const std::string content = still_life() + constant_light(0.5);
    const RepeatedRenders alone(scene(0, content), 64, 0, 8);
    const RepeatedRenders with(scene(4, content), 64, 0, 8);
    EXPECT_EQ(alone.mean, with.mean);
}

/// The floor of a greenhouse, seen from inside.
TEST_F(SpecularChains, TheSunShinesThroughPanes) {
    const std::string greenhouse =
        xml({.to_world = look({0, 0.5, 0.1}, {0, 0, 0}), .fov = 60}) +
        shape("rectangle", scale(50) + look({0, 0, 0}, {0, 1, 0}), diffuse(0.5)) +
        shape("cube", "<scale x='100' y='0.02' z='100'/>" + translate({0, 1, 0}), glass);
    const auto noise = [&](int chain) {
        const RepeatedRenders renders(scene(chain, greenhouse), 64, 0, 16);
        return std::accumulate(renders.variance.begin(), renders.variance.end(), 0.0);
    };
    EXPECT_LT(noise(2), 0.1 * noise(0));
    EXPECT_LT(noise(-1), 0.1 * noise(0));  // a few paths show that it pays
}

TEST_F(SpecularChains, N8_ThreadsChangeNoBit) {
    const TestScene with = scene(4, still_life());
    EXPECT_EQ(numbers_of(with.render({.per_pixel = 8, .threads = 1})),
              numbers_of(with.render({.per_pixel = 8, .threads = 7})));
}

}  // namespace
}  // namespace lucerna
