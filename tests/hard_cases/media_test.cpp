// SPDX-License-Identifier: Apache-2.0
/// Media at their limits: hardly there, opaque, black, white, needles; cameras and lights inside.
#include "tests/render_scene.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace lucerna {
namespace {

using std::numbers::pi;

std::string volpath(const std::string& inside = "") {
    return "<integrator type='volpath'>" + inside + "</integrator>";
}
std::string fog(const std::string& name, double sigma_t, double albedo,
                const std::string& inside = "") {
    return fmt::format("<medium type='homogeneous' name='{}'>", name) + number("sigma_t", sigma_t) +
           number("albedo", albedo) + inside + "</medium>";
}
std::string hg(double g) { return "<phase type='hg'>" + number("g", g) + "</phase>"; }
const std::string null_surface = "<bsdf type='null'/>";
std::string camera(Vector3d from, Vector3d at, const std::string& medium = "") {
    TestCamera c{.to_world = look(from, at), .fov = 20, .width = 4, .height = 4};
    c.inside = medium;
    return xml(c);
}
const std::string sky = constant_light(1);

TEST(OpticalThickness, OneMillionthScattersOneMillionth) {
    // What is scattered once on the way of length 2 to a black wall, past a point light.
    double expected = 0;
    constexpr int n = 100000;
    for (int i = 0; i < n; ++i) {
        const double t = 2 * (i + 0.5) / n;
        expected += 1e-6 / (4 * pi) / (t * t + 0.25) * 2 / n;
    }
    TestCamera thin{.to_world = look({0, 0, 0}, {1, 0, 0})};
    thin.inside = fog("", 1e-6, 1);
    const std::string scene = volpath(integer("max_depth", 2)) + xml(thin) +
                              point_light({0, 0.5, 0}, 1) +
                              shape("rectangle", scale(9) + look({2, 0, 0}, {0, 0, 0}), diffuse(0));
    const RunningStatistics means = image_means(scene, 64, 16);
    EXPECT_LT(std::abs(means.mean() - expected), 4 * means.standard_error());
    EXPECT_LT(means.standard_error(), 0.05 * expected);
}

/// Rays that enter start off the surface by the rounding of its coordinates: a ten-millionth of
/// them, which is nothing for mean free paths of a ten-thousandth, but not for a millionth.
TEST(OpticalThickness, OneMillionIsOpaque) {
    const auto ball = [](double sigma_t) {
        return volpath() + camera({0, 0, -4}, {0, 0, 0}) + sky +
               sphere({0, 0, 0}, 1, null_surface + fog("interior", sigma_t, 0.8));
    };
    const RunningStatistics thick = image_means(ball(1e4), 256);
    EXPECT_TRUE(agree(thick, image_means(ball(1e3), 256), 0.01));
    const FilmState film = TestScene(ball(1e6)).render({.per_pixel = 64});
    EXPECT_EQ(film.dropped_samples(), 0u);
    const double mean = pixel_statistics(film).mean();
    EXPECT_GT(mean, 0.5 * thick.mean());
    EXPECT_LT(mean, 1.05 * thick.mean());
}

/// A medium whose volume says that nothing is there: all light comes through, and nothing is
/// divided by the majorant.
TEST(Majorant, G10_OfZeroLetsAllLightThrough) {
    const std::string empty =
        "<medium type='heterogeneous' name='interior'><volume type='constvolume' name='sigma_t'>" +
        number("value", 0) + "</volume></medium>";
    const FilmState film = TestScene(volpath() + camera({0, 0, -4}, {0, 0, 0}) + sky +
                                     sphere({0, 0, 0}, 1, null_surface + empty))
                               .render({.per_pixel = 16});
    EXPECT_EQ(film.dropped_samples(), 0u);
    EXPECT_TRUE(is_constant(film, 1));
}

TEST(Albedo, ZeroIsBlackAndOneLosesNothing) {
    const auto ball = [](double sigma_t, double albedo) {
        return volpath() + camera({0, 0, -40}, {0, 0, 0}) + sky +
               sphere({0, 0, 0}, 20, null_surface + fog("interior", sigma_t, albedo));
    };
    EXPECT_TRUE(is_constant(TestScene(ball(1e6, 0)).render({.per_pixel = 4}), 0));
    EXPECT_TRUE(agrees(image_means(ball(0.1, 1), 256), 1, 0.005));
    EXPECT_TRUE(is_constant(TestScene(ball(0, 1)).render({.per_pixel = 4}), 1));
}

TEST(HenyeyGreenstein, NeedlesKeepTheFurnaceWhite) {
    for (const double g : {-0.999, 0.999}) {
        const std::string scene = volpath(integer("rr_depth", 50)) + camera({0, 0, -4}, {0, 0, 0}) +
                                  sky +
                                  sphere({0, 0, 0}, 1, null_surface + fog("interior", 3, 1, hg(g)));
        EXPECT_TRUE(agrees(image_means(scene, 256), 1, 0.008)) << g;
    }
}

TEST(Camera, InsideOnTheBoundaryAndOutside) {
    const std::string ball =
        sphere({0, 0, 0}, 1, null_surface + fog("interior", 2, 1)) + sky + volpath();
    for (const double z : {0.0, 0.999999, 1.0}) {
        const std::string inside = camera({0, 0, z}, {0, 0, -4}, fog("", 2, 1));
        EXPECT_TRUE(agrees(image_means(ball + inside, 256), 1, 0.008)) << z;
    }
}

/// In a closed sphere of reflectance ρ and radius R, all flux of a lamp gets to the wall, also out
/// of a white medium around it: L = ρ / π · Φ / (4π R² (1 − ρ)). The lamp is white itself.
TEST(Lamp, O2_InsideOfAWhiteMedium) {
    const double flux = pi * 4 * pi * 0.25 * 0.25;  // of radiance 1
    const std::string scene =
        volpath() + xml({.to_world = look({2.5, 0, 0}, {3, 0, 0}), .width = 4, .height = 4}) +
        sphere({0, 0, 0}, 3, boolean("flip_normals", true) + diffuse(0.5)) +
        sphere({0, 0, 0}, 1, null_surface + fog("interior", 1.5, 1)) +
        sphere({0, 0, 0}, 0.25, diffuse(1) + area_light(1));
    EXPECT_TRUE(agrees(image_means(scene, 1024), 0.5 / pi * flux / (4 * pi * 9 * 0.5), 0.015));
}

TEST(Media, ThreadsDoNotMatter) {
    const std::string scene = volpath() +
                              camera({0, 0, -4}, {0, 0, 0}, fog("", 0.05, 0.9, hg(0.5))) + sky +
                              sphere({0, 0, 0}, 1,
                                     "<bsdf type='dielectric'/>" + fog("interior", 2, 0.9) +
                                         fog("exterior", 0.05, 0.9, hg(0.5))) +
                              sphere({1, 0, -1}, 0.1, area_light(10));
    const TestScene test(scene);
    const auto one = numbers_of(test.render({.per_pixel = 16, .threads = 1}));
    EXPECT_EQ(one, numbers_of(test.render({.per_pixel = 16, .threads = 2})));
    EXPECT_EQ(one, numbers_of(test.render({.per_pixel = 16, .threads = 7})));
}

/// The surface that was met last decides: of A from 1 to 3 and B from 2 to 4 there is A from 1 to
/// 2, B from 2 to 3, where the exterior of A begins, and nothing behind.
TEST(Boundaries, G12_OfOverlappingMediaTheLastCounts) {
    const auto absorbing = [](double z, double sigma) {
        return sphere({0, 0, z}, 1, null_surface + fog("interior", sigma, 0));
    };
    const TestCamera middle{.to_world = look({0, 0, 0}, {0, 0, 9}), .width = 2, .height = 2};
    EXPECT_TRUE(
        is_constant(TestScene(volpath() + xml(middle) + sky + absorbing(2, 0.5) + absorbing(3, 0.2))
                        .render({.per_pixel = 1}),
                    std::exp(-0.5 - 0.2), 1e-4));
}

/// A closed surface that emits inwards and is the boundary of what is inside.
TEST(Boundaries, G14_ALightIsSeenThroughItsOwnMedium) {
    const auto lamp = [](const std::string& medium) {
        return sphere({0, 0, 0}, 2,
                      boolean("flip_normals", true) + diffuse(0) + area_light(1) + medium);
    };
    const auto seen = [&](double albedo) {
        const std::string inside = fog("", 0.7, albedo);
        return volpath() + camera({0, 0, 0}, {1, 0, 0}, inside) +
               lamp(fog("exterior", 0.7, albedo));
    };
    // Rays begin at the near clip plane, which is a thousandth away.
    EXPECT_TRUE(
        is_constant(TestScene(seen(0)).render({.per_pixel = 4}), std::exp(-0.7 * 1.999), 1e-4));
    // In a white medium all light comes from the surface, whatever the way.
    EXPECT_TRUE(agrees(image_means(seen(1), 256), 1, 0.01));
}

/// Though the volume would end at the unit cube.
TEST(Media, P8_HomogeneousOnesTakeAVolumeOfOneValue) {
    const std::string medium =
        "<bsdf type='null'/><medium type='homogeneous' name='interior'>"
        "<volume name='sigma_t' type='constvolume'><float name='value' value='0.5'/></volume>"
        "<rgb name='albedo' value='0'/></medium>";
    const TestCamera along{.to_world = look({0, 0, 9}, {0, 0, 0}), .fov = 0.01};
    const FilmState film = TestScene(volpath() + xml(along) + sky + shape("cube", "", medium))
                               .render({.per_pixel = 1024});
    EXPECT_TRUE(agrees(pixel_statistics(film), std::exp(-1.0)));
}

/// Shapes that are placed by instances have media, too.
TEST(Media, InInstances) {
    const std::string ball = sphere({0, 0, 0}, 1,
                                    null_surface +
                                        "<medium type='homogeneous' name='interior'>"
                                        "<rgb name='sigma_a' value='0.7'/></medium>");
    const std::string scene =
        volpath() + sky + xml({.to_world = look({5, 0, -4}, {5, 0, 0}), .width = 2, .height = 2}) +
        "<shape type='shapegroup' id='group'>" + ball + "</shape>" +
        shape("instance", translate({5, 0, 0}), "<ref id='group'/>");
    EXPECT_TRUE(is_constant(TestScene(scene).render({.per_pixel = 1}), std::exp(-1.4), 1e-4));
}

}  // namespace
}  // namespace lucerna
