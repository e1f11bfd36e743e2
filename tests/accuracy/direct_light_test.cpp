// SPDX-License-Identifier: Apache-2.0
/// Irradiance of a point by lights of all kinds, against closed forms.
#include "core/image/exr.h"
#include "tests/paths.h"
#include "tests/render_scene.h"

#include <fmt/format.h>

#include <functional>

namespace lucerna {
namespace {

using std::numbers::pi;

const std::string mis = direct_integrator();
const std::string lights_only = direct_integrator(integer("bsdf_samples", 0));

/// A small diffuse square of albedo ½ around p that looks along n, and a camera that sees it.
std::string receiver(Vector3d p, Vector3d n) {
    return shape("rectangle", scale(1e-4) + look(p, p + n), diffuse(0.5)) + probe(p, n, 5e-4);
}

/// What the light in `xml` brings to the receiver.
RunningStatistics irradiance(const std::string& xml, Vector3d p, Vector3d n, std::uint64_t samples,
                             const std::string& integrator = mis,
                             const std::filesystem::path& folder = ".") {
    const FilmState film =
        TestScene(integrator + receiver(p, n) + xml, folder).render({.per_pixel = samples});
    EXPECT_EQ(film.dropped_samples(), 0u);
    RunningStatistics result;
    for (std::size_t i = 0; i < film.pixel_count(); ++i) result.add(film.mean(i, 0) * 2 * pi);
    return result;
}

constexpr Vector3d origin(0), up(0, 0, 1);

TEST(DirectLight, O4_C16_PointLightOverAFloor) {
    const std::string light = point_light({1, 0, 2}, 10);
    EXPECT_TRUE(agrees(irradiance(light, origin, up, 4), 1.7888544, 1e-4));
    const FilmState film = TestScene(path_integrator() + receiver(origin, up) + light).render({});
    EXPECT_TRUE(agrees(pixel_statistics(film), 0.2847050, 1e-4));
}

TEST(DirectLight, O5_DirectionalLight) {
    const std::string light =
        "<emitter type='directional'><vector name='direction' value='0.8660254, 0, -0.5'/>"
        "</emitter>";
    EXPECT_TRUE(agrees(irradiance(light, origin, up, 4), 0.5, 1e-4));
}

/// The unit square at height 1 that faces down, as a rectangle and as two triangles.
const std::string square =
    shape("rectangle", scale(0.5) + look({0, 0, 1}, {0, 0, 0}), diffuse(0) + area_light(1));
const std::string square_mesh =
    "<shape type='obj'><string name='filename' value='square.obj'/>" + area_light(1) + "</shape>";
const char* const square_obj = "v -.5 -.5 1\nv .5 -.5 1\nv .5 .5 1\nv -.5 .5 1\nf 1 3 2\nf 1 4 3\n";

TEST(DirectLight, P8_ShapesReferToOneEmitter) {
    const std::string lamp = "<ref id='lamp'/>";
    const std::string scene =
        "<emitter type='area' id='lamp'><rgb name='radiance' value='1'/></emitter>" +
        shape("rectangle", scale(0.5) + look({0, 0, 1}, {0, 0, 0}), diffuse(0) + lamp) +
        shape("rectangle", scale(0.5) + look({2, 0, 1}, {2, 0, 0}), diffuse(0) + lamp);
    double expected = 0;
    for (const double x : {0.0, 2.0}) {
        expected += polygon_irradiance(
            {{x - 0.5, -0.5, 1}, {x + 0.5, -0.5, 1}, {x + 0.5, 0.5, 1}, {x - 0.5, 0.5, 1}}, origin,
            up);
    }
    EXPECT_TRUE(agrees(irradiance(scene, origin, up, 256), expected));
}

struct SquareCase {
    Vector3d p, n;
    double irradiance;
};
const std::vector<SquareCase> square_cases = {{origin, up, 0.752274688},
                                              {{0.75, 0.3, 0}, {0.3, -0.2, 1}, 0.301061350},
                                              {origin, {1, 0, 0.2}, 0.176308422}};

TEST(DirectLight, O6_C4_RectangleLight) {
    for (const SquareCase& c : square_cases) {
        EXPECT_TRUE(agrees(irradiance(square, c.p, c.n, 4096), c.irradiance));
    }
    const FilmState floor =
        TestScene(path_integrator() + receiver(origin, up) + square).render({.per_pixel = 4096});
    EXPECT_TRUE(agrees(pixel_statistics(floor), 0.119728235));
}

TEST(DirectLight, O6_MeshLight) {
    const TemporaryFolder folder;
    write_file(folder / "square.obj", square_obj);
    for (const SquareCase& c : square_cases) {
        EXPECT_TRUE(
            agrees(irradiance(square_mesh, c.p, c.n, 6144, mis, folder.path()), c.irradiance));
    }
}

/// Near the plane of the light, and near its edge, where it fills a quarter of all directions.
TEST(DirectLight, C8_E16_ReceiverNearThePlaneOfTheLight) {
    const std::vector<Vector3d> corners = {
        {-0.5, -0.5, 1}, {0.5, -0.5, 1}, {0.5, 0.5, 1}, {-0.5, 0.5, 1}};
    for (const Vector3d p : {Vector3d(2, 0, 0.99), Vector3d(0.5, 0, 0.99), Vector3d(0.5, 0, 0.999),
                             Vector3d(0.2, 0.1, 0.999)}) {
        for (const Vector3d n : {Vector3d(-1, 0, 0), Vector3d(-1, 0, 1)}) {
            const double expected = polygon_irradiance(corners, p, n);
            EXPECT_TRUE(agrees(irradiance(square, p, n, 4096), expected, 0.003)) << text_of(p);
        }
    }
    const RunningStatistics above = irradiance(square, {0.2, 0.1, 1.001}, {0, 0, -1}, 64);
    EXPECT_EQ(above.mean(), 0);
}

/// `cosine` is that of the angle between the normal and the direction to the centre.
RunningStatistics sphere_irradiance(double radius, double distance, double cosine,
                                    std::uint64_t samples) {
    const Vector3d center = distance * Vector3d(std::sqrt(1 - cosine * cosine), 0, cosine);
    const std::string light = sphere(center, radius, diffuse(0) + area_light(1));
    return irradiance(light, origin, up, samples);
}

TEST(DirectLight, O7_C1_C4_SphereLight) {
    EXPECT_TRUE(agrees(sphere_irradiance(1, 3, 0.5, 2048), 0.174532925));
    EXPECT_TRUE(agrees(sphere_irradiance(1, 3, 0.2, 8192), 0.072810967));
    EXPECT_TRUE(agrees(sphere_irradiance(1, 3, 0, 16384), 0.025567229));
    EXPECT_TRUE(agrees(sphere_irradiance(1, 3, -0.2, 65536), 0.002997797, 0.003));
    EXPECT_TRUE(agrees(sphere_irradiance(1, 1000, 0.5, 1024), 1.570796e-6));
    EXPECT_TRUE(agrees(sphere_irradiance(1e-4, 100, 0.5, 1024), pi * 1e-12 * 0.5));
}

TEST(DirectLight, O8_DiskLight) {
    const std::string light = shape("disk", look({0, 0, 1}, {0, 0, 0}), diffuse(0) + area_light(1));
    EXPECT_TRUE(agrees(irradiance(light, origin, up, 4096), pi / 2));
}

/// E(x) of a disk of radius R at height h, also beside its axis (Siegel and Howell, B-12).
TEST(DirectLight, O8_O9_DiskLightBesideItsAxis) {
    const std::string light =
        shape("disk", look({1.5, 0, 1}, {1.5, 0, 0}), diffuse(0) + area_light(1));
    const double h = 1 / 1.5, r = 1 / 1.5, z = 1 + h * h + r * r;
    const double form_factor = 0.5 * (1 - (z - 2 * r * r) / std::sqrt(z * z - 4 * r * r));
    EXPECT_TRUE(agrees(irradiance(light, origin, up, 8192), pi * form_factor));
}

/// Against an integral over the surface, ∫ cos cos′ / d² dA, as a sum over a million cells.
TEST(DirectLight, O9_CylinderLight) {
    const double radius = 0.5, height = 2, distance = 2;
    const std::string light = fmt::format(
        "<shape type='cylinder'><point name='p0' value='-1, 0, {0}'/>"
        "<point name='p1' value='1, 0, {0}'/>{1}{2}</shape>",
        distance, number("radius", radius), diffuse(0) + area_light(1));
    double expected = 0;
    constexpr int cells = 1000;
    for (int i = 0; i < cells; ++i) {
        for (int j = 0; j < cells; ++j) {
            const double x = height * ((i + 0.5) / cells - 0.5), phi = 2 * pi * (j + 0.5) / cells;
            const Vector3d n(0, std::cos(phi), std::sin(phi));
            const Vector3d d = Vector3d(x, 0, distance) + radius * n;
            const double length = glm::length(d), facing = -glm::dot(n, d);
            if (facing > 0) expected += facing * d.z / (length * length * length * length);
        }
    }
    expected *= height * 2 * pi * radius / (double{cells} * cells);
    EXPECT_TRUE(agrees(irradiance(light, origin, up, 8192), expected));
}

TEST(DirectLight, O18_C20_SpotLight) {
    const auto spot = [](double cutoff, double beam) {
        return fmt::format(
            "<emitter type='spot'>{}{}<rgb name='intensity' value='8'/>"
            "<transform name='to_world'>{}</transform></emitter>",
            number("cutoff_angle", cutoff), number("beam_width", beam), look({1, 0, 2}, {1, 0, 0}));
    };
    const double full = 8 * 2 / std::pow(5, 1.5);
    const double angle = std::atan(0.5) * 180 / pi;
    EXPECT_TRUE(agrees(irradiance(spot(40, 40), origin, up, 4), full, 1e-4));
    EXPECT_TRUE(agrees(irradiance(spot(180, 180), origin, up, 4), full, 1e-4));
    EXPECT_EQ(irradiance(spot(20, 20), origin, up, 4).mean(), 0);
    EXPECT_EQ(irradiance(spot(0, 0), origin, up, 4).mean(), 0);
    EXPECT_TRUE(agrees(irradiance(spot(40, 20), origin, up, 4), full * (40 - angle) / 20, 1e-4));
}

/// Radiance 1 from all directions, made by a sphere around the receiver, also far off its centre.
TEST(DirectLight, O23_C2_C3_InsideASphereOfConstantRadiance) {
    const std::string light = "<shape type='sphere'>" + number("radius", 10) +
                              boolean("flip_normals", true) + diffuse(0) + area_light(1) +
                              "</shape>";
    for (const Vector3d p : {Vector3d(0), Vector3d(3, -4, 5), Vector3d(0, 0, 9.9)}) {
        EXPECT_TRUE(agrees(irradiance(light, p, {1, 2, 3}, 2048), pi));
    }
}

/// An environment picture whose rows are given by a function of the row.
std::string environment(const TemporaryFolder& folder, int width, int height,
                        const std::function<float(int x, int y)>& radiance) {
    ImageFile file;
    file.width = file.full_width = width;
    file.height = file.full_height = height;
    for (const char* name : {"R", "G", "B"}) {
        std::vector<float> texels;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) texels.push_back(radiance(x, y));
        }
        file.planes.push_back({.name = name, .samples = std::move(texels)});
    }
    write_exr(folder / "environment.exr", file);
    return "<emitter type='envmap'><string name='filename' value='environment.exr'/></emitter>";
}

