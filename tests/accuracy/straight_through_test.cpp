// SPDX-License-Identifier: Apache-2.0
/// Light that goes straight through surfaces: null, mask, glass of equal indices, panes; and
/// emitters that the camera does not see.
#include "tests/render_scene.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

using std::numbers::pi;

std::string bsdf(const std::string& type, const std::string& inside = "") {
    return "<bsdf type='" + type + "'>" + inside + "</bsdf>";
}
std::string integrator(const std::string& type, const std::string& inside = "") {
    return "<integrator type='" + type + "'>" + inside + "</integrator>";
}
std::string mask(double opacity) {
    return bsdf("mask", number("opacity", opacity) + bsdf("twosided", diffuse(0)));
}
std::string sheet(double height, const std::string& material) {
    return shape("rectangle", scale(4) + translate({0, 0, height}), material);
}

struct Veil {
    std::string xml;
    double transmittance;  ///< of light along the normal
};
const std::vector<Veil> veils = {
    {sheet(1, bsdf("null")), 1},
    {sheet(1, mask(0.25)), 0.75},
    {sheet(1, mask(0.25)) + sheet(1.2, bsdf("null")) + sheet(1.3, mask(0.5)), 0.375},
    {sheet(1, bsdf("dielectric", number("int_ior", 1.5) + number("ext_ior", 1.5))), 1},
    {sheet(1, bsdf("blendbsdf", number("weight", 0.4) + diffuse(0) + bsdf("null"))), 0.4},
    {sheet(1, bsdf("thindielectric", number("int_ior", 1.5) + number("ext_ior", 1))), 12. / 13},
    {sphere({0, 0, 1}, 0.5, mask(0.5)), 0.25},
};

/// The middle of a floor of albedo ½, seen from below the veils, through another one.
const std::string floor_and_camera =
    shape("rectangle", scale(1e-3), diffuse(0.5)) +
    shape("rectangle", scale(0.05) + translate({0, 0, 0.2}), bsdf("null")) +
    xml({.to_world = look({0.2, 0, 0.3}, {0, 0, 0}), .width = 4, .height = 4});

const std::string lamp_over_floor = point_light({0, 0, 2}, 4 * pi);  // irradiance π
const std::string sun = "<emitter type='directional'><vector name='direction' value='0, 0, -1'/>" +
                        std::string("<rgb name='irradiance' value='3.14159265'/></emitter>");
const std::string ball = sphere({0, 0, 2}, 0.05, diffuse(0) + area_light(1600));  // irradiance π

TEST(StraightThrough, P2_ShadowRaysReachDeltaLights) {
    for (const Veil& veil : veils) {
        for (const std::string& light : {lamp_over_floor, sun}) {
            for (const std::string& method :
                 {path_integrator(), path_integrator(integer("max_depth", 2)),
                  path_integrator(integer("reuse", 4)), direct_integrator()}) {
                const FilmState film = TestScene(method + floor_and_camera + light + veil.xml)
                                           .render({.per_pixel = 4});
                EXPECT_TRUE(is_constant(film, 0.5 * veil.transmittance, 1e-4))
                    << method << light << veil.xml;
            }
        }
    }
}

/// A lamp that is found by light sampling and by chance is weighted as if nothing were between.
TEST(StraightThrough, G8_P2_AreaLightsCountOnce) {
    const std::string wide =
        shape("rectangle", scale(0.5) + look({0, 0, 1.5}, {0, 0, 0}), diffuse(0) + area_light(1));
    const double irradiance = polygon_irradiance(
        {{-.5, -.5, 1.5}, {-.5, .5, 1.5}, {.5, .5, 1.5}, {.5, -.5, 1.5}}, {0, 0, 0}, {0, 0, 1});
    for (const Veil& veil : veils) {
        if (veil.xml.find("thindielectric") != std::string::npos) continue;  // varies with angle
        if (veil.xml.find("sphere") != std::string::npos) continue;          // covers a part
        const double expected = 0.5 / pi * irradiance * veil.transmittance;
        for (const std::string& method :
             {path_integrator(), path_integrator(integer("max_depth", 2)), direct_integrator(),
              direct_integrator(integer("bsdf_samples", 0)),
              direct_integrator(integer("emitter_samples", 0))}) {
            EXPECT_TRUE(agrees(image_means(method + floor_and_camera + wide + veil.xml, 4096),
                               expected, 0.01))
                << method << veil.xml;
        }
    }
}

/// Noise, too, is what it would be without the surface.
TEST(StraightThrough, ANullSurfaceChangesNoSample) {
    const std::string room =
        sphere({1, 0.5, 1}, 0.4, diffuse(0.7)) + shape("rectangle", scale(3), diffuse(0.5)) + ball +
        constant_light(0.1) + xml({.to_world = look({2, 2, 2}, {0, 0, 0}), .fov = 40});
    for (const int reuse : {1, 4}) {
        const std::string path = path_integrator(integer("reuse", reuse));
        const FilmState without = TestScene(path + room).render({.per_pixel = 16});
        const FilmState with =
            TestScene(path + room + sheet(1.7, bsdf("null"))).render({.per_pixel = 16});
        for (std::size_t i = 0; i < with.pixel_count(); ++i) {
            // Shared paths are not joined through it.
            const double tolerance = reuse == 1 ? 1e-4 : 0.3;
            EXPECT_NEAR(with.mean(i, 1) / without.mean(i, 1), 1, tolerance) << reuse;
        }
    }
}

