// SPDX-License-Identifier: Apache-2.0
/// Surfaces do not shadow themselves, at any scale, and near ones stay apart.
///
/// In light from everywhere each sample of a convex diffuse thing is exactly its albedo: a single
/// shadow ray that meets its own surface would show.
#include "core/interfaces/emitter.h"
#include "tests/paths.h"
#include "tests/render_scene.h"

#include <fmt/format.h>

namespace lucerna {
namespace {

const std::vector<double> scales = {1e-6, 1e-3, 1, 1e3, 1e6, 1e8};

std::string cylinder(const std::string& steps, const std::string& inside) {
    return shape("cylinder", translate({0, 0, -0.5}) + steps, inside);
}

/// Turned by odd angles, scaled, moved.
std::string placed(double size, Vector3d where) {
    return "<rotate value='1, 2, 3' angle='40'/>" + scale(size) + translate(where);
}

/// The view of something of this size.
std::string view(double size, Vector3d where, double fov = 12) {
    return xml({.to_world = look(where + size * Vector3d(3, 2, 4), where),
                .fov = fov,
                .width = 16,
                .height = 16,
                .near_clip = 1e-3 * size,
                .far_clip = 1e3 * size});
}

std::string convex_scene(const std::string& type, double size, Vector3d where) {
    const std::string steps = placed(size, where);
    const std::string thing =
        type == "cylinder" ? cylinder(steps, diffuse(0.5)) : shape(type, steps, diffuse(0.5));
    return path_integrator() + constant_light(1) + thing + view(size, where);
}

TEST(SelfShadowing, B1_B3_B8_ConvexThingsAtAllScales) {
    for (const char* type : {"rectangle", "disk", "sphere", "cube"}) {
        for (const double size : scales) {
            const TestScene scene(convex_scene(type, size, Vector3d(0)));
            const FilmState film = scene.render({.per_pixel = 64});
            // One side of flat things is black.
            if (pixel_range(film).high > 0) {
                EXPECT_TRUE(is_constant(film, 0.5)) << type << " of size " << size;
            }
        }
    }
}

TEST(SelfShadowing, B1_B9_ConvexThingsAwayFromTheOrigin) {
    for (const char* type : {"rectangle", "disk", "sphere", "cube"}) {
        for (const double distance : {10.0, 1e3, 1e5, 1e7}) {
            const Vector3d where = distance * Vector3d(0.7, -0.3, 0.9);
            const TestScene scene(convex_scene(type, 1, where));
            EXPECT_TRUE(is_constant(scene.render({.per_pixel = 64}), 0.5, 1e-4))
                << type << " at " << distance;
        }
    }
}

/// A floor cut into strips of 1000 : 1 that share their edges, and the same as fans.
std::string strips(int count, bool fan) {
    std::string text;
    for (int i = 0; i <= count; ++i) {
        const double x = 2.0 * i / count - 1;
        text += fmt::format("v {} -1 0\nv {} 1 0\n", x, fan ? 0 : x);
    }
    for (int i = 0; i < count; ++i) {
        text += fmt::format("f {} {} {}\n", 2 * i + 1, 2 * i + 3, 2 * i + 2);
        if (!fan) text += fmt::format("f {} {} {}\n", 2 * i + 3, 2 * i + 4, 2 * i + 2);
    }
    return text;
}

TEST(SelfShadowing, B5_B7_SliversInOnePlane) {
    const TemporaryFolder folder;
    int dark = 0;
    for (const bool fan : {false, true}) {
        write_file(folder / "strips.obj", strips(2000, fan));
        for (const double size : {1e-6, 1.0, 1e3, 1e8}) {
            for (const double distance : {0.0, 100.0}) {
                const Vector3d where = size * distance * Vector3d(0.7, -0.3, 0.9);
                const TestScene scene(path_integrator() + constant_light(1) +
                                          shape("obj", placed(size, where),
                                                "<string name='filename' value='strips.obj'/>"
                                                "<bsdf type='twosided'>" +
                                                    diffuse(0.5) + "</bsdf>") +
                                          view(size, where, 5),
                                      folder.path());
                const FilmState film = scene.render({});
                EXPECT_NEAR(pixel_statistics(film).mean(), 0.5, 5e-4);
                for (std::size_t i = 0; i < film.pixel_count(); ++i) {
                    dark += std::abs(film.mean(i, 0) - 0.5) > 1e-4;
                }
            }
        }
    }
    // Of 130 000 shadow and BSDF rays. No offset saves all that leave a sliver beside its edge.
    EXPECT_LE(dark, 1);
}

/// E of a point light over a floor does not depend on the unit of length.
TEST(SelfShadowing, B1_O4_PointLightOverAFloorAtAllScales) {
    for (const double size : scales) {
        const TestScene scene(path_integrator() +
                              shape("rectangle", scale(10 * size), diffuse(0.5)) +
                              point_light({size, 0, 2 * size}, 10 * size * size) +
                              xml({.to_world = look({0, 0, size}, {0, 0, 0}),
                                   .near_clip = 1e-3 * size,
                                   .far_clip = 1e3 * size}));
        EXPECT_TRUE(agrees(pixel_statistics(scene.render({})), 0.2847050)) << size;
    }
}

/// A still life with shadows and reflections, in another unit of length, or elsewhere.
std::string still_life(double size, Vector3d where) {
    const auto at = [&](double x, double y, double z) { return where + size * Vector3d(x, y, z); };
    const auto steps = [&](double factor, Vector3d p) {
        return scale(factor * size) + translate(p);
    };
    return direct_integrator() +
           xml({.to_world = look(at(3, 2, 4), at(0, 0.5, 0)),
                .fov = 40,
                .width = 24,
                .height = 24,
                .near_clip = 1e-3 * size,
                .far_clip = 1e3 * size,
                .sampler = "sobol"}) +
           shape("rectangle", "<rotate x='1' angle='-90'/>" + steps(5, where), diffuse(0.5)) +
           sphere(at(0, 0.5, 0), 0.5 * size, diffuse(0.7)) +
           shape("cube", steps(0.3, at(-1, 0.3, 0.5)), diffuse(0.7)) +
           shape("rectangle", "<rotate x='1' angle='90'/>" + steps(0.5, at(0.5, 3, 0.5)),
                 diffuse(0) + area_light(5)) +
           point_light(at(2, 2, 0), size * size) +
           fmt::format(
               "<emitter type='spot'><rgb name='intensity' value='{}'/>"
               "<transform name='to_world'>{}</transform></emitter>",
               3 * size * size, look(at(-2, 3, 1), at(0, 0, 0)));
}

/// The same random numbers: all but pixels at edges are the same up to rounding.
void expect_same_picture(const FilmState& a, const FilmState& b, const std::string& what) {
    const std::vector<double> x = numbers_of(a), y = numbers_of(b);
    ASSERT_EQ(x.size(), y.size());
    const double mean = pixel_statistics(b).mean();
    EXPECT_GT(mean, 0);
    EXPECT_NEAR(pixel_statistics(a).mean() / mean, 1, 5e-3) << what;
    std::size_t different = 0;
    for (std::size_t i = 0; i < x.size(); ++i) different += std::abs(x[i] - y[i]) > 0.02 * mean;
    EXPECT_LE(different, x.size() / 20) << what;
}

TEST(SelfShadowing, B1_B3_I4_O28_StillLifeAtAllScales) {
    const FilmState reference = TestScene(still_life(1, Vector3d(0))).render({.per_pixel = 64});
    for (const double size : scales) {
        const TestScene scene(still_life(size, Vector3d(0)));
        expect_same_picture(scene.render({.per_pixel = 64}), reference,
                            fmt::format("size {}", size));
    }
}

TEST(SelfShadowing, B9_O28_StillLifeFarFromTheOrigin) {
    const FilmState reference = TestScene(still_life(1, Vector3d(0))).render({.per_pixel = 64});
    for (const double distance : {1e3, 1e5, 1e6, 1e7}) {
        // Halves and tenths that no float holds at this distance.
        const Vector3d where = distance * Vector3d(1, -0.5, 0.25) + Vector3d(0.3, 0.7, 0.1);
        const TestScene scene(still_life(1, where));
        expect_same_picture(scene.render({.per_pixel = 64}), reference,
                            fmt::format("distance {}", distance));
    }
}

/// Layers of positions tell where things are in the file, not where the scene was moved to.
TEST(SelfShadowing, B9_PositionsOfAFarSceneAreThoseOfTheFile) {
    const Vector3d where(1e6, -2e6, 3e6);
    const TestScene scene(
        "<integrator type='aov'><string name='aovs' value='p:position'/></integrator>" +
        sphere(where, 1, "") + view(1, where, 1));
    EXPECT_NE(scene.scene().origin(), Vector3d(0));
    const FilmState film = scene.render({});
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double expected = where[static_cast<int>(axis)];
        EXPECT_NEAR(pixel_statistics(film, 4 + axis).mean(), expected, 1.5);
    }
}

/// A sphere in a shell that is 10⁻⁵ of its radius wider: both are met, in order.
TEST(ThinGaps, B2_ShellAroundASphere) {
    for (const double gap : {4e-5, 1e-5}) {
        const TestScene test(sphere({0, 0, 0}, 1, "") + sphere({0, 0, 0}, 1 + gap, ""));
        for (int i = 0; i < 2000; ++i) {
            const double z = (i + 0.5) / 1000 - 1, phi = 2.4 * i, r = std::sqrt(1 - z * z);
            const Vector3 n(Vector3d(r * std::cos(phi), r * std::sin(phi), z));
            const Ray ray{.o = 3.0f * n, .d = -n};
            const auto outer = test.scene().intersect(ray);
            ASSERT_TRUE(outer);
            EXPECT_EQ(outer->shape, test.scene().shapes()[1]);
            const auto inner = test.scene().intersect(outer->spawn_ray(ray.d));
            ASSERT_TRUE(inner);
            EXPECT_EQ(inner->shape, test.scene().shapes()[0]) << i;
        }
    }
}

/// Panes 10⁻⁵ apart, through which the wall behind is seen.
TEST(ThinGaps, B2_B12_StackOfPanes) {
    std::string panes;
    for (int i = 0; i < 10; ++i) {
        panes += shape("rectangle", translate({0, 0, 1e-5 * i}), "<bsdf type='null'/>");
    }
    const TestScene scene(path_integrator(integer("rr_depth", 100)) + panes +
                          shape("rectangle", translate({0, 0, -1e-5}), area_light(1)) +
                          xml({.to_world = look({0.3, 0.2, 2}, {0, 0, 0}), .fov = 10}));
    EXPECT_TRUE(is_constant(scene.render({}), 1));
}

/// Shadow rays that end on a light are not blocked by it.
TEST(ShadowRays, B6_LightsDoNotBlockThemselves) {
    const TemporaryFolder folder;
    write_file(folder / "sphere.obj", sphere_obj(30, true));
    const std::vector<std::string> lights = {"rectangle", "disk", "sphere",
                                             "cylinder",  "cube", "obj"};
    for (const Vector3d where : {Vector3d(0), Vector3d(100, -50, 70)}) {
        for (const double size : {1e-4, 1.0, 1e4}) {
            for (const std::string& type : lights) {
                const bool flat = type == "rectangle" || type == "disk";
                const std::string turn = flat ? "<rotate value='1, 0.2, 0' angle='160'/>"
                                              : "<rotate value='1, 2, 3' angle='70'/>";
                const std::string file =
                    type == "obj" ? "<string name='filename' value='sphere.obj'/>" : "";
                const TestScene test(
                    shape(type,
                          turn + scale(0.3 * size) +
                              translate(size * (where + Vector3d(0.3, 0.2, 2))),
                          file + area_light(1)) +
                        shape("rectangle", scale(size) + translate(size * where), diffuse(1)),
                    folder.path());
                const Scene& scene = test.scene();
                const Shape& floor = *scene.shapes().back();
                int samples = 0, blocked = 0;
                for (int i = 0; i < 20000; ++i) {
                    const auto u = [&](double step) {
                        return static_cast<float>(i * step - std::floor(i * step));
                    };
                    Interaction at;
                    floor.fill({}, {.uv = {u(0.7548776662), u(0.5698402909)}}, at);
                    const Receiver from = at.receiver(at.n, Sides::front);
                    const auto& light =
                        scene.lights()[static_cast<std::size_t>(i) % scene.lights().size()];
                    const auto to =
                        light.emitter->sample_li(light, from, {u(0.8191725134), u(0.6710436067)});
                    if (!to || glm::dot(to->wi, from.n) <= 0) continue;
                    // Of a convex light what faces the receiver is seen; a tube shows its inside,
                    // which does not shine.
                    ++samples;
                    blocked += scene.occluded(from, *to);
                }
                EXPECT_GT(samples, 4000) << type;
                // Grazing samples at the rim of a coarse mesh may be behind it.
                EXPECT_LE(blocked, type == "cylinder" ? samples / 2 : 0)
                    << type << " of size " << size << " at " << text_of(where);
            }
        }
    }
}

/// A light that almost touches the floor, and one that cuts through it.
TEST(ShadowRays, B10_E16_LightsThatTouchASurface) {
    const auto floor_under = [](const std::string& light, Vector3d p) {
        const std::string camera =
            xml({.to_world = look(p + Vector3d(0, 0, 4e-6), p), .near_clip = 1e-7});
        return TestScene(direct_integrator() + camera + light +
                         shape("rectangle", scale(3), diffuse(0.5)));
    };
    for (const double height : {1e-2, 1e-4, 1e-5}) {
        const std::string lamp =
            shape("rectangle", scale(0.5) + look({0, 0, height}, {0, 0, 0}), area_light(1));
        const std::vector<Vector3d> corners = {
            {-0.5, -0.5, height}, {0.5, -0.5, height}, {0.5, 0.5, height}, {-0.5, 0.5, height}};
        const double e = polygon_irradiance(corners, {0.1, 0.2, 0}, {0, 0, 1});
        const TestScene scene = floor_under(lamp, {0.1, 0.2, 0});
        EXPECT_TRUE(agrees(pixel_statistics(scene.render({.per_pixel = 2048})), e / (2 * pi)))
            << height;
    }
    for (const double distance : {0.3, 1e-2, 1e-3}) {
        // A wall through the floor: only what is above counts.
        const std::string wall =
            shape("rectangle", scale(0.5) + look({0, 0, 0}, {1, 0, 0}), area_light(1));
        const std::vector<Vector3d> corners = {
            {0, -0.5, -0.5}, {0, 0.5, -0.5}, {0, 0.5, 0.5}, {0, -0.5, 0.5}};
        const double e = polygon_irradiance(corners, {distance, 0.1, 0}, {0, 0, 1});
        const TestScene scene = floor_under(wall, {distance, 0.1, 0});
        const FilmState film = scene.render({.per_pixel = 8192});
        EXPECT_EQ(film.dropped_samples(), 0u);
        EXPECT_TRUE(agrees(pixel_statistics(film), e / (2 * pi), 0.003)) << distance;
    }
}

/// A ball of light that lies on the floor: near the contact half of the sky is bright.
TEST(ShadowRays, B10_BallOfLightOnTheFloor) {
    for (const double x : {1.0, 0.1, 0.03}) {
        const TestScene scene(direct_integrator() + sphere({0, 0, 1}, 1, area_light(1)) +
                              shape("rectangle", scale(3), diffuse(0.5)) +
                              xml({.to_world = look({x, 0, 1e-4}, {x, 0, 0}), .near_clip = 1e-6}));
        // O7 with its horizon: half of the ball's cone is below the floor for no x, since the
        // ball stands on it; c = 1 / d, s = 1 / d, so E = π s² c.
        const double d = std::hypot(x, 1.0);
        const FilmState film = scene.render({.per_pixel = 4096});
        EXPECT_EQ(film.dropped_samples(), 0u);
        EXPECT_TRUE(agrees(pixel_statistics(film), 0.5 / (d * d * d))) << x;
    }
}

}  // namespace
}  // namespace lucerna
