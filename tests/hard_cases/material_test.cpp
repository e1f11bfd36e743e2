// SPDX-License-Identifier: Apache-2.0
/// Materials at the ends of their ranges, in whole renders.
#include "core/interfaces/bsdf.h"
#include "core/interfaces/shape.h"
#include "tests/paths.h"
#include "tests/render_scene.h"

#include <fmt/format.h>

namespace lucerna {
namespace {

/// Bright ground, dark sky, a lamp: what a reflection shows depends on its direction.
std::string surroundings() {
    return shape("rectangle", scale(50) + "<rotate x='1' angle='-90'/>" + translate({0, -3, 0}),
                 diffuse(0) + area_light(1)) +
           sphere({3, 5, 2}, 1, diffuse(0) + area_light(4)) + constant_light(0.1);
}

std::string view(const std::string& sampler = "sobol") {
    return xml({.to_world = look({0, 1, 5}, {0, 0, 0}),
                .fov = 28,
                .width = 16,
                .height = 16,
                .sampler = sampler});
}

FilmState ball(const std::string& bsdf, std::uint64_t samples) {
    const TestScene scene(path_integrator(integer("max_depth", 8)) + surroundings() + view() +
                          sphere({0, 0, 0}, 1, bsdf));
    const FilmState film = scene.render({.per_pixel = samples});
    EXPECT_EQ(film.dropped_samples(), 0u);
    return film;
}

TEST(Roughness, D1_TheLimitIsSmooth) {
    const double metal = pixel_statistics(ball("<bsdf type='conductor'/>", 128)).mean();
    const double glass = pixel_statistics(ball("<bsdf type='dielectric'/>", 512)).mean();
    for (const char* distribution : {"beckmann", "ggx"}) {
        for (const double alpha : {0.0, 1e-4, 1e-3, 2e-3, 1e-2}) {
            const std::string inside = number("alpha", alpha) +
                                       "<string name='distribution' value='" + distribution + "'/>";
            EXPECT_NEAR(
                pixel_statistics(ball("<bsdf type='roughconductor'>" + inside + "</bsdf>", 128))
                        .mean() /
                    metal,
                1, 0.02)
                << distribution << alpha;
            EXPECT_NEAR(
                pixel_statistics(ball("<bsdf type='roughdielectric'>" + inside + "</bsdf>", 512))
                        .mean() /
                    glass,
                1, 0.02)
                << distribution << alpha;
        }
    }
}

/// Rays parallel to the axis of a ball of glass meet behind it. At height h they are turned by
/// 2 (θ − θ') at each of two equal refractions, and cross the axis at h / sin of that from the
/// centre. An offset of their origins along the normal would move the focus.
TEST(Glass, B4_ABallLensFocusesWhereItShould) {
    for (const double size : {1e-3, 1.0, 1e4}) {
        const TestScene scene(sphere({0, 0, 0}, size,
                                     "<bsdf type='dielectric'>" + number("int_ior", 1.5) +
                                         number("ext_ior", 1) + "</bsdf>"));
        for (const double h : {0.02, 0.1, 0.3, 0.6, 0.9}) {
            const double turned = 2 * (std::asin(h) - std::asin(h / 1.5));
            Ray ray{.o = Vector3(Vector3d(h * size, 0, -2 * size)), .d = {0, 0, 1}};
            for (int surface = 0; surface < 2; ++surface) {
                const std::optional<Interaction> hit = scene.scene().intersect(ray);
                ASSERT_TRUE(hit);
                // The last of the unit interval is what is not reflected.
                const auto refracted = hit->shape->bsdf()->sample(
                    *hit, hit->to_local(-ray.d), one_minus_epsilon, {}, TransportMode::radiance);
                ASSERT_TRUE(refracted);
                ASSERT_EQ(refracted->lobe, Lobe::specular_transmission);
                ray = hit->spawn_ray(hit->to_world(refracted->wi));
            }
            const double crossing = double(ray.o.z) - double(ray.o.x) * ray.d.z / ray.d.x;
            EXPECT_NEAR(crossing / (h * size / std::sin(turned)), 1, 1e-5) << size << " " << h;
        }
    }
}

/// Glass of the index of air is not there: the same numbers, pixel by pixel.
TEST(Glass, D7_AnIndexOfOneIsInvisible) {
    const std::string nothing =
        "<bsdf type='dielectric'>" + number("int_ior", 1) + number("ext_ior", 1) + "</bsdf>";
    const FilmState empty = ball("<bsdf type='null'/>", 16), there = ball(nothing, 16);
    for (std::size_t i = 0; i < empty.pixel_count(); ++i) {
        EXPECT_NEAR(there.mean(i, 0), empty.mean(i, 0), 1e-5);
    }
}

/// Almost the index of air, seen at all angles up to grazing ones.
TEST(Glass, D8_AnIndexNearOneIsNearlyInvisible) {
    const std::string thin_air =
        "<bsdf type='dielectric'>" + number("int_ior", 1.0001) + number("ext_ior", 1) + "</bsdf>";
    const RunningStatistics empty = pixel_statistics(ball("<bsdf type='null'/>", 64));
    const RunningStatistics there = pixel_statistics(ball(thin_air, 64));
    EXPECT_NEAR(there.mean() / empty.mean(), 1, 0.01);
}

/// A ball of few triangles with normals as round as a sphere's, light outside, camera inside.
TEST(SmoothNormals, D13_DoNotLeakLightThroughAWall) {
    const TemporaryFolder folder;
    write_file(folder / "ball.obj", sphere_obj(5, true));
    for (const std::string& bsdf :
         {diffuse(1), std::string("<bsdf type='roughplastic'/>"),
          std::string("<bsdf type='roughconductor'>") + number("alpha", 0.5) + "</bsdf>",
          std::string("<bsdf type='conductor'/>")}) {
        const TestScene scene(path_integrator() +
                                  "<shape type='obj'><string name='filename' value='ball.obj'/>"
                                  "<bsdf type='twosided'>" +
                                  bsdf + "</bsdf></shape>" + constant_light(1) +
                                  point_light({0, 0, 1.5}, 100) +
                                  sphere({3, 0, 0}, 1, area_light(10)) +
                                  xml({.to_world = look({0.1, 0.2, 0.3}, {1, 0, 0}),
                                       .fov = 120,
                                       .width = 32,
                                       .height = 32}),
                              folder.path());
        EXPECT_TRUE(is_constant(scene.render({.per_pixel = 64}), 0)) << bsdf;
    }
}

/// Mirrored things in a mirrored place make a mirrored picture.
TEST(Mirrored, I2_O28_TheSceneMirrorsTheImage) {
    const TemporaryFolder folder;
    write_file(folder / "ball.obj", sphere_obj(8, true));
    const std::string glossy = "<bsdf type='roughconductor'>" + number("alpha_u", 0.1) +
                               number("alpha_v", 0.4) +
                               "<string name='distribution' value='ggx'/></bsdf>";
    constexpr int size = 12;
    const auto content = [&](bool mirrored) {
        const std::string flip = mirrored ? "<scale x='-1'/>" : "";
        const auto put = [&](const std::string& type, const std::string& steps,
                             const std::string& inside) {
            return shape(type, steps + flip, inside);
        };
        const double side = mirrored ? -1 : 1;
        return path_integrator(integer("max_depth", 4)) +
               xml({.to_world = look({3 * side, 2, 4}, {0, 0.3, 0}),
                    .fov = 40,
                    .width = size,
                    .height = size,
                    .sampler = "sobol"}) +
               put("rectangle", scale(5) + "<rotate x='1' angle='-90'/>", diffuse(0.5)) +
               put("cube", scale(0.4) + "<rotate y='1' angle='20'/>" + translate({-1, 0.4, 0.5}),
                   diffuse(0.7)) +
               put("obj", scale(0.5) + translate({0.3, 0.5, 0}),
                   "<string name='filename' value='ball.obj'/>" + glossy) +
               put("sphere", scale(0.3) + translate({1.2, 0.3, 0.9}), "<bsdf type='dielectric'/>") +
               put("disk", scale(0.3) + look({-0.5, 0.5, 1.5}, {1, 1, 4}), diffuse(0.3)) +
               // Large, so that caustics behind the glass are not found by rare samples alone.
               put("rectangle", scale(1.5) + look({1, 3, 1}, {0, 0, 0}),
                   diffuse(0) + area_light(0.8)) +
               point_light({-2 * side, 2, 1}, 2);
    };
    const TestScene scene(content(false), folder.path()), mirror(content(true), folder.path());
    std::vector<RunningStatistics> here(size * size), there(size * size);
    for (std::uint64_t seed = 0; seed < 16; ++seed) {
        const FilmState a = scene.render({.per_pixel = 32, .seed = seed});
        const FilmState b = mirror.render({.per_pixel = 32, .seed = seed + 100});
        for (std::size_t i = 0; i < here.size(); ++i) {
            const std::size_t x = i % size, row = i - x;
            here[i].add(a.mean(i, 0));
            there[i].add(b.mean(row + size - 1 - x, 0));
        }
    }
    for (std::size_t i = 0; i < here.size(); ++i) {
        const double error = std::hypot(here[i].standard_error(), there[i].standard_error());
        EXPECT_NEAR(here[i].mean(), there[i].mean(), 6 * error + 1e-3) << i;
    }
}

/// Normals outside the unit of length, at the horizon, or opposite to the surface.
TEST(SmoothNormals, D14_L7_OddVertexNormals) {
    const TemporaryFolder folder;
    write_file(folder / "odd.obj",
               "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
               "vn 0 0 0\nvn 1 0 0\nvn 0 0 1e-30\nvn 1e30 0 1e30\n"
               "f 1//1 2//2 3//3\nf 1//4 3//2 4//1\n");
    for (const std::string& bsdf : {diffuse(0.5), std::string("<bsdf type='roughplastic'/>"),
                                    std::string("<bsdf type='dielectric'/>")}) {
        const TestScene scene(path_integrator() + surroundings() + view("independent") +
                                  "<shape type='obj'><string name='filename' value='odd.obj'/>" +
                                  bsdf + "</shape>",
                              folder.path());
        const FilmState film = scene.render({.per_pixel = 64});
        EXPECT_EQ(film.dropped_samples(), 0u);
        EXPECT_EQ(film.empty_pixels(), 0u);
    }
}

}  // namespace
}  // namespace lucerna
