// SPDX-License-Identifier: Apache-2.0
/// Light samplers that remember, where remembering is hard: places inside walls, a scene that is
/// smaller than a cell, all lights in one spot. What holds for every light sampler is tested in
/// light_sampler_test.cpp.
#include "core/interfaces/bsdf.h"
#include "plugins/light_samplers/learning/pilot_paths.h"
#include "tests/prepared_sampler.h"
#include "tests/render_scene.h"

#include <fmt/format.h>

namespace lucerna {
namespace {

std::string word(const std::string& name, const std::string& value) {
    return fmt::format("<string name='{}' value='{}'/>", name, value);
}

/// Two rooms, a thick wall between them, 30 lights in each.
std::string two_rooms(const std::string& integrator, double size = 1) {
    const auto at = [&](double x, double y, double z) { return size * Vector3d(x, y, z); };
    std::string text =
        integrator + shape("rectangle", scale(4 * size), diffuse(0.5)) +
        shape("cube", fmt::format("<scale x='{}' y='{}' z='{}'/>", 0.5 * size, 4 * size, 2 * size),
              diffuse(0.5)) +
        xml({.to_world = look(at(3, -3.5, 3), at(1, 0, 0)), .fov = 60});
    for (int i = 0; i < 60; ++i) {
        const double side = i % 2 == 0 ? 1 : -1, t = 0.1 * i;
        const Vector3d p = at(side * (0.6 + 0.5 * t), 3 * std::cos(7 * t), 0.2 + 0.25 * t);
        text += i % 3 == 0 ? point_light(p, 0.1 * size * size)
                           : shape("rectangle",
                                   scale(0.05 * size) + look(p, p - Vector3d(0.2 * side, 0.1, 1)),
                                   area_light(1 + i % 7));
    }
    return text;
}

std::vector<Receiver> seen_points(const Scene& scene, std::uint32_t paths) {
    return pilot_receivers(scene, {.count = paths, .bounces = 1, .seed = 5}, Workers(1));
}

bool contributes(const Scene& scene, const Light& light, const Receiver& at) {
    for (int i = 0; i < 16; ++i) {
        const Vector2 u(static_cast<float>(i % 4) / 4 + 0.1f, static_cast<float>(i / 4) / 4 + 0.1f);
        const auto sample = light.emitter->sample_li(light, at, u);
        if (!sample || is_black(sample->radiance) || !(sample->pdf > 0)) continue;
        if (glm::dot(sample->wi, at.n) > 1e-5f && !scene.occluded(at, *sample)) return true;
    }
    return false;
}

/// Pairs of a point and a light that reaches it with probability zero.
int forgotten_lights(const Scene& scene, const LightSampler& sampler, std::uint32_t paths) {
    int count = 0;
    for (const Receiver& at : seen_points(scene, paths)) {
        const LightDistribution lights = sampler.at(at);
        for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
            if (lights.pmf(i) > 0) continue;
            count += contributes(scene, scene.lights()[i], at) ? 1 : 0;
        }
    }
    return count;
}

class Remembering : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, Remembering, testing::ValuesIn(Registry().names(LightSampler::kind)),
                         [](const auto& type) { return type.param; });

class CachePoints : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, CachePoints,
                         testing::Values("cache_kdtree", "cache_hash", "cache_linear"),
                         [](const auto& type) { return type.param; });

TEST_P(CachePoints, E14_PointsInsideWallsForgetNoLight) {
    const TestScene test(two_rooms(""));
    // A third of the boxes' volume is the wall.
    const PreparedSampler sampler(
        light_sampler(GetParam(), word("placement", "boxes") + integer("points_per_box", 40)),
        test.scene());
    EXPECT_EQ(forgotten_lights(test.scene(), *sampler, 100), 0);
}

TEST_P(CachePoints, E14_PointsInsideWallsDoNotChangeTheMean) {
    const std::string boxes =
        word("placement", "boxes") + integer("points_per_box", 1) + integer("lights", 3);
    const std::string hidden = boolean("hide_emitters", true);
    const TestScene test(two_rooms(direct_integrator(light_sampler(GetParam(), boxes) + hidden)));
    const TestScene reference(two_rooms(with_all_lights(
        [&](const std::string& sampler) { return direct_integrator(sampler + hidden); },
        two_rooms(""))));
    EXPECT_NEAR(pixel_statistics(test.render({.per_pixel = 8192, .seed = 3})).mean() /
                    pixel_statistics(reference.render({.per_pixel = 512})).mean(),
                1, 0.01);
}

TEST_P(CachePoints, E8_WithoutTailLightsAreLeftOutAndTheAuthorIsTold) {
    const std::string biased = light_sampler(
        GetParam(), word("tail", "none") + integer("candidates", 8) + integer("lights", 4));
    const TestScene test(two_rooms(path_integrator(biased)));
    EXPECT_NE(test.warnings().find("biased"), std::string::npos) << test.warnings();
    const PreparedSampler without(biased, test.scene());
    EXPECT_GT(forgotten_lights(test.scene(), *without, 50), 0);
    const PreparedSampler with(
        light_sampler(GetParam(), integer("candidates", 8) + integer("lights", 4)), test.scene());
    EXPECT_EQ(forgotten_lights(test.scene(), *with, 50), 0);
}

TEST(CachePointLookups, TreeAndScanFindTheSamePoint) {
    const TestScene test(two_rooms(""));
    const PreparedSampler tree(light_sampler("cache_kdtree"), test.scene());
    const PreparedSampler scan(light_sampler("cache_linear"), test.scene());
    for (const Receiver& at : seen_points(test.scene(), 100)) {
        for (std::uint32_t i = 0; i < test.scene().lights().size(); ++i) {
            EXPECT_EQ(pmf(*tree, at, i), pmf(*scan, at, i));
        }
    }
}

TEST_P(Remembering, ASceneThatIsOneCell) {
    // Seen from so far that all of it is smaller than a cell.
    std::string text = two_rooms("");
    text += xml({.to_world = look({3000, -3500, 3000}, {0, 0, 0}), .fov = 0.05});
    text = text.substr(0, text.find("<sensor")) + text.substr(text.find("</sensor>") + 9);
    const TestScene test(text);
    const PreparedSampler sampler(light_sampler(GetParam()), test.scene());
    EXPECT_EQ(forgotten_lights(test.scene(), *sampler, 100), 0);
}

TEST_P(Remembering, E11_C1_HugeAndTinyScenes) {
    for (const double size : {1e-4, 1e5}) {
        const TestScene test(two_rooms("", size));
        const PreparedSampler sampler(light_sampler(GetParam()), test.scene());
        EXPECT_EQ(forgotten_lights(test.scene(), *sampler, 50), 0) << size;
    }
}

TEST_P(Remembering, E6_AllLightsInOneSpot) {
    constexpr int count = 20000;
    std::string text = direct_integrator(light_sampler(GetParam()) + integer("bsdf_samples", 0)) +
                       shape("rectangle", scale(0.1), diffuse(0.5)) + probe({0, 0, 0}, {0, 0, 1});
    for (int i = 0; i < count; ++i) text += point_light({0, 0, 2}, 1.0 / count);
    const TestScene test(text);
    // I cos θ / d² · ρ/π
    EXPECT_TRUE(agrees(pixel_statistics(test.render({.per_pixel = 8})),
                       0.25 * 0.5 / std::numbers::pi, 0.001));
}

}  // namespace
}  // namespace lucerna