TEST(DirectLight, O17_C11_EnvironmentOfOneTexel) {
    const TemporaryFolder folder;
    const std::string light = environment(
        folder, 1024, 512, [](int x, int y) { return x == 300 && y == 128 ? 1e6f : 0.0f; });
    EXPECT_TRUE(
        agrees(irradiance(light, origin, {0, 1, 0}, 8192, lights_only, folder.path()), 18.824304));
    EXPECT_TRUE(agrees(irradiance(light, origin, {0, 1, 0}, 8192, mis, folder.path()), 18.824304));
    EXPECT_EQ(irradiance(light, origin, {0, -1, 0}, 64, mis, folder.path()).mean(), 0);
}

TEST(DirectLight, O17_EnvironmentOfASky) {
    const TemporaryFolder folder;
    const std::string light = environment(folder, 1024, 512, [](int, int y) {
        return static_cast<float>(0.5 * (1 + std::cos(pi * (y + 0.5) / 512)));
    });
    for (const std::string& integrator : {lights_only, mis}) {
        EXPECT_TRUE(agrees(irradiance(light, origin, {0, 1, 0}, 4096, integrator, folder.path()),
                           5 * pi / 6));
    }
    const RunningStatistics below = irradiance(light, origin, {0, -1, 0}, 8192, mis, folder.path());
    EXPECT_TRUE(agrees(below, pi / 6));
}

