// SPDX-License-Identifier: Apache-2.0
/// Paths that pixels share find the same light as those of single pixels, pixel by pixel.
#include "tests/paths.h"
#include "tests/repeated_renders.h"

#include <gtest/gtest.h>

#include <numeric>

namespace lucerna {
namespace {

std::string rough(const std::string& type, double alpha) {
    return "<bsdf type='" + type + "'>" + number("alpha", alpha) + "</bsdf>";
}

/// A corner with matte, glossy and clear things, and a coarse mesh whose normals are smooth.
/// Neighbouring pixels see different surfaces, and sides of them. `around`: a medium.
std::string still_life(const std::string& mesh, const std::string& around = "") {
    return xml({.to_world = look({2.5, 2, 3.5}, {0, 0.5, 0}),
                .fov = 50,
                .width = 12,
                .height = 8,
                .inside = around}) +
           shape("rectangle", scale(5) + look({0, 0, 0}, {0, 1, 0}), rough("roughconductor", 0.3)) +
           shape("rectangle", scale(5) + translate({0, 0, -2}), diffuse(0.7)) +
           shape("rectangle", scale(0.5) + look({1, 0.5, 1}, {0, 0.6, 0}),
                 "<bsdf type='twosided'>" + diffuse(0.8) + "</bsdf>") +
           shape("obj", scale(0.6) + translate({-0.9, 0.6, 0.3}),
                 "<string name='filename' value='" + mesh + "'/>" + rough("roughplastic", 0.2)) +
           sphere({0.6, 0.5, 0}, 0.5, "<bsdf type='dielectric'/>") +
           sphere({0.2, 0.3, 1.2}, 0.3, rough("roughdielectric", 0.3)) +
           sphere({1.5, 0.3, 0.5}, 0.3, "<bsdf type='plastic'/>") +
           shape("rectangle", scale(0.7) + look({-2, 3, 2}, {0, 0, 0}),
                 diffuse(0) + area_light(6)) +
           shape("cube", scale(0.2) + translate({-1.5, 1.6, -1}), diffuse(0.5) + area_light(4)) +
           point_light({1, 2, 1}, 1) + constant_light(0.1);
}

class PathReuse : public testing::Test {
protected:
    PathReuse() {
        write_file(folder_ / "sphere.obj", sphere_obj(4, true));
        content_ = still_life((folder_ / "sphere.obj").string());
    }
    TestScene scene(int reuse, const std::string& inside = "") const {
        return TestScene(
            path_integrator(integer("reuse", reuse) + integer("max_depth", 5) + inside) + content_);
    }

