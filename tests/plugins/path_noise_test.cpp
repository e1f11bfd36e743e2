// SPDX-License-Identifier: Apache-2.0
/// How many light samples `path` takes and how many pixels share, from what a few paths show.
#include "plugins/integrators/path_noise.h"

#include "tests/render_scene.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

PathSplitting best(const PathNoise& noise,
                   PathSplitting given = {.light_samples = 0, .block_size = 0}) {
    return best_splitting(noise, given);
}

TEST(PathNoise, WhatPaysFollowsFromTheKindOfNoise) {
    const PathSplitting shared = best({.own = 0.01, .light = 0, .shared = 1, .rays = 8});
    EXPECT_EQ(shared.block_size, 8);
    EXPECT_EQ(shared.light_samples, 1);
    const PathSplitting light = best({.own = 1, .light = 1, .shared = 0, .rays = 12});
    EXPECT_EQ(light.block_size, 1);
    EXPECT_EQ(light.light_samples, 8);
    const PathSplitting neither = best({.own = 1, .light = 0, .shared = 0, .rays = 8});
    EXPECT_EQ(neither.block_size, 1);
    EXPECT_EQ(neither.light_samples, 1);
    const PathSplitting nothing = best({});
    EXPECT_EQ(nothing.block_size, 1);
    EXPECT_EQ(nothing.light_samples, 1);
}

TEST(PathNoise, WhatIsGivenStays) {
    const PathNoise noise{.own = 0.01, .light = 0, .shared = 1, .rays = 8};
    EXPECT_EQ(best(noise, {.light_samples = 3, .block_size = 0}).light_samples, 3);
    EXPECT_EQ(best(noise, {.light_samples = 3, .block_size = 0}).block_size, 8);
    EXPECT_EQ(best(noise, {.light_samples = 0, .block_size = 2}).block_size, 2);
}

/// Seen from within a matte room, nearly all noise is that of indirect light; a mirror ball under
/// a sky has none.
TEST(PathNoise, IsMeasuredInTheScene) {
    const std::string camera = xml({.to_world = look({0, 0, 3}, {0, 0, 0}), .fov = 20});
    const std::string room = shape("cube", scale(4), boolean("flip_normals", true) + diffuse(0.7)) +
                             sphere({0, 3, 0}, 0.3, diffuse(0) + area_light(10));
    const std::string ball = sphere({0, 0, 0}, 1, "<bsdf type='conductor'/>") + constant_light(1);
    const std::string path = "<integrator type='path'/>";
    EXPECT_GE(TestScene(path + camera + room).scene().integrator().block_size(), 4);
    EXPECT_EQ(TestScene(path + camera + ball).scene().integrator().block_size(), 1);
    EXPECT_EQ(
        TestScene("<integrator type='path'><integer name='max_depth' value='2'/></integrator>" +
                  camera + room)
            .scene()
            .integrator()
            .block_size(),
        1);
}

}  // namespace
}  // namespace lucerna
