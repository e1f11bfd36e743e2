// SPDX-License-Identifier: Apache-2.0
/// What holds for every light sampler there is: probabilities add up, are those with which lights
/// are drawn, and leave out no light that contributes.
#include "core/interfaces/light_sampler.h"
#include "core/interfaces/bsdf.h"
#include "plugins/commands/contracts/light_sampler.h"
#include "plugins/commands/contracts/light_scenes.h"
#include "tests/prepared_sampler.h"
#include "tests/render_scene.h"

namespace lucerna {
namespace {

class LightSamplers : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(All, LightSamplers, testing::ValuesIn(tested_samplers()),
                         [](const auto& type) { return type.param; });

std::vector<Receiver> receivers(int count, float size = 1) {
    return contracts::scattered_points(count, size);
}

/// A sampler among lights of all kinds, tried at some points.
class AmongManyLights {
public:
    AmongManyLights(const std::string& type, int points)
        : sampler_(tested_sampler(type), test_.scene()), points_(receivers(points)) {}
    contracts::LightSamplerTrial trial() const {
        return {.sampler = *sampler_, .scene = test_.scene(), .points = points_};
    }

private:
    TestScene test_{contracts::many_lights()};
    PreparedSampler sampler_;
    std::vector<Receiver> points_;
};

double sum_of_probabilities(const LightSampler& sampler, const Receiver& at, std::size_t count) {
    const LightDistribution lights = sampler.at(at);
    double sum = 0;
    for (std::uint32_t light = 0; light < count; ++light) {
        sum += static_cast<double>(lights.pmf(light));
    }
    return sum;
}

TEST_P(LightSamplers, E7_E12_E16_ProbabilitiesAddUp) {
    EXPECT_TRUE(holds(contracts::pmf_sums(AmongManyLights(GetParam(), 300).trial())));
}

TEST_P(LightSamplers, E3_E8_E13_E14_E15_NoContributingLightIsLeftOut) {
    EXPECT_TRUE(holds(contracts::pmf_support(AmongManyLights(GetParam(), 2000).trial())));
}

TEST_P(LightSamplers, E9_C21_DrawnProbabilityIsTheEvaluatedOne) {
    EXPECT_TRUE(holds(contracts::pmf_of_draws(AmongManyLights(GetParam(), 200).trial())));
}

TEST_P(LightSamplers, E10_LightsAreDrawnAsOftenAsTheProbabilitySays) {
    EXPECT_TRUE(holds(contracts::draw_frequencies(AmongManyLights(GetParam(), 6).trial(), {})));
}

TEST_P(LightSamplers, E11_UnitsOfLengthDoNotMatter) {
    if (GetParam() == "bvh") GTEST_SKIP() << "compares the square of a distance to a length";
    const TestScene reference(contracts::many_lights());
    const PreparedSampler sampler(tested_sampler(GetParam()), reference.scene());
    const std::vector<Receiver> points = receivers(50);
    // Powers of two: rounding is the same, and so are the splits of trees.
    for (const double size : {0x1p-10, 0x1p10}) {
        const TestScene scaled(contracts::many_lights(size));
        const PreparedSampler other(tested_sampler(GetParam()), scaled.scene());
        const std::vector<Receiver> there = receivers(50, static_cast<float>(size));
        for (std::size_t i = 0; i < points.size(); ++i) {
            for (std::uint32_t light = 0; light < reference.scene().lights().size(); ++light) {
                const float expected = pmf(*sampler, points[i], light);
                EXPECT_NEAR(pmf(*other, there[i], light), expected, 1e-4f * expected + 1e-12f)
                    << "light " << light << " at size " << size;
            }
        }
    }
}

/// A floor with a camera, and lights.
std::string floor_below(const std::string& type, const std::string& lights) {
    return path_integrator(tested_sampler(type)) + shape("rectangle", scale(2), diffuse(0.5)) +
           xml({.to_world = look({0, 0, 2}, {0, 0, 0}), .fov = 5, .width = 16, .height = 16}) +
           lights;
}
FilmState lit_floor(const std::string& type, const std::string& lights, std::uint64_t samples) {
    return TestScene(floor_below(type, lights)).render({.per_pixel = samples});
}

TEST_P(LightSamplers, E1_NoLight) {
    const TestScene test(sphere({0, 0, 0}, 1, ""));
    const PreparedSampler sampler(tested_sampler(GetParam()), test.scene());
    EXPECT_FALSE(sampler->at(receivers(1).front()).sample(0.5).has_value());
    EXPECT_TRUE(is_constant(lit_floor(GetParam(), "", 4), 0));
}

TEST_P(LightSamplers, E2_OneLight) {
    for (const std::string& light :
         {point_light({0, 0, 1}, 1), constant_light(1), sphere({0, 0, 3}, 1, area_light(1))}) {
        const TestScene test(shape("rectangle", "", "") + light);
        const PreparedSampler sampler(tested_sampler(GetParam()), test.scene());
        const Receiver at{.p = {0.1f, 0, 0}, .error = 1e-6f};
        EXPECT_EQ(pmf(*sampler, at, 0), 1);
        EXPECT_EQ(sampler->at(at).sample(0.7)->light, 0u);
    }
    EXPECT_TRUE(agrees(pixel_statistics(lit_floor(GetParam(), constant_light(1), 64)), 0.5));
}

TEST_P(LightSamplers, E3_AllLightsBehindTheSurface) {
    const std::string lights = point_light({0, 0, -1}, 1) + point_light({1, 0, -2}, 1e6) +
                               shape("rectangle", translate({0, 0, -1}), area_light(1));
    EXPECT_TRUE(is_constant(lit_floor(GetParam(), lights, 16), 0));
}

TEST_P(LightSamplers, E4_C12_AllLightsAreBlack) {
    const std::string lights = point_light({0, 0, 1}, 0) + constant_light(0) +
                               sphere({0, 3, 1}, 0.5, area_light(0)) +
                               "<emitter type='directional'><rgb name='irradiance' value='0'/>"
                               "<vector name='direction' value='0, 0, -1'/></emitter>";
    EXPECT_TRUE(is_constant(lit_floor(GetParam(), lights, 16), 0));
}

TEST_P(LightSamplers, E4_BlackLightsAmongOthers) {
    std::string lights = constant_light(1);
    for (int i = 0; i < 5; ++i) lights += point_light({0.1 * i, 0, 1}, 0);
    lights += shape("rectangle", scale(0.5) + translate({0, 0, 3}), area_light(0));
    // Less than ½ only by the solid angle of the black square.
    const RunningStatistics mean = pixel_statistics(lit_floor(GetParam(), lights, 4096));
    EXPECT_GT(mean.mean(), 0.48);
    EXPECT_LT(mean.mean(), 0.5);
}

TEST_P(LightSamplers, E5_ADimLightBesideABrightOneIsNeverForgotten) {
    const TestScene test(shape("rectangle", "", "") + point_light({0, 0, 1}, 1e12) +
                         point_light({1, 0, 1}, 1) + point_light({2, 0, 1}, 1e-6));
    const PreparedSampler sampler(tested_sampler(GetParam()), test.scene());
    for (const Receiver& at : receivers(100)) {
        for (std::uint32_t light = 0; light < 3; ++light) {
            if (contracts::contributes(test.scene(), test.scene().lights()[light], at, false)) {
                EXPECT_GT(pmf(*sampler, at, light), 0);
            }
        }
    }
}

TEST_P(LightSamplers, E6_O24_ManyLights) {
    constexpr int count = 100000;
    std::string lights;
    for (int i = 0; i < count; ++i) {
        const double phi = 2 * std::numbers::pi * i / count;
        lights += point_light({3 * std::cos(phi), 3 * std::sin(phi), 4}, 1.0 / count);
    }
    const TestScene test(
        direct_integrator(tested_sampler(GetParam()) + integer("bsdf_samples", 0)) +
        shape("rectangle", scale(0.1), diffuse(0.5)) + probe({0, 0, 0}, {0, 0, 1}) + lights);
    ASSERT_EQ(test.scene().lights().size(), static_cast<std::size_t>(count));
    const PreparedSampler sampler(tested_sampler(GetParam()), test.scene());
    const Receiver at{.p = {0.01f, 0, 0}, .error = 1e-7f};
    EXPECT_NEAR(sum_of_probabilities(*sampler, at, count), 1, 1e-5);
    const bool looks_at_all = GetParam() == "exhaustive";
    const std::uint64_t samples = looks_at_all ? 2 : 512;
    EXPECT_TRUE(agrees(pixel_statistics(test.render({.per_pixel = samples})),
                       0.032 * 0.5 / std::numbers::pi, 0.003));
}

TEST_P(LightSamplers, E17_TheSameLightTwiceIsTwiceAsBright) {
    const std::string light =
        shape("rectangle", scale(0.5) + look({0, 0, 1}, {0, 0, 0}), diffuse(0) + area_light(1));
    const std::string point = point_light({0.3, 0.2, 0.5}, 1);
    const RunningStatistics twice = image_means(floor_below(GetParam(), point + point), 64, 8);
    const RunningStatistics once = image_means(floor_below(GetParam(), point), 64, 8);
    EXPECT_TRUE(agrees(twice, 2 * once.mean(), 0.002));
    // Coincident surfaces: the ray meets one of the two, light sampling finds both.
    EXPECT_EQ(lit_floor(GetParam(), light + light, 16).dropped_samples(), 0u);
}

}  // namespace
}  // namespace lucerna