    TemporaryFolder folder_;
    std::string content_;
};

TEST_F(PathReuse, G11_AgreesWithPathsOfTheirOwnInEveryPixel) {
    const RepeatedRenders own(scene(1), 256, 0, 48);
    for (const int reuse : {2, 4, 8}) {
        const RepeatedRenders shared(scene(reuse), reuse == 8 ? 32 : 128, 1000, 48);
        EXPECT_TRUE(image_matches(shared.mean, shared.variance, own.mean, own.variance)) << reuse;
    }
}

TEST_F(PathReuse, G11_LightSamplesOfTheFirstVertexDoNotChangeTheMean) {
    const RepeatedRenders one(scene(1), 256, 0, 48);
    for (const int reuse : {1, 4}) {
        const RepeatedRenders several(scene(reuse, integer("emitter_samples", 4)), 64, 3000, 48);
        EXPECT_TRUE(image_matches(several.mean, several.variance, one.mean, one.variance)) << reuse;
    }
}

/// Panes, holes and veils before, between and behind the vertices that are shared.
TEST_F(PathReuse, G11_AgreesBehindSurfacesThatLightGoesStraightThrough) {
    const std::string veil =
        "<bsdf type='mask'><bsdf type='twosided'>" + diffuse(0.6) + "</bsdf></bsdf>";
    content_ += shape("rectangle", scale(0.6) + look({0.6, 1.2, 1.5}, {-1, 0, 0}), veil) +
                shape("rectangle", scale(0.5) + look({-0.3, 0.5, 1}, {2, 1, 3}),
                      "<bsdf type='thindielectric'/>") +
                sphere({1.5, 0.3, 0.5}, 0.4, "<bsdf type='null'/>");
    const RepeatedRenders own(scene(1), 256, 0, 48);
    const RepeatedRenders shared(scene(4), 128, 1000, 48);
    EXPECT_TRUE(image_matches(shared.mean, shared.variance, own.mean, own.variance));
}

/// Directions that are black are never taken, though the BSDF has a density for them.
TEST_F(PathReuse, G11_AgreesOnAFloorOfBlackAndWhite) {
    const std::string checkerboard =
        "<bsdf type='diffuse'><texture type='checkerboard' name='reflectance'>"
        "<float name='color0' value='0'/><float name='color1' value='0.8'/>"
        "<transform name='to_uv'><scale value='40'/></transform></texture></bsdf>";
    content_ += shape("rectangle", scale(5) + look({0, 0.01, 0}, {0, 1, 0}), checkerboard);
    const RepeatedRenders own(scene(1), 256, 0, 48);
    const RepeatedRenders shared(scene(4), 128, 1000, 48);
    EXPECT_TRUE(image_matches(shared.mean, shared.variance, own.mean, own.variance));
}

/// Light that the path itself does not reflect may be reflected to others.
TEST_F(PathReuse, G11_AgreesBesideNormalsThatTurnAway) {
    const std::string tilted =
        "<bsdf type='normalmap'><texture type='checkerboard' name='normalmap'>"
        "<rgb name='color0' value='0.95, 0.5, 0.7'/><rgb name='color1' value='0.1, 0.4, 0.75'/>"
        "<transform name='to_uv'><scale value='8'/></transform></texture>" +
        diffuse(0.8) + boolean("flip_invalid_normals", false) + "</bsdf>";
    content_ += shape("rectangle", scale(5) + translate({0, 0, -1.9}), tilted) +
                shape("rectangle", scale(5) + look({0, 0.01, 0}, {0, 1, 0}), tilted);
    const RepeatedRenders own(scene(1), 256, 0, 48);
    const RepeatedRenders shared(scene(4), 128, 1000, 48);
    EXPECT_TRUE(image_matches(shared.mean, shared.variance, own.mean, own.variance));
}

TEST_F(PathReuse, G11_AgreesWithEarlyRoulette) {
    const RepeatedRenders own(scene(1), 256, 0, 48);
    const RepeatedRenders shared(scene(4, integer("rr_depth", 1)), 192, 2000, 48);
    EXPECT_TRUE(image_matches(shared.mean, shared.variance, own.mean, own.variance));
}

/// The medium in which the camera is, if the name is empty.
std::string medium(const std::string& name, const std::string& inside) {
    return "<medium type='homogeneous' name='" + name + "'>" + inside + "</medium>";
}
std::string color(const std::string& name, const std::string& value) {
    return "<rgb name='" + name + "' value='" + value + "'/>";
}

class VolumePathReuse : public PathReuse {
protected:
    /// `around`: the medium of the camera; `more`: shapes.
    void expect_agreement(const std::string& around, const std::string& more = "") {
        const std::string life = still_life((folder_ / "sphere.obj").string(), around) + more;
        const auto scene = [&](int reuse) {
            return TestScene("<integrator type='volpath'>" + integer("reuse", reuse) +
                             integer("max_depth", 5) + "</integrator>" + life);
        };
        const RepeatedRenders own(scene(1), 256, 0, 48);
        for (const int reuse : {2, 8}) {
            const RepeatedRenders shared(scene(reuse), reuse == 8 ? 32 : 128, 1000, 48);
            EXPECT_TRUE(image_matches(shared.mean, shared.variance, own.mean, own.variance))
                << reuse;
        }
    }
};

TEST_F(VolumePathReuse, G11_AgreesWithoutMedia) { expect_agreement(""); }

TEST_F(VolumePathReuse, G11_AgreesInColouredFog) {
    expect_agreement(medium("", color("sigma_t", "0.1, 0.3, 0.6") + color("albedo", "1, 0.8, 0.5") +
                                    "<phase type='hg'>" + number("g", 0.6) + "</phase>"));
}

/// Panes, holes and veils before, between and behind the vertices.
TEST_F(VolumePathReuse, G11_AgreesInFogBehindVeils) {
    const std::string veil =
        "<bsdf type='mask'><bsdf type='twosided'>" + diffuse(0.6) + "</bsdf></bsdf>";
    expect_agreement(medium("", color("sigma_t", "0.2, 0.8, 1.6") + color("albedo", "1, 0.8, 0.5")),
                     shape("rectangle", scale(2) + look({1, 1, 1.3}, {2.5, 2, 3.5}), veil) +
                         shape("rectangle", scale(0.5) + look({-0.3, 0.5, 1}, {2, 1, 3}),
                               "<bsdf type='thindielectric'/>"));
}

/// Where extinction depends on the direction.
TEST_F(VolumePathReuse, G11_AgreesAmongOrientedParticles) {
    expect_agreement(medium("", number("sigma_t", 0.3) + number("albedo", 0.9) +
                                    "<phase type='sggx'><string name='S' "
                                    "value='1, 0.1, 0.3, 0.2, 0, 0.1'/></phase>"));
}

/// Media that only absorb, that glow, that end behind glass or nothing, and one that is not the
/// same everywhere.
TEST_F(VolumePathReuse, G11_AgreesAcrossTheBoundariesOfMedia) {
    const std::string fog = number("sigma_t", 0.2) + number("albedo", 0.9);
    const std::string ink = color("sigma_a", "0.5, 1, 2");
    const std::string glow = fog + number("emission", 0.05);
    const std::string smoke =
        "<medium type='heterogeneous' name='interior'><volume type='constvolume' name='sigma_t'>" +
        number("value", 1.5) + "</volume>" + number("albedo", 0.7) + "</medium>";
    expect_agreement(
        medium("", fog),
        sphere({1.4, 0.9, 1.2}, 0.4,
               "<bsdf type='null'/>" + medium("interior", ink) + medium("exterior", fog)) +
            sphere(
                {-0.5, 1.4, 0.8}, 0.4,
                "<bsdf type='dielectric'/>" + medium("interior", glow) + medium("exterior", fog)) +
            sphere({0.3, 1.2, -0.8}, 0.5, "<bsdf type='null'/>" + smoke + medium("exterior", fog)));
}

TEST_F(VolumePathReuse, N8_ThreadsChangeNoBit) {
    const TestScene shared(
        "<integrator type='volpath'>" + integer("reuse", 4) + "</integrator>" +
        still_life((folder_ / "sphere.obj").string(), medium("", number("sigma_t", 0.3))));
    EXPECT_EQ(numbers_of(shared.render({.per_pixel = 8, .threads = 1})),
              numbers_of(shared.render({.per_pixel = 8, .threads = 7})));
}

TEST_F(PathReuse, LessNoiseInAMatteRoom) {
    const std::string room = xml({.to_world = look({0, 0, 3}, {0, 0, 0}), .fov = 20}) +
                             shape("cube", scale(4), boolean("flip_normals", true) + diffuse(0.7)) +
                             sphere({0, 3, 0}, 0.3, diffuse(0) + area_light(10));
    const auto noise = [&](int reuse) {
        const TestScene scene(path_integrator(integer("reuse", reuse)) + room);
        const RepeatedRenders images(scene, 64, 0, 24);
        return std::accumulate(images.variance.begin(), images.variance.end(), 0.0);
    };
    // Sixteen paths instead of one, but direct light stays as it is.
    EXPECT_LT(noise(4), 0.5 * noise(1));
}

TEST_F(PathReuse, H9_CropIsCutOutOfTheWholeImage) {
    const std::string crop = integer("crop_offset_x", 3) + integer("crop_offset_y", 2) +
                             integer("crop_width", 5) + integer("crop_height", 3);
    std::string cropped = content_;
    cropped.insert(cropped.find("<rfilter"), crop);
    const std::string integrator = path_integrator(integer("reuse", 4));
    const FilmState whole = TestScene(integrator + content_).render({.per_pixel = 8});
    const FilmState part = TestScene(integrator + cropped).render({.per_pixel = 8});
    for (std::size_t i = 0; i < part.pixel_count(); ++i) {
        const std::size_t in_whole = 3 + i % 5 + 12 * (2 + i / 5);
        for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(part.mean(i, c), whole.mean(in_whole, c));
    }
}

TEST_F(PathReuse, N8_ThreadsChangeNoBit) {
    const TestScene shared = scene(4);
    EXPECT_EQ(numbers_of(shared.render({.per_pixel = 8, .threads = 1})),
              numbers_of(shared.render({.per_pixel = 8, .threads = 7})));
}

}  // namespace
}  // namespace lucerna
