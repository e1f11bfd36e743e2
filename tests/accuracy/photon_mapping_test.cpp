// SPDX-License-Identifier: Apache-2.0
/// Photon mapping and light tracing against closed forms, against path tracing, and against each
/// other.
#include "tests/render_scene.h"

#include <fmt/format.h>

namespace lucerna {
namespace {

using std::numbers::pi;

std::string integrator(const std::string& type, const std::string& inside = "") {
    return "<integrator type='" + type + "'>" + inside + "</integrator>";
}
std::string text(const std::string& name, const std::string& value) {
    return "<string name='" + name + "' value='" + value + "'/>";
}

/// Over images of different seeds.
RunningStatistics image_means(const std::string& content, std::uint64_t samples, int images = 8) {
    const TestScene scene(content);
    RunningStatistics result;
    for (int i = 0; i < images; ++i) {
        const FilmState film =
            scene.render({.per_pixel = samples, .seed = static_cast<std::uint64_t>(i)});
        EXPECT_EQ(film.dropped_samples(), 0u);
        result.add(pixel_statistics(film).mean());
    }
    return result;
}

/// As `agree`, with a bound for the bias that the radius causes.
testing::AssertionResult close(const RunningStatistics& x, double reference, double bias) {
    const double room = 4 * x.standard_error() + bias * reference;
    if (std::abs(x.mean() - reference) <= room && 2 * x.standard_error() <= bias * reference) {
        return testing::AssertionSuccess();
    }
    return testing::AssertionFailure() << x.mean() << " ± " << x.standard_error() << " against "
                                       << reference << ", allowed bias " << bias;
}

/// The middle of a wall of a closed cube whose walls all emit 1 and reflect ½.
const std::string furnace = "<shape type='cube'>" + boolean("flip_normals", true) + diffuse(0.5) +
                            area_light(1) + "</shape>" +
                            xml({.to_world = look({0, 0, 0}, {0, 0, 1}), .fov = 60});

TEST(PhotonMapping, O1_FurnaceOfLimitedDepth) {
    const std::string photons = integer("global_photons", 100000) + integer("lookup_size", 50);
    for (int depth = 1; depth <= 8; ++depth) {
        SCOPED_TRACE(depth);
        const double expected = 2 - std::pow(0.5, depth - 1);
        const std::string limit = integer("max_depth", depth);
        const auto agrees_for = [&](const std::string& type, const std::string& inside,
                                    std::uint64_t samples) {
            const std::string how = integrator(type, limit + inside);
            EXPECT_TRUE(close(image_means(how + furnace, samples, 4), expected, 0.015)) << how;
        };
        agrees_for("photonmap", photons, 16);
        agrees_for("sppm", integer("photon_count", 10000), 16);
        if (depth % 3 != 2) continue;
        agrees_for("photonmap", photons + text("direct_light", "photons"), 4);
        agrees_for("photonmap", photons + integer("final_gather", 1), 16);
        agrees_for("photonmap", photons + text("structure", "grid"), 16);
        agrees_for("ptracer", "", 4096);
    }
}

/// The origin of a black-bordered floor of albedo ½ at z = 0, seen from above.
const std::string floor = shape("rectangle", scale(4), diffuse(0.5)) +
                          xml({.to_world = look({0, 0, 0.5}, {0, 0, 0}), .fov = 20});
/// The estimate of the irradiance by photons alone.
const std::string photons_only = integrator(
    "photonmap", integer("max_depth", 2) + text("direct_light", "photons") +
                     integer("global_photons", 500000) + number("global_lookup_radius", 0.02));

TEST(PhotonMapping, O6_F12_F14_RectangleLight) {
    const std::string light =
        shape("rectangle", scale(0.5) + look({0, 0, 1}, {0, 0, 0}), diffuse(0) + area_light(1));
    EXPECT_TRUE(close(image_means(photons_only + floor + light, 1), 0.119728235, 0.02));
    const RunningStatistics traced =
        image_means(integrator("ptracer", integer("max_depth", 2)) + floor + light, 16384, 4);
    EXPECT_TRUE(close(traced, 0.119728235, 0.02));
}

TEST(PhotonMapping, O7_SphereLight) {
    const std::string light = sphere({0, 0, 1.5}, 0.5, diffuse(0) + area_light(1));
    EXPECT_TRUE(close(image_means(photons_only + floor + light, 1, 14), 1.0 / 18, 0.02));
}

/// A point light at height 1, a mirror on the plane x = 2, the floor seen at x = 1.
TEST(PhotonMapping, O20_F13_CausticOfAPlaneMirror) {
    const std::string scene =
        shape("rectangle", scale(3), diffuse(0.5)) +
        shape("rectangle", scale(3) + look({2, 0, 0}, {1, 0, 0}),
              "<bsdf type='conductor'><string name='material' value='none'/>" +
                  number("specular_reflectance", 0.9) + "</bsdf>") +
        point_light({0, 0, 1}, 1) + xml({.to_world = look({1, 0, 0.5}, {1, 0, 0}), .fov = 10});
    const double direct = 0.353553391, caustic = 0.028460499;
    const std::string depth = integer("max_depth", 3);
    const std::string alone = depth + text("show", "caustics") +
                              integer("caustic_photons", 100000) +
                              number("caustic_lookup_radius", 0.05) + integer("lookup_size", 0);
    EXPECT_TRUE(close(image_means(integrator("photonmap", alone) + scene, 1, 16),
                      caustic / (2 * pi), 0.03));
    const std::string wide = depth + number("initial_radius", 0.1) + integer("photon_count", 50000);
    EXPECT_TRUE(close(image_means(integrator("sppm", wide) + scene, 16, 4),
                      (direct + caustic) / (2 * pi), 0.01));
    EXPECT_TRUE(close(image_means(path_integrator(depth) + scene, 1), direct / (2 * pi), 0.01))
        << "a path tracer cannot find it";
}

/// Diffuse things in a room, lit by two lamps; the camera sees no lamp.
std::string diffuse_room(const std::string& more) {
    return "<shape type='cube'>" + boolean("flip_normals", true) + diffuse(0.6) + "</shape>" +
           shape("rectangle", scale(0.3) + look({0.2, 0.98, 0}, {0.2, 0, 0}),
                 diffuse(0) + area_light(5)) +
           sphere({-0.6, 0.6, 0.5}, 0.1, diffuse(0) + area_light(10)) +
           sphere({0.3, -0.7, 0.1}, 0.3, more) +
           xml({.to_world = look({0, 0.1, -0.9}, {0, -0.7, 0.3}),
                .fov = 60,
                .width = 24,
                .height = 24,
                .sampler = "sobol"});
}

TEST(PhotonMapping, G11_DiffuseSceneAsPathTracing) {
    const std::string scene = diffuse_room(diffuse(0.4));
    const double reference = image_means(path_integrator() + scene, 512, 4).mean();
    const std::string photons = integer("global_photons", 200000);
    EXPECT_TRUE(close(image_means(integrator("ptracer") + scene, 256, 4), reference, 0.005));
    EXPECT_TRUE(close(
        image_means(integrator("photonmap", photons + integer("final_gather", 4)) + scene, 16, 4),
        reference, 0.01));
    EXPECT_TRUE(close(image_means(integrator("sppm", integer("photon_count", 20000) +
                                                         number("initial_radius", 0.05)) +
                                      scene,
                                  64),
                      reference, 0.01));
    // Corners are too dark without final gathering: the bias is reported, not hidden.
    EXPECT_TRUE(
        close(image_means(integrator("photonmap", photons) + scene, 16, 4), reference, 0.05));
}

/// A glass ball over a floor: the camera sees the floor alone.
TEST(PhotonMapping, G11_CausticsOfSppmAndPtracer) {
    const std::string scene =
        shape("rectangle", scale(1), diffuse(0.5)) +
        sphere({0, 0, 0.8}, 0.3, "<bsdf type='dielectric'/>") +
        shape("disk", scale(0.1) + look({0.3, 0, 2}, {0, 0, 0}), diffuse(0) + area_light(20)) +
        xml({.to_world = look({0, -0.8, 0.35}, {0, 0, 0}),
             .fov = 30,
             .width = 24,
             .height = 24,
             .sampler = "sobol"});
    const std::string depth = integer("max_depth", 6);
    const double reference = image_means(integrator("ptracer", depth) + scene, 2048, 4).mean();
    EXPECT_TRUE(close(image_means(integrator("sppm", depth + integer("photon_count", 50000) +
                                                         number("initial_radius", 0.02)) +
                                      scene,
                                  64),
                      reference, 0.01));
    EXPECT_TRUE(close(image_means(integrator("photonmap", depth) + scene, 16, 4), reference, 0.01));
}

/// The mean squared error of sppm falls as the power −2/3 of the passes: the middle of a floor,
/// with direct light that has no noise.
TEST(PhotonMapping, F16_ErrorOfSppmFallsAsItShould) {
    const std::string scene =
        "<shape type='cube'>" + boolean("flip_normals", true) + diffuse(0.6) + "</shape>" +
        point_light({0.3, 0.2, 0.1}, 1) +
        xml({.to_world = look({0, 0.4, 0}, {0, -1, 0}), .fov = 40, .width = 24, .height = 24});
    const auto film = [&](const std::string& how, std::uint64_t samples) {
        return TestScene(how + scene).render({.per_pixel = samples, .seed = 3});
    };
    const FilmState reference = film(path_integrator(), 4096);
    const auto error = [&](std::uint64_t passes) {
        const FilmState some =
            film(integrator("sppm", integer("photon_count", 500) + number("initial_radius", 0.15)),
                 passes);
        double sum = 0;
        for (std::size_t i = 0; i < some.pixel_count(); ++i) {
            sum += sqr(some.mean(i, 0) - reference.mean(i, 0));
        }
        return sum;
    };
    const double slope = std::log2(error(1024) / error(16)) / 6;
    EXPECT_NEAR(slope, -2.0 / 3, 0.1);
}

TEST(PhotonMapping, SameBitsForAnyNumberOfThreads) {
    const std::string scene = diffuse_room("<bsdf type='dielectric'/>");
    for (const std::string& how :
         {integrator("photonmap", integer("global_photons", 20000) +
                                      integer("caustic_photons", 5000) +
                                      integer("final_gather", 1)),
          integrator("sppm", integer("photon_count", 20000)), integrator("ptracer")}) {
        const auto numbers = [&](int threads) {
            return numbers_of(
                TestScene(how + scene).render({.per_pixel = 4, .seed = 1, .threads = threads}));
        };
        const auto one = numbers(1);
        EXPECT_EQ(one, numbers(2)) << how;
        EXPECT_EQ(one, numbers(7)) << how;
    }
}

/// Nothing to see, nothing to hit, nothing to store: black or the light itself, never an error.
TEST(PhotonMapping, F3_F5_ScenesWithoutMuch) {
    const std::string camera = xml({.to_world = look({0, 0, 0}, {0, 0, 1}), .fov = 20});
    const std::string wall = shape("rectangle", look({0, 0, 1}, {0, 0, 0}), diffuse(0.5));
    const std::string mirror =
        shape("rectangle", look({0, 0, 1}, {0, 0, 0}), "<bsdf type='conductor'/>");
    for (const char* type : {"photonmap", "sppm", "ptracer"}) {
        SCOPED_TRACE(type);
        const std::string few = std::string(type) == "photonmap"
                                    ? integer("global_photons", 1) + integer("caustic_photons", 1) +
                                          number("global_lookup_radius", 1e6)
                                    : "";
        for (const std::string& scene :
             {std::string(), wall, mirror, point_light({0, 0, 0.5}, 1),
              wall + point_light({0, 0, 3}, 1), wall + point_light({0, 0, 0.5}, 1),
              mirror + point_light({0, 0, 0.5}, 1)}) {
            const FilmState film =
                TestScene(integrator(type, few) + camera + scene).render({.per_pixel = 2});
            EXPECT_EQ(film.dropped_samples(), 0u) << scene;
        }
    }
}

}  // namespace
}  // namespace lucerna
