// SPDX-License-Identifier: Apache-2.0
/// Photon mapping and light tracing against closed forms, against path tracing, and against each
/// other.
///
/// Means are taken over images of different seeds and must be within four standard errors of what
/// is expected (`agrees`). For an estimate within a radius, that is the exact irradiance smoothed
/// by the kernel: its bias is computed, not allowed for.
#include "plugins/integrators/photon_estimate.h"
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

/// A square of the plane z = 0 that a camera sees evenly.
struct Footprint {
    double x, y, half_width;
    std::string camera() const {
        const double height = 0.5;
        return xml({.to_world = look({x, y, height}, {x, y, 0}),
                    .fov = 2 * std::atan(half_width / height) * 180 / pi});
    }
};

using Irradiance = std::function<double(double x, double y)>;

/// The mean over the footprint of what an estimate within `radius` is on average.
double smoothed(const Irradiance& irradiance, const Footprint& seen, double radius,
                PhotonFilter filter = PhotonFilter::cone) {
    constexpr int places = 6, rings = 12, angles = 24;
    double sum = 0;
    for (int i = 0; i < places * places; ++i) {
        const double x = seen.x + seen.half_width * (2 * (i % places + 0.5) / places - 1);
        const double y = seen.y + seen.half_width * (2 * (i / places + 0.5) / places - 1);
        double mean = 0, weights = 0;
        for (int k = 0; k < rings * angles; ++k) {
            const double t = (k / angles + 0.5) / rings, phi = 2 * pi * (k % angles) / angles;
            const double weight =
                t * static_cast<double>(photon_kernel(filter, static_cast<float>(t * t)));
            mean +=
                weight * irradiance(x + radius * t * std::cos(phi), y + radius * t * std::sin(phi));
            weights += weight;
        }
        sum += mean / weights;
    }
    return sum / (places * places);
}

/// The middle of a wall of a closed cube whose walls all emit 1 and reflect ½. Irradiance is the
/// same everywhere, and so no estimate within a radius is biased.
const std::string furnace = "<shape type='cube'>" + boolean("flip_normals", true) + diffuse(0.5) +
                            area_light(1) + "</shape>" +
                            xml({.to_world = look({0, 0, 0}, {0, 0, 1}), .fov = 60});

TEST(PhotonMapping, O1_FurnaceOfLimitedDepth) {
    const std::string many = integer("global_photons", 100000);
    const std::string photons = many + integer("lookup_size", 50);
    for (int depth = 1; depth <= 8; ++depth) {
        SCOPED_TRACE(depth);
        const double expected = 2 - std::pow(0.5, depth - 1);
        const std::string limit = integer("max_depth", depth);
        const auto agrees_for = [&](const std::string& type, const std::string& inside,
                                    std::uint64_t samples) {
            const std::string how = integrator(type, limit + inside);
            EXPECT_TRUE(agrees(image_means(how + furnace, samples, 6), expected, 0.005)) << how;
        };
        agrees_for("photonmap", photons, 16);
        // All within the radius, the nearest ones, and so few that the least radius holds more.
        const std::string progressive = integer("photon_count", 20000);
        for (const int nearest : {0, 16, 3}) {
            agrees_for(
                "sppm",
                progressive + number("initial_radius", 0.2) + integer("lookup_size", nearest), 16);
        }
        if (depth % 3 != 2) continue;
        agrees_for("photonmap", photons + text("direct_light", "photons"), 8);
        agrees_for("photonmap", photons + integer("final_gather", 1), 16);
        agrees_for("photonmap", many + text("structure", "grid") + integer("lookup_size", 0), 16);
        agrees_for("ptracer", "", 2048);
    }
}

/// A floor of albedo ½ at z = 0. Irradiance / 2π is what is seen of it.
const std::string floor = shape("rectangle", scale(4), diffuse(0.5));

/// Photons alone, within a radius of `radius` in a scene of the radius `scene_radius`.
std::string photons_only(double radius, double scene_radius) {
    return integrator("photonmap", integer("max_depth", 2) + text("direct_light", "photons") +
                                       integer("global_photons", 400000) +
                                       integer("lookup_size", 0) + text("structure", "grid") +
                                       number("global_lookup_radius", radius / scene_radius));
}

