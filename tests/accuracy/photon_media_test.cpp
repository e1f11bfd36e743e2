// SPDX-License-Identifier: Apache-2.0
/// Photon mapping in media against closed forms and against path tracing.
#include "tests/render_scene.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

std::string integrator(const std::string& type, const std::string& inside = "") {
    return "<integrator type='" + type + "'>" + inside + "</integrator>";
}
const std::string photonmap =
    integrator("photonmap", integer("global_photons", 30000) + integer("caustic_photons", 20000) +
                                integer("volume_photons", 30000) +
                                integer("volume_lookup_size", 8) + integer("lookup_size", 40));
const std::string sppm =
    integrator("sppm", integer("photon_count", 20000) + number("initial_radius", 0.08));

std::string fog(const std::string& name, double sigma_t, double albedo, double g = 0) {
    return "<medium type='homogeneous' name='" + name + "'>" + number("sigma_t", sigma_t) +
           number("albedo", albedo) + "<phase type='hg'>" + number("g", g) + "</phase></medium>";
}
std::string room(double albedo, double emitted, const std::string& medium) {
    return shape("cube", "",
                 boolean("flip_normals", true) + diffuse(albedo) +
                     (emitted > 0 ? area_light(emitted) : "") + medium);
}
/// Looks through the middle of the room, so that no sphere of a photon reaches a wall beside it.
std::string view(const std::string& medium, double fov) {
    TestCamera camera{.to_world = look({0, 0, -0.9}, {0, 0, 1}), .fov = fov};
    camera.inside = medium;
    return xml(camera);
}

/// Walls that emit what they absorb, and fog that absorbs nothing: nothing can be seen.
TEST(PhotonMedia, O1_WhiteFurnace) {
    const std::string scene = room(0.5, 0.5, fog("exterior", 0.7, 1)) + view(fog("", 0.7, 1), 20);
    const std::string many = integrator("photonmap", integer("global_photons", 200000) +
                                                         integer("volume_photons", 100000) +
                                                         integer("volume_lookup_size", 8));
    EXPECT_TRUE(agrees(image_means(many + scene, 8, 6), 1, 0.01));
    EXPECT_TRUE(agrees(image_means(sppm + scene, 32, 12), 1, 0.005));
}

/// The focus behind a ball of glass in fog, lit by a small lamp, with all that fog and walls
/// scatter.
TEST(PhotonMedia, G11_AgreesWithPathTracingBehindGlass) {
    const double sigma = 0.5, albedo = 0.8, g = 0.3;
    const std::string around = fog("exterior", sigma, albedo, g);
    const std::string scene =
        room(0.3, 0, around) + sphere({0, 0, 0.2}, 0.35, "<bsdf type='dielectric'/>" + around) +
        sphere({0, 0.75, 0.2}, 0.2, diffuse(0) + area_light(5) + around) + xml([&] {
            TestCamera camera{.to_world = look({0, -0.45, -0.9}, {0, -0.45, 0.2}), .fov = 25};
            camera.inside = fog("", sigma, albedo, g);
            return camera;
        }());
    const RunningStatistics traced = image_means(integrator("volpath") + scene, 1024, 6);
    EXPECT_TRUE(agree(image_means(photonmap + scene, 8, 6), traced, 0.02));
    EXPECT_TRUE(agree(image_means(sppm + scene, 12, 6), traced, 0.02));
}

/// The first radius in media follows their size, not that of a floor that reaches far beyond them:
/// else nearly all that is scattered twice would be lost in this cube.
TEST(PhotonMedia, FirstRadiusFollowsTheSizeOfTheMedium) {
    const std::string scene =
        shape("cube", "", "<bsdf type='null'/>" + fog("interior", 1, 0.9)) +
        shape("rectangle", scale(30) + "<translate z='-1.01'/>", diffuse(0)) +
        point_light({1.5, 1.5, 3}, 20) +
        xml({.to_world = look({0, -5, 1}, {0, 0, 0}), .fov = 30, .width = 16, .height = 16});
    const RunningStatistics traced = image_means(integrator("volpath") + scene, 256, 4);
    const std::string few = integrator("sppm", integer("photon_count", 20000));
    EXPECT_TRUE(agree(image_means(few + scene, 16, 4), traced, 0.01));
}

/// A glossy floor in fog under a large lamp that it reflects: direct light by rays of the BSDF and
/// by light samples, through the fog, is neither lost nor counted twice.
TEST(PhotonMedia, G11_DirectLightOnGlossySurfaces) {
    const std::string around = fog("exterior", 0.2, 0.5);
    const std::string glossy = "<bsdf type='roughplastic'>" + number("alpha", 0.15) + "</bsdf>";
    const std::string depth = integer("max_depth", 2);
    const std::string scene =
        shape("rectangle", scale(3), glossy + around) +
        shape("rectangle", scale(1) + look({0, 2, 1.5}, {0, 0, 0.2}),
              diffuse(0) + area_light(5) + around) +
        xml([] {
            TestCamera camera{.to_world = look({0, -2, 1}, {0, 0, 0.1}), .fov = 40};
            camera.inside = fog("", 0.2, 0.5);
            return camera;
        }());
    const RunningStatistics traced = image_means(integrator("volpath", depth) + scene, 512, 8);
    const std::string few = depth + integer("photon_count", 1);
    const RunningStatistics progressive = image_means(integrator("sppm", few) + scene, 256, 8);
    EXPECT_TRUE(agree(progressive, traced, 0.005));
    EXPECT_TRUE(agree(image_means(integrator("photonmap", depth) + scene, 256, 8), traced, 0.005));
}

/// What fog emits is seen on the way from the camera, and not by the rays of a glossy floor that
/// look for direct light.
TEST(PhotonMedia, EmissionLightsNoGlossySurface) {
    const auto glowing = [](const std::string& name) {
        return "<medium type='homogeneous' name='" + name + "'>" + number("sigma_t", 0.2) +
               number("albedo", 0) + number("emission", 0.5) + "</medium>";
    };
    const std::string scene =
        shape("rectangle", scale(3),
              "<bsdf type='roughplastic'>" + number("alpha", 0.15) + "</bsdf>" +
                  glowing("exterior")) +
        point_light({0, 0, 1}, 0.001) + xml([&] {
            TestCamera camera{.to_world = look({0, -2, 1}, {0, 0, 0.1}), .fov = 40};
            camera.inside = glowing("");
            return camera;
        }());
    const RunningStatistics seen =
        image_means(integrator("volpath", integer("max_depth", 1)) + scene, 256, 6);
    EXPECT_TRUE(agree(image_means(integrator("sppm") + scene, 64, 6), seen, 0.005));
}

}  // namespace
}  // namespace lucerna
