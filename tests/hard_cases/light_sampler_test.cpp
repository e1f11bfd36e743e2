// SPDX-License-Identifier: Apache-2.0
/// What holds for every light sampler there is: probabilities add up, are those with which lights
/// are drawn, and leave out no light that contributes.
#include "core/interfaces/light_sampler.h"
#include "core/interfaces/bsdf.h"
#include "tests/prepared_sampler.h"
#include "tests/render_scene.h"

#include <fmt/format.h>

#include <random>

namespace lucerna {
namespace {

class LightSamplers : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(All, LightSamplers, testing::ValuesIn(tested_samplers()),
                         [](const auto& type) { return type.param; });

/// A few rooms' worth of lights of all kinds and of very different powers.
std::string many_lights(double size = 1) {
    const auto at = [&](double x, double y, double z) { return size * Vector3d(x, y, z); };
    std::string content =
        xml({.to_world = look(at(4, -6, 5), at(0, 0, 0)),
             .fov = 60,
             .near_clip = 1e-3 * size,
             .far_clip = 1e6 * size}) +
        shape("rectangle", scale(10 * size), diffuse(0.5)) +
        shape("rectangle", scale(0.5 * size) + translate(at(-2, 1, 0.01)), area_light(3)) +
        shape("rectangle", scale(size) + look(at(1, 1, 3), at(0, 0, 0)), area_light(2)) +
        shape("disk", scale(0.3 * size) + look(at(-3, 1, 2), at(-4, 1, 2)), area_light(9)) +
        sphere(at(2, -2, 1), 0.4 * size, area_light(5)) +
        shape("cube", scale(0.2 * size) + translate(at(0, 3, 1)), area_light(0.1)) +
        shape("sphere", scale(1e-4 * size) + translate(at(0, 0, 1)), area_light(1e3)) +
        constant_light(0.1) +
        "<emitter type='directional'><vector name='direction' value='1, 0, -1'/></emitter>";
    for (int i = 0; i < 20; ++i) {
        const double x = std::cos(2.4 * i), y = std::sin(2.4 * i);
        content += point_light(at(0.2 * i * x, 0.2 * i * y, 0.1 + 0.1 * i),
                               size * size * std::pow(10, 0.25 * (i % 9) - 1));
        content += fmt::format(
            "<emitter type='spot'><rgb name='intensity' value='{}'/>"
            "<float name='cutoff_angle' value='{}'/><transform name='to_world'>{}</transform>"
            "</emitter>",
            size * size * (1 + i), 5 + 8 * i, look(at(3 * y, 3 * x, 2), at(x, 0.1 * i, 0)));
    }
    return content;
}

/// Points and normals all over the place, some of them on lights or at their centres.
std::vector<Receiver> receivers(int count, float size = 1) {
    std::mt19937 engine(1);
    std::uniform_real_distribution<float> number(-1, 1);
    std::vector<Receiver> result;
    for (int i = 0; i < count; ++i) {
        const float x = number(engine), y = number(engine), z = number(engine);
        const float a = number(engine), b = number(engine), c = number(engine);
        Receiver at{.p = size * Vector3(4 * x, 4 * y, 2 + 2 * z),
                    .n = glm::normalize(Vector3(a, b, c)),
                    .error = 1e-6f * size};
        at.ns = at.n;
        at.sides = i % 3 == 0 ? Sides::both : Sides::front;
        result.push_back(at);
    }
    for (const Vector3 p : {Vector3(2, -2, 1), Vector3(0, 0, 1), Vector3(1, 1, 3), Vector3(0),
                            Vector3(-2, 1, 0.01f), Vector3(0, 0, 0.1f)}) {
        result.push_back({.p = size * p, .sides = Sides::both});
    }
    return result;
}

/// True if light of this light can reach the receiver's side.
bool contributes(const Light& light, const Receiver& at) {
    for (int i = 0; i < 16; ++i) {
        const Vector2 u(static_cast<float>(i % 4) / 4 + 0.1f, static_cast<float>(i / 4) / 4 + 0.1f);
        const auto sample = light.emitter->sample_li(light, at, u);
        if (!sample || is_black(sample->radiance) || !(sample->pdf > 0)) continue;
        const float cosine = glm::dot(sample->wi, at.n);
        if (at.sides == Sides::both ? cosine != 0 : cosine > 1e-5f) return true;
    }
    return false;
}

double sum_of_probabilities(const LightSampler& sampler, const Receiver& at, std::size_t lights) {
    double sum = 0;
    for (std::uint32_t light = 0; light < lights; ++light) {
        const float p = sampler.pmf(at, light);
        EXPECT_TRUE(std::isfinite(p) && p >= 0) << light << ": " << p;
        sum += static_cast<double>(p);
    }
    return sum;
}

TEST_P(LightSamplers, E7_E12_E16_ProbabilitiesAddUp) {
    const TestScene test(many_lights());
    const PreparedSampler sampler(tested_sampler(GetParam()), test.scene());
    for (const Receiver& at : receivers(300)) {
        const double sum = sum_of_probabilities(*sampler, at, test.scene().lights().size());
        EXPECT_LE(sum, sampler->draws() * (1 + 1e-5));
        // Less only as far as draws choose no light.
        constexpr int trials = 4000;
        double empty = 0;
        const std::uint32_t draws = std::min(sampler->draws(), 8u);
        for (int i = 0; i < trials; ++i) {
            for (std::uint32_t draw = 0; draw < draws; ++draw) {
                const float u = (static_cast<float>(i) + 0.5f) / trials;
                empty += !sampler->sample(at, draw, u);
            }
        }
        EXPECT_NEAR(sum / sampler->draws(), 1 - empty / (trials * draws), 2e-3)
            << text_of(Vector3d(at.p));
    }
}

TEST_P(LightSamplers, E3_E8_E13_E14_E15_NoContributingLightIsLeftOut) {
    const TestScene test(many_lights());
    const Scene& scene = test.scene();
    const PreparedSampler sampler(tested_sampler(GetParam()), scene);
    int pairs = 0;
    for (const Receiver& at : receivers(2000)) {
        for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
            if (sampler->pmf(at, i) > 0 || !contributes(scene.lights()[i], at)) continue;
            ++pairs;
        }
    }
    EXPECT_EQ(pairs, 0);
}

TEST_P(LightSamplers, E9_C21_DrawnProbabilityIsTheEvaluatedOne) {
    const TestScene test(many_lights());
    const PreparedSampler sampler(tested_sampler(GetParam()), test.scene());
    for (const Receiver& at : receivers(200)) {
        for (const float u : {0.0f, 0x1p-24f, 0.1f, 0.37f, 0.5f, 0.73f, 0.9f, 1 - 0x1p-24f}) {
            for (std::uint32_t draw = 0; draw < sampler->draws(); ++draw) {
                const auto choice = sampler->sample(at, draw, u);
                if (!choice) continue;
                ASSERT_LT(choice->light, test.scene().lights().size());
                EXPECT_GT(choice->pmf, 0);
                EXPECT_EQ(choice->pmf, sampler->pmf(at, choice->light));
            }
        }
    }
}

TEST_P(LightSamplers, E10_LightsAreDrawnAsOftenAsTheProbabilitySays) {
    const TestScene test(many_lights());
    const std::size_t lights = test.scene().lights().size();
    const PreparedSampler sampler(tested_sampler(GetParam()), test.scene());
    std::mt19937 engine(2);
    std::uniform_int_distribution<int> bits(0, (1 << 24) - 1);
    const bool one_draw_each = sampler->draws() > 1;
    for (const Receiver& at : receivers(6)) {
        constexpr int trials = 60000;
        std::vector<double> observed(lights + 1), expected(lights + 1);
        for (int i = 0; i < trials; ++i) {
            for (std::uint32_t draw = 0; draw < sampler->draws(); ++draw) {
                const float u = static_cast<float>(bits(engine)) * 0x1p-24f;
                const auto choice = sampler->sample(at, draw, u);
                ++observed[choice ? choice->light : lights];
            }
        }
        double rest = sampler->draws();
        for (std::uint32_t i = 0; i < lights; ++i) {
            expected[i] = trials * static_cast<double>(sampler->pmf(at, i));
            rest -= static_cast<double>(sampler->pmf(at, i));
        }
        expected[lights] = rest > 2e-6 * sampler->draws() ? trials * rest : 0;
        if (one_draw_each && observed == expected) continue;  // nothing is left to chance
        EXPECT_TRUE(counts_match(observed, expected, 1e-3 / 12));
    }
}

TEST_P(LightSamplers, E11_UnitsOfLengthDoNotMatter) {
    if (GetParam() == "bvh") GTEST_SKIP() << "compares the square of a distance to a length";
    const TestScene reference(many_lights());
    const PreparedSampler sampler(tested_sampler(GetParam()), reference.scene());
    const std::vector<Receiver> points = receivers(50);
    // Powers of two: rounding is the same, and so are the splits of trees.
    for (const double size : {0x1p-10, 0x1p10}) {
        const TestScene scaled(many_lights(size));
        const PreparedSampler other(tested_sampler(GetParam()), scaled.scene());
        const std::vector<Receiver> there = receivers(50, static_cast<float>(size));
        for (std::size_t i = 0; i < points.size(); ++i) {
            for (std::uint32_t light = 0; light < reference.scene().lights().size(); ++light) {
                const float expected = sampler->pmf(points[i], light);
                EXPECT_NEAR(other->pmf(there[i], light), expected, 1e-4f * expected + 1e-12f)
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
    EXPECT_EQ(sampler->draws(), 0u);
    EXPECT_TRUE(is_constant(lit_floor(GetParam(), "", 4), 0));
}

TEST_P(LightSamplers, E2_OneLight) {
    for (const std::string& light :
         {point_light({0, 0, 1}, 1), constant_light(1), sphere({0, 0, 3}, 1, area_light(1))}) {
        const TestScene test(shape("rectangle", "", "") + light);
        const PreparedSampler sampler(tested_sampler(GetParam()), test.scene());
        const Receiver at{.p = {0.1f, 0, 0}, .error = 1e-6f};
        ASSERT_EQ(sampler->draws(), 1u);
        EXPECT_EQ(sampler->pmf(at, 0), 1);
        EXPECT_EQ(sampler->sample(at, 0, 0.7f)->light, 0u);
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
            if (contributes(test.scene().lights()[light], at)) {
                EXPECT_GT(sampler->pmf(at, light), 0);
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
    EXPECT_NEAR(sum_of_probabilities(*sampler, at, count) / sampler->draws(), 1, 1e-5);
    // Some look at every light.
    const bool slow = sampler->draws() > 1000 || GetParam() == "exhaustive";
    const std::uint64_t samples = slow ? 2 : 512;
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