/// Photons and particles on the floor below a light; the bias of two radii is seen for what it is.
void check_light_above_floor(const std::string& light, const Irradiance& irradiance,
                             double precision) {
    const Footprint seen{.x = 0, .y = 0, .half_width = 0.1};
    const std::string content = floor + light + seen.camera();
    const double size =
        static_cast<double>(TestScene(path_integrator() + content).scene().bounds().radius());
    for (const double radius : {0.1, 0.5}) {
        SCOPED_TRACE(radius);
        EXPECT_TRUE(agrees(image_means(photons_only(radius, size) + content, 1, 8),
                           smoothed(irradiance, seen, radius) / (2 * pi), precision));
    }
    const std::string traced = integrator("ptracer", integer("max_depth", 2)) + content;
    EXPECT_TRUE(agrees(image_means(traced, 16384, 8), smoothed(irradiance, seen, 0) / (2 * pi),
                       2 * precision));
}

TEST(PhotonMapping, O6_F12_F14_RectangleLight) {
    const std::vector<Vector3d> corners = {
        {-0.5, -0.5, 1}, {0.5, -0.5, 1}, {0.5, 0.5, 1}, {-0.5, 0.5, 1}};
    check_light_above_floor(
        shape("rectangle", scale(0.5) + look({0, 0, 1}, {0, 0, 0}), diffuse(0) + area_light(1)),
        [&](double x, double y) {
            return polygon_irradiance(corners, {x, y, 0}, {0, 0, 1});
        },
        0.004);
}

/// A sheet of paper between two equal lights is the same from both sides.
TEST(PhotonMapping, F11_BothSidesOfATwoSidedSurface) {
    const std::vector<Vector3d> corners = {
        {-0.5, -0.5, 1}, {0.5, -0.5, 1}, {0.5, 0.5, 1}, {-0.5, 0.5, 1}};
    const auto irradiance = [&](double x, double y) {
        return polygon_irradiance(corners, {x, y, 0}, {0, 0, 1});
    };
    const Footprint seen{.x = 0, .y = 0, .half_width = 0.1};
    const double radius = 0.1, height = 0.5;
    std::string sheet =
        shape("rectangle", scale(4), "<bsdf type='twosided'>" + diffuse(0.5) + "</bsdf>");
    for (const double side : {1.0, -1.0}) {
        sheet += shape("rectangle", scale(0.5) + look({0, 0, side}, {0, 0, 0}),
                       diffuse(0) + area_light(1));
    }
    for (const double side : {1.0, -1.0}) {
        SCOPED_TRACE(side);
        const std::string content =
            sheet + xml({.to_world = look({0, 0, side * height}, {0, 0, 0}),
                         .fov = 2 * std::atan(seen.half_width / height) * 180 / pi});
        const double size =
            static_cast<double>(TestScene(path_integrator() + content).scene().bounds().radius());
        EXPECT_TRUE(agrees(image_means(photons_only(radius, size) + content, 1, 8),
                           smoothed(irradiance, seen, radius) / (2 * pi), 0.006));
    }
}

/// A light that is black in two of four quarters: a quarter turn shows that it sends half of what
/// it would send without, and photons that were aimed from the dark must count as emitted.
TEST(PhotonMapping, F20_LightThatIsDarkInParts) {
    const std::vector<Vector3d> corners = {
        {-0.5, -0.5, 1}, {0.5, -0.5, 1}, {0.5, 0.5, 1}, {-0.5, 0.5, 1}};
    check_light_above_floor(
        shape("rectangle", scale(0.5) + look({0, 0, 1}, {0, 0, 0}),
              diffuse(0) + "<emitter type='area'><texture name='radiance' type='checkerboard'>"
                           "<rgb name='color0' value='0'/><rgb name='color1' value='1'/>"
                           "</texture></emitter>"),
        [&](double x, double y) {
            return 0.5 * polygon_irradiance(corners, {x, y, 0}, {0, 0, 1});
        },
        0.006);
}