TEST(DirectLight, O17_C12_C13_EnvironmentOfFewTexels) {
    const TemporaryFolder folder;
    for (const auto& [width, height] : {std::pair(1, 1), {1, 8}, {8, 1}, {2, 2}, {64, 32}}) {
        const std::string light = environment(folder, width, height, [](int, int) { return 1.0f; });
        for (const Vector3d n : {Vector3d(0, 1, 0), Vector3d(1, 0, 0), Vector3d(0.6, -0.8, 0)}) {
            EXPECT_TRUE(agrees(irradiance(light, origin, n, 2048, mis, folder.path()), pi))
                << width << " × " << height;
        }
    }
    const std::string black = environment(folder, 4, 2, [](int, int) { return 0.0f; });
    EXPECT_EQ(irradiance(black, origin, up, 16, mis, folder.path()).mean(), 0);
    EXPECT_TRUE(agrees(irradiance(constant_light(1), origin, up, 1024), pi));
}

TEST(DirectLight, O24_RingOfPointLights) {
    constexpr int count = 300;
    std::string lights;
    double beside = 0;  // irradiance at (1, 0, 0)
    for (int i = 0; i < count; ++i) {
        const double phi = 2 * pi * i / count;
        const Vector3d p(3 * std::cos(phi), 3 * std::sin(phi), 4);
        lights += point_light(p, 1.0 / count);
        beside += 4 / std::pow(glm::length(p - Vector3d(1, 0, 0)), 3) / count;
    }
    const std::vector<std::pair<std::string, int>> samplings = {
        {"uniform", 1}, {"power", 1}, {"uniform", count}};
    for (const auto& [sampler, each] : samplings) {
        const std::string integrator =
            direct_integrator("<light_sampler type='" + sampler + "'/>" +
                              integer("bsdf_samples", 0) + integer("emitter_samples", each));
        const std::uint64_t samples = each > 1 ? 16 : 1024;
        EXPECT_TRUE(agrees(irradiance(lights, origin, up, samples, integrator), 0.032, 1e-4));
        EXPECT_TRUE(agrees(irradiance(lights, {1, 0, 0}, up, samples, integrator), beside));
    }
}

