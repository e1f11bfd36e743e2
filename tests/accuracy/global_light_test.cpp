// SPDX-License-Identifier: Apache-2.0
/// Light that is reflected many times, against closed forms.
#include "tests/render_scene.h"

#include <fmt/format.h>

namespace lucerna {
namespace {

using std::numbers::pi;

/// A camera in the middle of things that looks along a crooked direction.
std::string inner_camera(Vector3d from = Vector3d(0.1, 0.2, -0.1),
                         Vector3d at = Vector3d(1, 0.3, 0.5), int size = 16) {
    return xml({.to_world = look(from, at), .fov = 60, .width = size, .height = size});
}

/// A closed room whose walls all emit 1 and reflect `albedo`.
std::string furnace_room(const std::string& type, double albedo) {
    return "<shape type='" + type + "'>" + boolean("flip_normals", true) + diffuse(albedo) +
           area_light(1) + "</shape>" + inner_camera();
}

TEST(GlobalLight, O1_ClosedRoomOfEmittingWalls) {
    for (const auto& [albedo, radiance] : {std::pair(0.5, 2.0), {0.8, 5.0}}) {
        for (const char* type : {"cube", "sphere"}) {
            const TestScene scene(path_integrator() + furnace_room(type, albedo));
            EXPECT_TRUE(agrees(pixel_statistics(scene.render({.per_pixel = 512})), radiance))
                << type << " " << albedo;
        }
    }
}

/// Roulette begins late: with a survival probability below the albedo its variance is infinite.
TEST(GlobalLight, O1_G4_AlbedoNearOne) {
    const TestScene scene(path_integrator(integer("rr_depth", 600)) + furnace_room("sphere", 0.99));
    EXPECT_TRUE(agrees(pixel_statistics(scene.render({.per_pixel = 16})), 100));
}

TEST(GlobalLight, O1_G3_LimitedDepth) {
    const auto depth = [](int edges) {
        return path_integrator(integer("max_depth", edges)) + furnace_room("sphere", 0.8);
    };
    EXPECT_TRUE(is_constant(TestScene(depth(1)).render({}), 1));
    EXPECT_TRUE(agrees(pixel_statistics(TestScene(depth(2)).render({.per_pixel = 256})), 1.8));
    EXPECT_TRUE(
        agrees(pixel_statistics(TestScene(depth(11)).render({.per_pixel = 256})), 4.570503));
    EXPECT_TRUE(is_constant(TestScene(depth(0)).render({}), 0));
}

TEST(GlobalLight, O26_G1_RussianRouletteKeepsTheMean) {
    for (const int rr_depth : {1, 5, 20}) {
        const TestScene scene(path_integrator(integer("rr_depth", rr_depth)) +
                              furnace_room("sphere", 0.8));
        EXPECT_TRUE(agrees(pixel_statistics(scene.render({.per_pixel = 1024})), 5)) << rr_depth;
    }
}

TEST(GlobalLight, O2_PointLightInADiffuseSphere) {
    const TestScene scene(path_integrator() + inner_camera() + "<shape type='sphere'>" +
                          boolean("flip_normals", true) + diffuse(0.5) + "</shape>" +
                          point_light(Vector3d(0), pi));
    EXPECT_TRUE(agrees(pixel_statistics(scene.render({.per_pixel = 256})), 1));
}

/// L is the same all over each sphere, so wherever the camera looks.
TEST(GlobalLight, O10_ConcentricSpheres) {
    const std::string spheres = "<shape type='sphere'>" + diffuse(0.5) + area_light(1) +
                                "</shape>" + "<shape type='sphere'>" + number("radius", 2) +
                                boolean("flip_normals", true) + diffuse(0.8) + "</shape>";
    const auto seen = [&](Vector3d at) {
        const std::string camera =
            xml({.to_world = look({1.5, 0.1, 0}, at), .fov = 10, .width = 16, .height = 16});
        return pixel_statistics(
            TestScene(path_integrator() + camera + spheres).render({.per_pixel = 1024}));
    };
    EXPECT_TRUE(agrees(seen({0, 0, 0}), 4.0 / 3));
    EXPECT_TRUE(agrees(seen({3, 0, 0}), 2.0 / 3));
}

TEST(GlobalLight, O14_ParallelPlates) {
    // They are 4000 times wider than their distance: their edges do not matter.
    const std::string plates =
        shape("rectangle", scale(2000), diffuse(0.5) + area_light(1)) +
        shape("rectangle", scale(2000) + look({0, 0, 1}, {0, 0, 0}), diffuse(0.8));
    const auto seen = [&](Vector3d at) {
        const std::string camera =
            xml({.to_world = look({0, 0, 0.5}, at), .fov = 10, .width = 16, .height = 16});
        return pixel_statistics(
            TestScene(path_integrator() + camera + plates).render({.per_pixel = 512}));
    };
    EXPECT_TRUE(agrees(seen({0.1, 0, 0}), 5.0 / 3));
    EXPECT_TRUE(agrees(seen({0.1, 0, 1}), 4.0 / 3));
}

/// A lamp of flux Φ in a sphere with an opening, the fraction f of its area: after the first
/// reflection light is spread evenly, and L = ρ² Φ / (π A (1 − ρ (1 − f))).
TEST(GlobalLight, O3_IntegratingSphere) {
    // A black disk takes the place of the opening, and the lamp lies on it.
    const double beta = pi / 12, f = (1 - std::cos(beta)) / 2, albedo = 0.9, lamp = 1e-3;
    const std::string room =
        "<shape type='sphere'>" + boolean("flip_normals", true) + diffuse(albedo) + "</shape>" +
        shape("disk", scale(std::sin(beta)) + translate({0, 0, -std::cos(beta)}), diffuse(0)) +
        shape("disk", scale(lamp) + translate({0, 0, 1e-3 - std::cos(beta)}),
              diffuse(0) + area_light(1 / (pi * pi * lamp * lamp))) +
        xml({.to_world = look({0.3, 0.1, 0.2}, {1, 0.2, 0.1}),
             .fov = 30,
             .width = 16,
             .height = 16});
    const auto mean = [&](int max_depth) {
        const TestScene scene(path_integrator(integer("max_depth", max_depth)) + room);
        return pixel_statistics(scene.render({.per_pixel = 1024})).mean();
    };
    const double indirect = sqr(albedo / (2 * pi)) / (1 - albedo * (1 - f));
    EXPECT_NEAR((mean(-1) - mean(2)) / indirect, 1, 0.004);
}

}  // namespace
}  // namespace lucerna