/// π L (R / d)² cos θ wherever the whole sphere is above the horizon.
TEST(PhotonMapping, O7_SphereLight) {
    check_light_above_floor(
        sphere({0, 0, 1.5}, 0.5, diffuse(0) + area_light(1)),
        [](double x, double y) {
            return pi * sqr(0.5) * 1.5 / std::pow(x * x + y * y + sqr(1.5), 1.5);
        },
        0.008);
}

/// A point light at height 1, a mirror on the plane x = 2, the floor seen at x = 1.
TEST(PhotonMapping, O20_F13_CausticOfAPlaneMirror) {
    const Footprint seen{.x = 1, .y = 0, .half_width = 0.1};
    const std::string content =
        shape("rectangle", scale(3), diffuse(0.5)) +
        shape("rectangle", scale(3) + look({2, 0, 0}, {1, 0, 0}),
              "<bsdf type='conductor'><string name='material' value='none'/>" +
                  number("specular_reflectance", 0.9) + "</bsdf>") +
        point_light({0, 0, 1}, 1) + seen.camera();
    const double size =
        static_cast<double>(TestScene(path_integrator() + content).scene().bounds().radius());
    const auto direct = [](double x, double y) { return std::pow(x * x + y * y + 1, -1.5); };
    const auto caustic = [&](double x, double y) { return 0.9 * direct(4 - x, y); };
    const std::string depth = integer("max_depth", 3);

    const double radius = 0.3;
    const std::string alone =
        depth + text("show", "caustics") + integer("caustic_photons", 100000) +
        number("caustic_lookup_radius", radius / size) + integer("lookup_size", 0);
    EXPECT_TRUE(agrees(image_means(integrator("photonmap", alone) + content, 1, 16),
                       smoothed(caustic, seen, radius) / (2 * pi), 0.01));

    // sppm adds direct light, which has no noise here, and averages over its shrinking radii.
    const int passes = 16;
    double expected = 0, radius2 = sqr(radius);
    for (int i = 0; i < passes; ++i) {
        if (i > 0) radius2 *= (i + 2.0 / 3) / (i + 1);
        expected += smoothed(caustic, seen, std::sqrt(radius2)) / passes;
    }
    const std::string wide = depth + number("initial_radius", radius) +
                             integer("photon_count", 100000) + integer("lookup_size", 0);
    const TestScene both(integrator("sppm", wide) + content);
    const TestScene one(integrator("direct") + content);
    RunningStatistics reflected;
    for (int i = 0; i < 6; ++i) {
        const Samples samples{.per_pixel = passes, .seed = static_cast<std::uint64_t>(i)};
        reflected.add(pixel_statistics(both.render(samples)).mean() -
                      pixel_statistics(one.render(samples)).mean());
    }
    EXPECT_TRUE(agrees(reflected, expected / (2 * pi), 0.03));
    EXPECT_TRUE(agrees(image_means(path_integrator(depth) + content, 64, 4),
                       smoothed(direct, seen, 0) / (2 * pi), 0.002))
        << "a path tracer cannot find it";
}

/// What the mean would be without a radius: near edges the bias is in proportion to it, so that it
/// drops out of twice the mean at half the radius less the mean. Pairs share their seed.
RunningStatistics without_radius(const std::string& type, const std::string& inside,
                                 const std::string& name, double radius, const std::string& content,
                                 std::uint64_t samples, int images) {
    const TestScene full(integrator(type, inside + number(name, radius)) + content);
    const TestScene half(integrator(type, inside + number(name, radius / 2)) + content);
    RunningStatistics result;
    for (int i = 0; i < images; ++i) {
        const Samples how{.per_pixel = samples, .seed = static_cast<std::uint64_t>(i)};
        result.add(2 * pixel_statistics(half.render(how)).mean() -
                   pixel_statistics(full.render(how)).mean());
    }
    return result;
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
    const RunningStatistics paths = image_means(path_integrator() + scene, 256, 6);
    EXPECT_TRUE(agree(image_means(integrator("ptracer") + scene, 128, 8), paths, 0.003));
    for (const int nearest : {0, 16}) {
        const std::string few = integer("photon_count", 20000) + integer("lookup_size", nearest);
        EXPECT_TRUE(
            agree(without_radius("sppm", few, "initial_radius", 0.1, scene, 16, 8), paths, 0.003))
            << nearest;
    }
    EXPECT_TRUE(agree(
        without_radius("photonmap", integer("global_photons", 100000) + integer("final_gather", 1),
                       "global_lookup_radius", 0.05, scene, 8, 8),
        paths, 0.003));
}

