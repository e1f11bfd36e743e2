// SPDX-License-Identifier: Apache-2.0
/// Surfaces that neither make nor lose light, and those that lose a known part.
#include "core/math/fresnel.h"
#include "tests/render_scene.h"

#include <fmt/format.h>

namespace lucerna {
namespace {

using std::numbers::pi;

const std::string glass =
    "<bsdf type='dielectric'>" + number("int_ior", 1.5) + number("ext_ior", 1) + "</bsdf>";

/// T of a slab of glass by the angle of incidence, the Fresnel term averaged over polarisations at
/// each surface: (1 − F) / (1 + F) for n = 1.5.
struct SlabCase {
    double degrees, transmittance;
};
const std::vector<SlabCase> slab_cases = {
    {0, 0.923077}, {30, 0.920266}, {60, 0.836232}, {80, 0.441229}};

/// A camera above a slab at this angle, and a plane below that emits 1.
std::string view_through(const std::string& slab, double degrees) {
    const double angle = degrees * pi / 180;
    const Vector3d from = 2.0 * Vector3d(std::sin(angle), 0, std::cos(angle));
    return path_integrator() + slab +
           shape("rectangle", scale(1000) + translate({0, 0, -3}), diffuse(0) + area_light(1)) +
           xml({.to_world = look(from, {0, 0, 0}), .width = 32, .height = 32});
}

std::string slab(double thickness) {
    const double size = std::max(3.0, 100 * thickness);
    return shape("rectangle", scale(size), glass) +
           shape("rectangle", scale(size) + look({0, 0, -thickness}, {0, 0, -thickness - 1}),
                 glass);
}

TEST(GlassSlab, O11_D6_D22_TransmitsByTheAngle) {
    for (const SlabCase& c : slab_cases) {
        const TestScene scene(view_through(slab(0.1), c.degrees));
        EXPECT_TRUE(agrees(pixel_statistics(scene.render({.per_pixel = 512})), c.transmittance))
            << c.degrees;
    }
}

/// ∫ of the slab's transmittance over the hemisphere, weighted by the cosine, over π.
double mean_slab_transmittance() {
    constexpr int n = 20000;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double cosine = (i + 0.5) / n;
        const auto f = static_cast<double>(fresnel_dielectric(static_cast<float>(cosine), 1.5f));
        sum += 2 * cosine * (1 - f) / (1 + f) / n;
    }
    return sum;
}

/// Sky, glass, floor, glass, camera: with T and R = 1 − T of the slab for diffuse light, the floor
/// of reflectance ρ has the radiance ρ T / (1 − ρ R).
TEST(GlassSlab, F19_FloorSeenThroughTheGlassThatLightsIt) {
    const double t = mean_slab_transmittance(), floor = 0.5 * t / (1 - 0.5 * (1 - t));
    const double expected = 0.923077 * floor + (1 - 0.923077);
    const std::string scene =
        slab(0.03) + shape("rectangle", scale(3) + translate({0, 0, -0.04}), diffuse(0.5)) +
        constant_light(1) + xml({.to_world = look({0, 0, 2}, {0, 0, 0}), .fov = 20});
    const RunningStatistics path = image_means(path_integrator() + scene, 256);
    EXPECT_TRUE(agrees(path, expected, 0.005));
    const RunningStatistics photons = image_means("<integrator type='sppm'/>" + scene, 8, 4);
    EXPECT_NEAR(photons.mean(), expected, 0.02 * expected);
}

/// A directional light behind the slab, which only particles from the light can find: on a floor of
/// reflectance ρ, L = ρ E cos θ T(θ) / π. The floor is dark, for the slab shows it its own light.
TEST(GlassSlab, O11_O5_DirectionalLightThroughIt) {
    for (const SlabCase& c : slab_cases) {
        const double angle = c.degrees * pi / 180;
        const TestScene scene(
            "<integrator type='ptracer'/>" + slab(0.03) +
            shape("rectangle", scale(3) + translate({0, 0, -0.1}), diffuse(0.001)) +
            fmt::format("<emitter type='directional'><vector name='direction' value='{}'/>"
                        "<rgb name='irradiance' value='10'/></emitter>",
                        text_of({-std::sin(angle), 0, -std::cos(angle)})) +
            xml({.to_world = scale(2) + look({0, 0, -0.05}, {0, 0, -1}),
                 .width = 32,
                 .height = 32,
                 .type = "orthographic"}));
        const double expected = 0.001 * 10 * std::cos(angle) * c.transmittance / pi;
        // Of grazing light, little arrives.
        const double precision = c.degrees > 60 ? 0.006 : 0.002;
        const FilmState film = scene.render({.per_pixel = 2300});
        EXPECT_TRUE(agrees(pixel_statistics(film), expected, precision)) << c.degrees;
    }
}

TEST(GlassSlab, O11_ThinDielectricDoesTheSame) {
    const std::string thin =
        "<bsdf type='thindielectric'>" + number("int_ior", 1.5) + number("ext_ior", 1) + "</bsdf>";
    for (const SlabCase& c : slab_cases) {
        const TestScene scene(view_through(shape("rectangle", scale(300), thin), c.degrees));
        EXPECT_TRUE(agrees(pixel_statistics(scene.render({.per_pixel = 512})), c.transmittance))
            << c.degrees;
    }
}

TEST(GlassSlab, O11_B12_OfAnyThickness) {
    for (const double thickness : {1e-4, 1e-3, 1e-2, 1.0}) {
        const TestScene scene(view_through(slab(thickness), 60));
        EXPECT_TRUE(agrees(pixel_statistics(scene.render({.per_pixel = 512})), 0.836232))
            << thickness;
    }
}

/// Light inside glass is η² stronger, so a camera under water sees the sky as (1 − F) n².
TEST(GlassSlab, D5_D6_SkySeenFromBelowTheSurface) {
    const double n = 1.5, critical = std::asin(1 / n);
    for (const double angle : {0.0, 0.4, critical - 1e-3, critical + 1e-3, 1.2, 1.5}) {
        const Vector3d d(std::sin(angle), 0, std::cos(angle));
        const TestScene scene(
            path_integrator() + constant_light(1) + shape("rectangle", scale(300), glass) +
            shape("rectangle", scale(3000) + translate({0, 0, -100}), diffuse(0)) +
            xml({.to_world = look(-d, {0, 0, 0}), .fov = 1e-4}));
        const double cos_out = std::sqrt(std::max(0.0, 1 - sqr(n * std::sin(angle))));
        const double parallel = (std::cos(angle) - n * cos_out) / (std::cos(angle) + n * cos_out);
        const double perpendicular =
            (n * std::cos(angle) - cos_out) / (n * std::cos(angle) + cos_out);
        const double reflected = cos_out > 0 ? 0.5 * (sqr(parallel) + sqr(perpendicular)) : 1;
        const FilmState film = scene.render({.per_pixel = 16384});
        EXPECT_EQ(film.dropped_samples(), 0u);
        if (reflected == 1) {
            EXPECT_EQ(pixel_statistics(film).mean(), 0) << angle;
        } else {
            EXPECT_TRUE(agrees(pixel_statistics(film), sqr(n) * (1 - reflected))) << angle;
        }
    }
}

/// An object in an environment of radiance 1.
FilmState furnace(const std::string& type, const std::string& bsdf, std::uint64_t samples = 256) {
    const TestScene scene(
        path_integrator() + constant_light(1) + "<shape type='" + type + "'>" + bsdf + "</shape>" +
        xml({.to_world = look({3, 2, 4}, {0, 0, 0}), .fov = 35, .width = 16, .height = 16}));
    return scene.render({.per_pixel = samples});
}

TEST(WhiteFurnace, O13_LosslessObjectsAreInvisible) {
    const std::string none = "<string name='material' value='none'/>";
    for (const std::string& bsdf : {diffuse(1), "<bsdf type='conductor'>" + none + "</bsdf>",
                                    std::string("<bsdf type='thindielectric'/>"), glass,
                                    std::string("<bsdf type='null'/>")}) {
        for (const char* type : {"sphere", "cube"}) {
            // Rays that are caught in a cube of glass by total reflection never leave it.
            if (bsdf == glass && type == std::string("cube")) continue;
            EXPECT_TRUE(agrees(pixel_statistics(furnace(type, bsdf)), 1)) << type << bsdf;
        }
    }
}

TEST(WhiteFurnace, O13_D9_SphereOfGlassInGlass) {
    const std::string inner = shape(
        "sphere", scale(0.5),
        "<bsdf type='dielectric'>" + number("int_ior", 1) + number("ext_ior", 1.5) + "</bsdf>");
    const TestScene scene(
        path_integrator() + constant_light(1) + "<shape type='sphere'>" + glass + "</shape>" +
        inner +
        xml({.to_world = look({3, 2, 4}, {0, 0, 0}), .fov = 10, .width = 16, .height = 16}));
    EXPECT_TRUE(agrees(pixel_statistics(scene.render({.per_pixel = 512})), 1));
}

/// Microfacets without multiple scattering lose light, more of it the rougher they are.
TEST(WhiteFurnace, O13_D1_D2_D3_RoughSurfacesOnlyLoseLight) {
    for (const char* distribution : {"beckmann", "ggx"}) {
        for (const char* type : {"roughconductor", "roughdielectric"}) {
            double before = 1;
            for (const double alpha : {0.0, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0}) {
                const std::string bsdf = fmt::format(
                    "<bsdf type='{}'>{}<string name='distribution' value='{}'/>{}</bsdf>", type,
                    number("alpha", alpha), distribution,
                    type == std::string("roughconductor") ? "<string name='material' value='none'/>"
                                                          : "");
                const FilmState film = furnace("sphere", bsdf);
                const RunningStatistics mean = pixel_statistics(film);
                EXPECT_EQ(film.dropped_samples(), 0u) << bsdf;
                EXPECT_LE(mean.mean(), 1 + 4 * mean.standard_error() + 1e-6) << bsdf;
                EXPECT_LE(mean.mean(), before + 0.01) << bsdf;
                if (alpha <= 1e-2) {
                    EXPECT_NEAR(mean.mean(), 1, 0.005) << bsdf;
                }
                before = mean.mean();
            }
            EXPECT_GT(before, 0.7);
        }
    }
    for (const char* type : {"plastic", "roughplastic"}) {
        const FilmState film =
            furnace("sphere", fmt::format("<bsdf type='{}'><rgb name='diffuse_reflectance' "
                                          "value='1'/></bsdf>",
                                          type));
        const RunningStatistics mean = pixel_statistics(film);
        EXPECT_LE(mean.mean(), 1 + 4 * mean.standard_error()) << type;
        EXPECT_GT(mean.mean(), 0.6) << type;
    }
}

/// A plane of radiance 1 that fills the view is 1 in every pixel.
TEST(EmissivePlane, O16_I6_I7_H1_ForEveryFieldOfViewAndFilter) {
    Registry registry;
    const std::string plane =
        path_integrator() +
        shape("rectangle", scale(5000) + look({0, 0, 1}, {0, 0, 0}), diffuse(0) + area_light(1));
    for (const std::string& rfilter : registry.names("rfilter")) {
        for (const double fov : {0.01, 45.0, 179.0}) {
            const TestScene scene(plane + xml({.to_world = look({0, 0, 0}, {0, 0, 1}),
                                               .fov = fov,
                                               .width = 9,
                                               .height = 5,
                                               .rfilter = rfilter}));
            for (const std::uint64_t samples : {1u, 3u, 16u}) {
                EXPECT_TRUE(is_constant(scene.render({.per_pixel = samples}), 1, 1e-6))
                    << rfilter << " " << fov << " " << samples;
            }
        }
    }
}

TEST(EmissivePlane, O16_J6_I8_ForEverySamplerAndSensor) {
    Registry registry;
    const std::string plane =
        path_integrator() +
        shape("rectangle", scale(5000) + look({0, 0, 1}, {0, 0, 0}), diffuse(0) + area_light(1));
    for (const std::string& type : registry.names("sensor")) {
        const std::string lens =
            type == "thinlens" ? number("aperture_radius", 0.1) + number("focus_distance", 1) : "";
        for (const std::string& sampler : registry.names("sampler")) {
            const TestScene scene(plane + xml({.to_world = look({0, 0, 0}, {0, 0, 1}),
                                               .fov = 60,
                                               .width = 9,
                                               .height = 5,
                                               .sampler = sampler,
                                               .type = type,
                                               .inside = lens}));
            EXPECT_TRUE(is_constant(scene.render({.per_pixel = 7}), 1, 1e-6))
                << type << " " << sampler;
        }
    }
}

/// Nothing is clamped, however bright.
TEST(EmissivePlane, G6_BrightLightIsNotClamped) {
    for (const double radiance : {1e-20, 1e10, 1e30}) {
        const TestScene scene(path_integrator() +
                              shape("rectangle", scale(100) + look({0, 0, 1}, {0, 0, 0}),
                                    diffuse(0) + area_light(radiance)) +
                              xml({.to_world = look({0, 0, 0}, {0, 0, 1}), .fov = 45}));
        EXPECT_TRUE(is_constant(scene.render({}), radiance, 1e-6));
    }
}

/// Disc of a diffuse sphere under a directional light that makes the angle α with the view.
TEST(DiffuseSphere, O27_MeanRadianceByThePhase) {
    for (const double alpha : {0.0, pi / 3, pi / 2, 2 * pi / 3}) {
        // The orthographic camera sees exactly the square around the sphere.
        const TestScene scene(
            direct_integrator(integer("bsdf_samples", 0)) + "<shape type='sphere'>" + diffuse(1) +
            "</shape>" +
            fmt::format("<emitter type='directional'><vector name='direction' value='{}'/>"
                        "</emitter>",
                        text_of({std::sin(alpha), 0, -std::cos(alpha)})) +
            xml({.to_world = look({0, 0, 5}, {0, 0, 0}),
                 .width = 64,
                 .height = 64,
                 .sampler = "stratified",
                 .type = "orthographic"}));
        const double phase = (std::sin(alpha) + (pi - alpha) * std::cos(alpha)) / pi;
        const double expected = 2 / (3 * pi) * phase * pi / 4;
        EXPECT_NEAR(pixel_statistics(scene.render({.per_pixel = 64})).mean() / expected, 1, 2e-3)
            << alpha;
    }
}

}  // namespace
}  // namespace lucerna
