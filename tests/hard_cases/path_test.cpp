// SPDX-License-Identifier: Apache-2.0
/// Paths, pixels and threads: what could go wrong between a sample and the image.
#include "core/interfaces/bsdf.h"
#include "core/render/session.h"
#include "tests/paths.h"
#include "tests/render_scene.h"

#include <fmt/format.h>

#include <limits>

namespace lucerna {
namespace {

const std::string metal_mirror =
    "<bsdf type='conductor'><string name='material' value='none'/></bsdf>";

std::string room_camera(int size = 16, const std::string& sampler = "independent") {
    return xml({.to_world = look({0.1, 0.2, -0.1}, {1, 0.3, 0.5}),
                .fov = 60,
                .width = size,
                .height = size,
                .sampler = sampler});
}

/// A room with some of everything.
std::string busy_scene(const std::string& integrator, int size = 24) {
    return integrator + room_camera(size, "sobol") + "<shape type='cube'>" +
           boolean("flip_normals", true) + diffuse(0.6) + "</shape>" +
           sphere({0.6, 0, 0.3}, 0.2, "<bsdf type='dielectric'/>") +
           sphere({0.5, -0.6, 0.6}, 0.2,
                  "<bsdf type='roughconductor'>" + number("alpha", 0.2) + "</bsdf>") +
           shape("disk", scale(0.3) + look({0, 0.9, 0}, {0, 0, 0}), area_light(5)) +
           point_light({-0.5, 0.5, 0.5}, 0.2);
}

TEST(Paths, G2_BlackSurfacesEndPaths) {
    const TestScene scene(path_integrator(integer("rr_depth", 1)) + room_camera() +
                          "<shape type='sphere'>" + boolean("flip_normals", true) + diffuse(0) +
                          area_light(1) + "</shape>");
    EXPECT_TRUE(is_constant(scene.render({.per_pixel = 64}), 1));
}

/// Black in two channels: roulette looks at the largest.
TEST(Paths, G2_OneDimChannelIsNotLost) {
    const TestScene scene(path_integrator(integer("rr_depth", 1)) + room_camera() +
                          "<shape type='sphere'>" + boolean("flip_normals", true) +
                          "<bsdf type='diffuse'><rgb name='reflectance' value='0, 1e-6, 0.5'/>"
                          "</bsdf>" +
                          area_light(1) + "</shape>");
    const FilmState film = scene.render({.per_pixel = 512});
    EXPECT_EQ(film.dropped_samples(), 0u);
    EXPECT_TRUE(agrees(pixel_statistics(film, 0), 1));
    EXPECT_TRUE(agrees(pixel_statistics(film, 1), 1 / (1 - 1e-6)));
    EXPECT_TRUE(agrees(pixel_statistics(film, 2), 2));
}

/// A closed room that absorbs nothing and has no light: paths must end.
TEST(Paths, G4_ARoomWithoutLossEnds) {
    for (const std::string& bsdf : {diffuse(1), metal_mirror}) {
        const TestScene scene(path_integrator() + room_camera(8) + "<shape type='cube'>" +
                              boolean("flip_normals", true) + bsdf + "</shape>");
        EXPECT_TRUE(is_constant(scene.render({.per_pixel = 64}), 0));
    }
}

TEST(Paths, G9_PathsOfAHundredThousandEdges) {
    const TestScene scene(
        path_integrator(integer("max_depth", 100000) + integer("rr_depth", 200000)) +
        xml({.to_world = look({0, 0, 0}, {0, 0, 1}), .width = 2, .height = 2}) +
        shape("rectangle", scale(1e4) + translate({0, 0, -1}), metal_mirror) +
        shape("rectangle", scale(1e4) + look({0, 0, 1}, {0, 0, 0}), metal_mirror));
    EXPECT_TRUE(is_constant(scene.render({.per_pixel = 1}), 0));
}

/// The camera sees the light itself, and the light lights the floor: each counts once.
TEST(Paths, G8_AVisibleLightCountsOnce) {
    const std::string light =
        shape("rectangle", scale(0.5) + look({0, 0, 1}, {0, 0, 0}), diffuse(0) + area_light(1));
    const std::string floor = shape("rectangle", scale(1e-3), diffuse(0.5));
    const auto seen_from = [&](Vector3d from, Vector3d at, const std::string& integrator) {
        return TestScene(integrator + floor + light + xml({.to_world = look(from, at)}))
            .render({.per_pixel = 4096});
    };
    for (const std::string& integrator : {path_integrator(), direct_integrator()}) {
        EXPECT_TRUE(is_constant(seen_from({0, 0, 0.1}, {0.1, 0.2, 1}, integrator), 1));
        EXPECT_TRUE(
            agrees(pixel_statistics(seen_from({0, 0, 0.1}, {0, 0, 0}, integrator)), 0.119728235));
    }
}

/// Mirrors show lights that are only points: nothing is infinite.
TEST(Paths, G7_C16_DeltaLightsInMirrors) {
    const TestScene scene(path_integrator() + room_camera() +
                          sphere({1, 0.3, 0.5}, 0.3, metal_mirror) + "<shape type='cube'>" +
                          boolean("flip_normals", true) + diffuse(0.5) + "</shape>" +
                          point_light({0, 0.5, 0}, 1) + point_light({1, 0.3, 0.5}, 1) +
                          sphere({0, -0.5, 0}, 0.1, area_light(1)));
    const FilmState film = scene.render({.per_pixel = 64});
    EXPECT_EQ(film.dropped_samples(), 0u);
    EXPECT_GT(pixel_statistics(film).mean(), 0);
}

/// More bounces add light to every pixel and change nothing else: the dimensions of a sample do
/// not depend on what comes later.
TEST(Paths, J10_LongerPathsOnlyAddLight) {
    std::vector<double> before;
    for (const int depth : {1, 2, 3, 5, 9}) {
        const TestScene scene(
            busy_scene(path_integrator(integer("max_depth", depth) + integer("rr_depth", 100))));
        const std::vector<double> now = numbers_of(scene.render({.per_pixel = 4}));
        for (std::size_t i = 0; i < before.size(); ++i) {
            EXPECT_GE(now[i], before[i] * (1 - 1e-6)) << "depth " << depth;
        }
        before = now;
    }
}

/// What a pixel does not see, however it is made, changes no bit of it.
TEST(Paths, J10_MaterialsElsewhereChangeNoBit) {
    const auto picture = [](const std::string& bsdf) {
        const TestScene scene(direct_integrator() + room_camera() + sphere({2, 0, 1}, 0.5, bsdf) +
                              sphere({2, 1.2, 1}, 0.5, diffuse(0.5)) + constant_light(1));
        return scene.render({.per_pixel = 16});
    };
    const FilmState plain = picture(diffuse(0.1));
    const FilmState coated = picture("<bsdf type='roughplastic'/>");
    int same = 0, different = 0;
    for (std::size_t i = 0; i < plain.pixel_count(); ++i) {
        (plain.mean(i, 0) == coated.mean(i, 0) ? same : different) += 1;
    }
    EXPECT_GT(same, 100);
    EXPECT_GT(different, 5);
}

/// A texture that is wrong in a corner.
class BrokenTexture final : public Texture {
public:
    explicit BrokenTexture(const Params& params)
        : value_(params.real("value", 0, any_value, "1: NaN, 2: infinity")) {}
    Color color(Vector2 uv) const override {
        const float bad = value_ > 1.5f ? infinity : std::numeric_limits<float>::quiet_NaN();
        return Color(uv.x > 0.5f && uv.y > 0.5f ? bad : 1.0f);
    }
    float real(Vector2) const override { return 1; }
    Color mean() const override { return Color(1); }
    float max() const override { return 1; }

private:
    float value_;
};

TEST(Pixels, G5_H2_SamplesThatAreNotFiniteAreDroppedAndCounted) {
    const PluginInfo broken = describe<BrokenTexture>("for this test");
    for (const int kind : {1, 2}) {
        Registry registry;
        registry.add("broken", broken);
        const TestScene scene(
            path_integrator() +
                shape("rectangle", scale(1.2) + look({0, 0, 1}, {0, 0, 0}),
                      diffuse(0) + "<emitter type='area'><texture type='broken' name='radiance'>" +
                          number("value", kind) + "</texture></emitter>") +
                xml({.to_world = look({0, 0, 0}, {0, 0, 1}), .fov = 90, .width = 16, .height = 16}),
            std::move(registry));
        const FilmState film = scene.render({.per_pixel = 8});
        const double all = static_cast<double>(8 * film.pixel_count());
        EXPECT_NEAR(static_cast<double>(film.dropped_samples()) / all, 0.25, 0.1);
        EXPECT_GT(film.empty_pixels(), 0u);
        EXPECT_TRUE(film.first_dropped_pixel());
        for (const double x : numbers_of(film)) {
            EXPECT_TRUE(x == 0 || std::abs(x - 1) < 1e-6) << x;
        }
        const auto& planes = film.resolve().planes;
        EXPECT_EQ(planes.back().name, "samples.dropped");
    }
}

TEST(Threads, N8_A24_H7_TheImageDoesNotDependOnThem) {
    for (const std::string& integrator : {path_integrator(), direct_integrator()}) {
        const TestScene scene(busy_scene(integrator));
        const std::vector<double> one =
            numbers_of(scene.render({.per_pixel = 8, .seed = 3, .threads = 1}));
        for (const int threads : {2, 3, 7}) {
            EXPECT_EQ(numbers_of(scene.render({.per_pixel = 8, .seed = 3, .threads = threads})),
                      one);
        }
        EXPECT_NE(numbers_of(scene.render({.per_pixel = 8, .seed = 4})), one);
    }
}

TEST(Threads, N8_EverySamplerAndLightSampler) {
    Registry registry;
    for (const std::string& sampler : registry.names("light_sampler")) {
        const TestScene scene(
            busy_scene(path_integrator("<light_sampler type='" + sampler + "'/>")));
        EXPECT_EQ(numbers_of(scene.render({.per_pixel = 4, .threads = 7})),
                  numbers_of(scene.render({.per_pixel = 4, .threads = 1})))
            << sampler;
    }
}

/// Through the files of a real render: 16 samples, a state file, 48 more.
TEST(Threads, N10_ResumedRendersAreTheSame) {
    const TemporaryFolder folder;
    write_file(folder / "scene.xml",
               "<scene version='3.0.0'>" + busy_scene(path_integrator()) + "</scene>");
    const auto samples = [](std::uint64_t count, int threads) {
        RenderOptions options;
        options.budget.samples = count;
        options.seed = 5;
        options.threads = threads;
        return options;
    };
    SessionSettings settings;
    settings.scene = folder / "scene.xml";
    const FilmState whole = Session(settings).render(samples(64, 2)).film;
    {
        const Session first(settings);
        const RenderResult part = first.render(samples(16, 1));
        write_state(folder / "part.state", part.film, first.identity(5), 1);
    }
    const Session second(settings);
    RenderState state = read_state(folder / "part.state");
    check_continues(state, film_layout(second.scene()), second.identity(5), "part.state");
    const RenderResult rest = second.render(samples(64, 7), std::move(state));
    EXPECT_EQ(rest.figures.samples, 64u);
    EXPECT_EQ(numbers_of(rest.film), numbers_of(whole));
}

}  // namespace
}  // namespace lucerna