/// Surfaces that are both matte and glossy under a large lamp, which they reflect: direct light by
/// rays of the BSDF and by light samples is neither lost nor counted twice.
TEST(PhotonMapping, G11_DirectLightOnGlossySurfaces) {
    const std::string glossy = "<bsdf type='roughplastic'>" + number("alpha", 0.15) + "</bsdf>";
    const std::string scene =
        shape("rectangle", scale(3), glossy) +
        shape("rectangle", scale(1) + look({0, 2, 1.5}, {0, 0, 0.2}), diffuse(0) + area_light(5)) +
        sphere({0.3, 0.1, 0.3}, 0.3, glossy);
    const std::string camera_frame = look({0, -2, 1}, {0, 0, 0.1});
    const std::string clear = xml({.to_world = camera_frame, .fov = 40, .width = 24, .height = 24});
    const std::string depth = integer("max_depth", 2);
    const RunningStatistics paths = image_means(path_integrator(depth) + scene + clear, 256, 6);
    const std::string few = depth + integer("photon_count", 1);
    EXPECT_TRUE(agree(image_means(integrator("sppm", few) + scene + clear, 64, 6), paths, 0.003));
    EXPECT_TRUE(
        agree(image_means(integrator("photonmap", depth) + scene + clear, 64, 6), paths, 0.003));
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
    const RunningStatistics traced = image_means(integrator("ptracer", depth) + scene, 256, 8);
    for (const int nearest : {0, 16}) {
        const std::string some =
            depth + integer("photon_count", 50000) + integer("lookup_size", nearest);
        EXPECT_TRUE(agree(without_radius("sppm", some, "initial_radius", 0.04, scene, 16, 8),
                          traced, 0.005))
            << nearest;
    }
    EXPECT_TRUE(
        agree(without_radius("photonmap",
                             depth + integer("lookup_size", 0) + integer("caustic_photons", 40000) +
                                 integer("global_photons", 10000),
                             "caustic_lookup_radius", 0.01, scene, 4, 8),
              traced, 0.005));
}

/// The mean squared error of sppm falls as the power −2/3 of the passes: the middle of a floor,
/// with direct light that has no noise.
TEST(PhotonMapping, F16_ErrorOfSppmFallsAsItShould) {
    const std::string scene =
        "<shape type='cube'>" + boolean("flip_normals", true) + diffuse(0.6) + "</shape>" +
        point_light({0.3, 0.2, 0.1}, 1) +
        xml({.to_world = look({0, 0.4, 0}, {0, -1, 0}), .fov = 40, .width = 16, .height = 16});
    const FilmState reference =
        TestScene(path_integrator() + scene).render({.per_pixel = 16384, .seed = 99});
    const TestScene progressive(integrator("sppm", integer("photon_count", 500) +
                                                       number("initial_radius", 0.15) +
                                                       integer("lookup_size", 0)) +
                                scene);
    const auto error = [&](std::uint64_t passes, std::uint64_t seed) {
        const FilmState some = progressive.render({.per_pixel = passes, .seed = seed});
        double sum = 0;
        for (std::size_t i = 0; i < some.pixel_count(); ++i) {
            const double noise = (reference.half_mean(i, 0, 0) - reference.half_mean(i, 1, 0)) / 2;
            sum += sqr(some.mean(i, 0) - reference.mean(i, 0)) - sqr(noise);
        }
        return sum;
    };
    // Least squares over 16, 64, …, 4096 passes, for each seed.
    RunningStatistics slopes;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        double slope = 0;
        for (int k = -2; k <= 2; ++k) slope += k * std::log(error(16u << (2 * (k + 2)), seed));
        slopes.add(slope / (10 * std::log(4.0)));
    }
    RecordProperty("slope", fmt::format("{:.3f} ± {:.3f}", slopes.mean(), slopes.standard_error()));
    EXPECT_LE(slopes.standard_error(), 0.03);
    EXPECT_NEAR(slopes.mean(), -2.0 / 3, 4 * slopes.standard_error());
}