/// A lamp 1e12 times brighter than the other is hidden by a screen.
TEST(DirectLight, O25_E5_DimLightBesideAnOccludedBrightOne) {
    const std::string lights = point_light({1, 0, 2}, 10) + point_light({-1, 0, 2}, 1e13) +
                               shape("rectangle", scale(0.2) + translate({-0.5, 0, 1}), diffuse(0));
    for (const int each : {1, 2}) {
        const std::string integrator =
            direct_integrator("<light_sampler type='uniform'/>" + integer("emitter_samples", each));
        EXPECT_TRUE(agrees(irradiance(lights, origin, up, 8192, integrator), 1.7888544));
    }
}

/// Beside the shadow edge of a far, small light half of it is seen.
TEST(DirectLight, O22_HalfOccludedLight) {
    const std::string light =
        shape("rectangle", scale(0.01) + look({0, 0, 10}, origin), diffuse(0) + area_light(1e4));
    const std::string screen =
        shape("rectangle", translate({1, 0, 0}) + scale(1) + translate({0, 0, 5}), diffuse(0));
    const RunningStatistics open = irradiance(light, origin, up, 4096);
    EXPECT_TRUE(agrees(open, 1e4 * 4e-4 / 100, 0.002));
    EXPECT_TRUE(agrees(irradiance(light + screen, origin, up, 16384), open.mean() / 2, 0.002));
}

}  // namespace
}  // namespace lucerna