/// The camera looks through; what emits, and what is lit, is seen behind.
TEST(StraightThrough, G11_TheCameraSeesThrough) {
    const std::string scene =
        shape("rectangle", scale(2), diffuse(0.5) + area_light(0.3)) + lamp_over_floor +
        sheet(0.5, bsdf("mask", number("opacity", 0.25) + diffuse(0))) +
        xml({.to_world = look({0.2, 0, 0.8}, {0, 0, 0}), .width = 4, .height = 4});
    // Light passes the mask once, and what is seen once more.
    const double seen = 0.75 * (0.3 + 0.5 * 0.75);
    for (const std::string& method :
         {path_integrator(), path_integrator(integer("max_depth", 2)), direct_integrator(),
          integrator("sppm", integer("photon_count", 1000)),
          integrator("photonmap", integer("global_photons", 1000))}) {
        EXPECT_TRUE(agrees(image_means(method + scene, 256), seen, 0.01)) << method;
    }
    EXPECT_TRUE(
        agrees(image_means(path_integrator(integer("max_depth", 1)) + scene, 4), 0.75 * 0.3, 1e-4));
}

TEST(StraightThrough, AlphaIsWhatCoversTheBackground) {
    const std::string scene =
        sheet(0, mask(0.25)) + sheet(-1, bsdf("null")) +
        xml({.to_world = look({0, 0, 1}, {0, 0, 0}), .width = 4, .height = 4});
    for (const std::string& method :
         {path_integrator(), path_integrator(integer("max_depth", 1)), direct_integrator(),
          integrator("sppm", integer("photon_count", 1)), integrator("ptracer")}) {
        EXPECT_TRUE(agrees(
            pixel_statistics(TestScene(method + scene).render({.per_pixel = 1024}), 3), 0.25, 0.02))
            << method;
    }
}

/// Photons go through without becoming caustics, and their paths are as long as those of `path`.
TEST(StraightThrough, G11_PhotonsGoThrough) {
    const std::string wide_camera =
        shape("rectangle", scale(0.5), diffuse(0.5)) +
        xml({.to_world = look({0, 0, 0.9}, {0, 0, 0}), .fov = 50, .width = 4, .height = 4});
    for (const Veil& veil : veils) {
        if (veil.xml.find("thindielectric") != std::string::npos) continue;
        if (veil.xml.find("sphere") != std::string::npos) continue;
        for (const std::string& light : {sun, ball}) {
            const std::string scene = wide_camera + light + veil.xml;
            const RunningStatistics path =
                image_means(path_integrator(integer("max_depth", 2)) + scene, 256);
            for (const std::string& method :
                 {integrator("ptracer", integer("max_depth", 2)),
                  integrator("photonmap",
                             integer("max_depth", 2) + integer("global_photons", 1000)),
                  integrator("sppm", integer("max_depth", 2) + integer("photon_count", 1000))}) {
                const bool particles = method.find("ptracer") != std::string::npos;
                EXPECT_TRUE(agree(image_means(method + scene, particles ? 4096 : 256), path, 0.03))
                    << method << light << veil.xml;
            }
        }
    }
}

/// Where a hidden lamp is, one sees what lies behind it: a lit wall, or nothing.
TEST(HiddenEmitters, P6_AreNotInThePicture) {
    const std::string hidden = boolean("hide_emitters", true);
    const std::string camera =
        xml({.to_world = look({0, 0, 1}, {0, 0, 0}), .fov = 30, .width = 4, .height = 4});
    const std::string lamp = shape("disk", scale(0.2) + translate({0, 0, 0.5}),
                                   diffuse(0) + area_light(5));  // shines towards the camera
    const std::string two_lamps = lamp + sphere({0, 0, 0.6}, 0.05, diffuse(0) + area_light(0));
    const std::string wall = shape("rectangle", scale(1), diffuse(0.5));
    const std::string light = point_light({0.9, 0, 1}, 10);  // the lamps' shadows are not seen
    for (const std::string& method :
         {path_integrator(hidden), path_integrator(hidden + integer("reuse", 4)),
          integrator("direct", hidden),
          integrator("photonmap", hidden + integer("global_photons", 1000)),
          integrator("sppm", hidden + integer("photon_count", 1000)),
          integrator("ptracer", hidden)}) {
        const bool particles = method.find("ptracer") != std::string::npos;
        const std::uint64_t samples = particles ? 8192 : 64;
        const std::string scene = method + camera + light;
        EXPECT_TRUE(agree(image_means(scene + wall + two_lamps, samples),
                          image_means(scene + wall, samples), 0.02))
            << method;
        const FilmState nothing =
            TestScene(method + camera + two_lamps + constant_light(1)).render({.per_pixel = 16});
        EXPECT_TRUE(is_constant(nothing, 0)) << method;
        EXPECT_EQ(pixel_range(nothing, 3).high, 0.0) << method;
    }
}

}  // namespace
}  // namespace lucerna
