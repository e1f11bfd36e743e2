// SPDX-License-Identifier: Apache-2.0
/// Photon mapping where there is little to see, nothing to hit, or much in one place.
#include "core/base/error.h"
#include "core/interfaces/texture.h"
#include "tests/render_scene.h"

#include <fmt/format.h>

#include <limits>

namespace lucerna {
namespace {

std::string integrator(const std::string& type, const std::string& inside = "") {
    return "<integrator type='" + type + "'>" + inside + "</integrator>";
}

const std::string mirror = "<bsdf type='conductor'/>";

class PhotonHardCases : public testing::TestWithParam<const char*> {
protected:
    std::string type() const { return GetParam(); }
};

/// Nothing to see, nothing to hit, nothing to store: black or the light itself, never an error.
TEST_P(PhotonHardCases, F3_F5_ScenesWithoutMuch) {
    const std::string camera = xml({.to_world = look({0, 0, 0}, {0, 0, 1}), .fov = 20});
    const std::string wall = shape("rectangle", look({0, 0, 1}, {0, 0, 0}), diffuse(0.5));
    const std::string glass = shape("rectangle", look({0, 0, 1}, {0, 0, 0}), mirror);
    const std::string few = type() == "photonmap"
                                ? integer("global_photons", 1) + integer("caustic_photons", 1) +
                                      number("global_lookup_radius", 1e6)
                                : "";
    const std::string dark[] = {"",
                                wall,
                                glass,
                                wall + point_light({0, 0, 3}, 1),
                                wall + point_light({0, 0, 0.5}, 0),
                                point_light({0, 0, 0.5}, 1)};
    for (const std::string& scene : dark) {
        const FilmState film =
            TestScene(integrator(type(), few) + camera + scene).render({.per_pixel = 2});
        EXPECT_TRUE(is_constant(film, 0)) << scene;
    }
    for (const std::string& scene :
         {wall + point_light({0, 0, 0.5}, 1), glass + point_light({0, 0, 0.5}, 1)}) {
        const FilmState film =
            TestScene(integrator(type(), few) + camera + scene).render({.per_pixel = 2});
        EXPECT_EQ(film.dropped_samples(), 0u) << scene;
    }
}

/// A cube with a mirror ball and a lamp, seen from inside, everything `unit` times as large.
std::string room_of_size(double unit) {
    const auto at = [&](Vector3d p) { return unit * p; };
    return "<shape type='cube'><transform name='to_world'>" + scale(unit) + "</transform>" +
           boolean("flip_normals", true) + diffuse(0.5) + "</shape>" +
           sphere(at({0.25, -0.5, 0.25}), 0.25 * unit, mirror) +
           shape("rectangle", scale(0.25 * unit) + look(at({0, 0.75, 0}), at({0, 0, 0})),
                 diffuse(0) + area_light(4)) +
           xml({.to_world = look(at({0, 0, -0.75}), at({0, -0.5, 0.5})),
                .fov = 60,
                .near_clip = 1e-3 * unit,
                .far_clip = 1e3 * unit});
}

/// Powers of two change exponents alone: the same picture to the last bits, from a micrometre to
/// a thousand kilometres.
TEST_P(PhotonHardCases, TinyAndHugeScenes) {
    const std::string few = type() == "sppm" ? integer("photon_count", 5000)
                            : type() == "photonmap"
                                ? integer("global_photons", 5000) + integer("caustic_photons", 1000)
                                : "";
    const std::string how = integrator(type(), few);
    const auto picture = [&](double unit) {
        const FilmState film =
            TestScene(how + room_of_size(unit)).render({.per_pixel = 4, .seed = 1});
        EXPECT_EQ(film.dropped_samples(), 0u);
        return pixel_statistics(film);
    };
    const RunningStatistics normal = picture(1);
    EXPECT_GT(normal.mean(), 0.01);
    for (const double unit : {0x1p-20, 0x1p20}) {
        EXPECT_NEAR(picture(unit).mean(), normal.mean(), 1e-4 * normal.mean()) << unit;
    }
}

/// Edges and corners of a room, looked at from very near.
TEST_P(PhotonHardCases, F7_EdgesAndCorners) {
    for (const Vector3d target : {Vector3d(1, 1, 1), Vector3d(1, -1, 0), Vector3d(0, 1, 1)}) {
        const FilmState film =
            TestScene(integrator(type()) + "<shape type='cube'>" + boolean("flip_normals", true) +
                      diffuse(0.5) + "</shape>" + point_light({0, 0, 0}, 1) +
                      xml({.to_world = look(0.99 * target, target), .fov = 90}))
                .render({.per_pixel = 4});
        EXPECT_EQ(film.dropped_samples(), 0u);
        const Interval range = pixel_range(film);
        EXPECT_GE(range.low, 0);
        EXPECT_LT(range.high, 1) << "irradiance by the light alone is at most 1";
    }
}

/// A wall that is thinner than any radius parts a room: the dark half stays black.
TEST_P(PhotonHardCases, F8_ThinWalls) {
    const std::string wall = shape("cube", "<scale x='1' y='1' z='0.0005'/>", diffuse(0.5));
    const FilmState film =
        TestScene(integrator(type()) + "<shape type='cube'>" + boolean("flip_normals", true) +
                  diffuse(0.5) + "</shape>" + wall + point_light({0, 0, 0.5}, 10) +
                  xml({.to_world = look({0, 0, -0.9}, {0, 0, 0}), .fov = 80}))
            .render({.per_pixel = 4});
    EXPECT_TRUE(is_constant(film, 0));
}

/// What a scene is refused with while it is rendered.
std::string refusal(const TestScene& scene) {
    try {
        scene.render({.per_pixel = 1});
    } catch (const SceneError& error) {
        return error.what();
    }
    return "nothing was said";
}

/// A wide filter reaches over the border of the image, where pixels are to be as bright as others.
TEST_P(PhotonHardCases, H3_TheBorderIsAsBrightAsTheMiddle) {
    const TestScene scene(integrator(type()) + shape("rectangle", scale(1.5), diffuse(0.5)) +
                          constant_light(1) +
                          xml({.to_world = look({0, 0, 1}, {0, 0, 0}),
                               .width = 12,
                               .height = 12,
                               .rfilter = "gaussian",
                               .type = "orthographic"}));
    // Noise of ½ % at the border.
    const FilmState film = scene.render({.per_pixel = type() == "ptracer" ? 4096u : 8u});
    RunningStatistics border, middle;
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        const std::size_t x = i % 12, y = i / 12;
        const bool outside = x == 0 || y == 0 || x == 11 || y == 11;
        const bool inside = x > 2 && y > 2 && x < 9 && y < 9;
        if (outside || inside) (outside ? border : middle).add(film.mean(i, 0));
    }
    EXPECT_NEAR(border.mean() / middle.mean(), 1, 0.02);
    EXPECT_NEAR(middle.mean(), 0.5, 0.01);
}

TEST_P(PhotonHardCases, FluxThatIsNotFiniteIsRefusedWithItsOrigin) {
    const TestScene scene(integrator(type()) + shape("rectangle", scale(1), diffuse(0.5)) +
                          point_light({0, 0, 2}, 1) + point_light({1, 2, 3}, 1e38) +
                          xml({.to_world = look({0, 0, 1}, {0, 0, 0})}));
    EXPECT_EQ(refusal(scene),
              "error: light number 1 of the scene, at (1, 2, 3), emits photons of a power that is "
              "not finite");
}

/// A texture that is no number everywhere, whatever it says about its mean.
class UnknownTexture final : public Texture {
public:
    explicit UnknownTexture(const Params&) {}
    Color color(Vector2) const override { return Color(std::numeric_limits<float>::quiet_NaN()); }
    float real(Vector2) const override { return std::numeric_limits<float>::quiet_NaN(); }
    Color mean() const override { return Color(1); }
    float max() const override { return 1; }
};

const PluginInfo unknown_texture = describe<UnknownTexture>("for this test");

std::string with_unknown(const std::string& parameter) {
    return "<texture type='unknown' name='" + parameter + "'/>";
}

TEST_P(PhotonHardCases, LightThatIsNoNumberIsRefusedWithItsOrigin) {
    Registry registry;
    registry.add("unknown", unknown_texture);
    const TestScene scene(
        integrator(type()) + shape("rectangle", scale(1), diffuse(0.5)) +
            shape("rectangle", scale(1e-9) + look({1, 2, 3}, {1, 2, 0}),
                  "<emitter type='area'>" + with_unknown("radiance") + "</emitter>") +
            xml({.to_world = look({0, 0, 1}, {0, 0, 0})}),
        std::move(registry));
    EXPECT_EQ(refusal(scene),
              "error: light number 0 of the scene, at (1, 2, 3), emits photons of a power that is "
              "not finite");
}

/// Also in a scene that is moved to the origin, being small and far away.
TEST_P(PhotonHardCases, SurfaceThatIsNoNumberIsRefusedWithItsPlace) {
    Registry registry;
    registry.add("unknown", unknown_texture);
    const TestScene scene(
        integrator(type()) +
            shape("rectangle", scale(1e-9) + translate({1, 2, 0}),
                  "<bsdf type='diffuse'>" + with_unknown("reflectance") + "</bsdf>") +
            "<emitter type='directional'><vector name='direction' x='0' y='0' z='-1'/></emitter>" +
            xml({.to_world = look({0, 0, 1}, {0, 0, 0})}),
        std::move(registry));
    EXPECT_EQ(refusal(scene),
              "error: a photon that is scattered at (1, 2, 0) has a power that is not finite");
}

INSTANTIATE_TEST_SUITE_P(All, PhotonHardCases, testing::Values("photonmap", "sppm", "ptracer"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace lucerna