/// Samples of any integrator in one piece, by one thread.
std::vector<double> in_one_piece(const TestScene& scene, std::uint64_t samples) {
    return numbers_of(scene.render({.per_pixel = samples, .seed = 1, .threads = 1}));
}

class PhotonIntegrators : public testing::TestWithParam<const char*> {
protected:
    /// A room with all kinds of light.
    std::string content() const {
        const std::string type = GetParam();
        const std::string inside = type == "photonmap" ? integer("global_photons", 20000) +
                                                             integer("caustic_photons", 5000) +
                                                             integer("final_gather", 1)
                                   : type == "sppm" ? integer("photon_count", 20000)
                                                    : "";
        return integrator(type, inside) + diffuse_room("<bsdf type='dielectric'/>");
    }
};

TEST_P(PhotonIntegrators, SameBitsForAnyNumberOfThreads) {
    const TestScene scene(content());
    const std::vector<double> one = in_one_piece(scene, 4);
    for (const int threads : {2, 7}) {
        EXPECT_EQ(one, numbers_of(scene.render({.per_pixel = 4, .seed = 1, .threads = threads})));
    }
}

/// What --checkpoint and --resume do: passes in pieces, the last of which was torn off in the
/// middle, on other numbers of threads.
TEST_P(PhotonIntegrators, SameBitsWhenInterruptedAndResumed) {
    const TestScene scene(content());
    const std::vector<double> one = in_one_piece(scene, 6);
    for (const int patience : {100, 300, 1000}) {
        FilmState film(film_layout(scene.scene()));
        for (const int threads : {1, 2, 7}) {
            std::atomic<int> questions{0};
            RenderOptions options;
            options.budget.samples = 6;
            options.seed = 1;
            options.threads = threads;
            if (threads < 7) options.interrupted = [&] { return ++questions > patience * threads; };
            RenderJob job(scene.scene(), std::move(options), std::move(film));
            scene.scene().integrator().render(job);
            film = job.take_state();
        }
        EXPECT_EQ(one, numbers_of(film)) << patience;
    }
}

/// Passes that were rendered apart, as on several machines.
TEST_P(PhotonIntegrators, SameBitsWhenPassesAreMerged) {
    const TestScene scene(content());
    const auto passes = [&](std::uint64_t first, std::uint64_t count) {
        RenderOptions options;
        options.budget.samples = count;
        options.seed = 1;
        RenderJob job(scene.scene(), std::move(options),
                      FilmState(film_layout(scene.scene()), first));
        scene.scene().integrator().render(job);
        return job.take_state();
    };
    FilmState merged = passes(0, 3);
    merged.merge(passes(3, 1));
    merged.merge(passes(4, 2));
    EXPECT_EQ(in_one_piece(scene, 6), numbers_of(merged));
}

/// Direct light of a sky is found by light samples and by rays of the BSDF, weighted; here there is
/// no other.
TEST(PhotonMapping, G8_TheSkyOverMatteAndGlossyThings) {
    const std::string scene =
        shape("rectangle", scale(3), "<bsdf type='roughplastic'/>") + constant_light(0.7) +
        "<emitter type='constant'><rgb name='radiance' value='0.5'/></emitter>" +
        xml({.to_world = look({0, -2, 1.5}, {0, 0, 0}), .fov = 20});
    const RunningStatistics traced =
        image_means(path_integrator(integer("max_depth", 2)) + scene, 256, 6);
    for (const char* const type : {"photonmap", "sppm"}) {
        const std::string how = integrator(type, integer("max_depth", 2));
        EXPECT_TRUE(agree(image_means(how + scene, 64, 6), traced, 0.01)) << type;
    }
}

INSTANTIATE_TEST_SUITE_P(All, PhotonIntegrators, testing::Values("photonmap", "sppm", "ptracer"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace lucerna
