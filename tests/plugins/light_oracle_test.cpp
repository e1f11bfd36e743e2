// SPDX-License-Identifier: Apache-2.0
/// The oracle of `lucerna compare --oracle`: closed forms, and the variance of real draws.
#include "plugins/commands/compare/light_oracle.h"

#include "tests/prepared_sampler.h"
#include "tests/render_scene.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

/// What stands around the point (0, 0, 0) of a floor, which the camera sees.
TestScene scene_with(const std::string& lights, const std::string& sampler) {
    return TestScene(direct_integrator("<light_sampler type='" + sampler + "'/>") +
                     probe({0, 0, 0}, {0, 0, 1}) + shape("rectangle", scale(5), diffuse(0.5)) +
                     lights);
}

/// Lights of 1, 2, … n at one place.
std::string point_lights(int n) {
    std::string text;
    for (int i = 1; i <= n; ++i) text += point_light({1, 0, 2}, i);
    return text;
}

std::string square(Vector3d from, double size, const std::string& inside) {
    return shape("rectangle", scale(size) + look(from, {0, 0, 0}), inside);
}

/// Squares of many kinds: near and far, half hidden, hidden, half below the floor.
const std::string squares =
    square({1, 0, 1}, 0.3, area_light(3)) + square({-1, 0.5, 1.5}, 0.4, area_light(1)) +
    square({0, 2, 0.2}, 0.5, area_light(5)) + square({0, -3, 2}, 0.5, area_light(20)) +
    square({2, 2, 2}, 0.2, area_light(30)) + square({0, -1.5, 1}, 0.2, diffuse(0.5)) +
    square({1.2, 1.32, 1.2}, 0.15, diffuse(0.5));

std::vector<LightMoments> many_times(const Scene& scene, std::uint32_t tested, int times) {
    const auto points = oracle_points(scene, 0, 1, 0);
    std::vector<LightMoments> result;
    for (int i = 0; i < times; ++i) {
        const OracleOptions options{
            .samples = 4, .tested = tested, .seed = static_cast<std::uint64_t>(i)};
        result.push_back(LightOracle(scene, options).evaluate(points.at(0), 0));
    }
    return result;
}

RunningStatistics variances(const std::vector<LightMoments>& all, const LightSampler& sampler) {
    RunningStatistics result;
    for (const LightMoments& m : all) {
        double lost = 0;
        result.add(m.variance_of(sampler, lost));
        EXPECT_EQ(lost, 0);
    }
    return result;
}

TEST(LightOracle, gives_the_closed_form_for_point_lights) {
    constexpr int n = 9;
    const TestScene test = scene_with(point_lights(n), "uniform");
    const auto points = oracle_points(test.scene(), 0, 4, 0);
    ASSERT_EQ(points.size(), 4u);
    const OracleKind kind(evaluate_all(test.scene(), {}, points));
    // The squares of 1 … n are n (n + 1) (2 n + 1) / 6, and c = n (n + 1) / 2, in some unit.
    const double squares_sum = n * (n + 1) * (2 * n + 1) / 6.0, c = n * (n + 1) / 2.0;
    const double expected = (n * squares_sum - c * c) / (c * c * 1.0025);
    EXPECT_NEAR(kind.judge(*test.scene().light_sampler()).mean, expected, 1e-4 * expected);
    EXPECT_NEAR(kind.bound().mean, 0, 1e-6);
    EXPECT_NEAR(kind.unoccluded().mean, 0, 1e-6);
    EXPECT_EQ(kind.dark(), 0u);
}

TEST(LightOracle, power_is_ideal_where_only_power_differs) {
    const TestScene test = scene_with(point_lights(20), "power");
    const OracleKind kind(evaluate_all(test.scene(), {}, oracle_points(test.scene(), 0, 4, 0)));
    EXPECT_NEAR(kind.judge(*test.scene().light_sampler()).mean, 0, 1e-5);
}

/// The variance that estimates from real draws have.
RunningStatistics squared_deviations(const Scene& scene, const LightSampler& sampler) {
    const OraclePoint point = oracle_points(scene, 0, 1, 0).at(0);
    const Receiver from = point.receiver();
    const LightDistribution lights = sampler.at(from);
    Rng rng(77);
    std::vector<double> estimates(400000);
    double mean = 0;
    for (double& x : estimates) {
        const double u_light = rng.next_double();
        const Vector2 u = rng.next_float2();
        x = 0;
        const auto choice = lights.sample(u_light);
        if (!choice) continue;
        const Light& light = scene.lights()[choice->light];
        const auto to = light.emitter->sample_li(light, from, u);
        if (!to || scene.occluded(from, *to)) continue;
        const double cosine = std::max(0.0, static_cast<double>(glm::dot(to->wi, from.n)));
        x = 0.5 / std::numbers::pi * static_cast<double>(luminance(to->radiance)) * cosine /
            static_cast<double>(to->pdf) * static_cast<double>(choice->weight);
        mean += x / static_cast<double>(estimates.size());
    }
    RunningStatistics result;
    for (const double x : estimates) result.add((x - mean) * (x - mean));
    return result;
}

TEST(LightOracle, agrees_with_the_variance_of_real_draws) {
    for (const char* name : {"uniform", "power", "bvh", "exhaustive", "ris"}) {
        const TestScene test = scene_with(squares, name);
        const LightSampler& sampler = *test.scene().light_sampler();
        // What estimates one over its probabilities is judged by many draws each time.
        const int times = std::string(name) == "ris" ? 200 : 2000;
        const RunningStatistics told = variances(many_times(test.scene(), 1000, times), sampler);
        EXPECT_TRUE(agree(told, squared_deviations(test.scene(), sampler), 0.02)) << name;
    }
}

TEST(LightOracle, testing_some_of_the_lights_changes_no_mean) {
    const TestScene test = scene_with(squares + point_lights(5), "power");
    const LightSampler& sampler = *test.scene().light_sampler();
    const auto all = many_times(test.scene(), 1000, 4000),
               some = many_times(test.scene(), 3, 40000);
    EXPECT_TRUE(agree(variances(all, sampler), variances(some, sampler), 0.05));
    const auto over = [](const std::vector<LightMoments>& list, auto value) {
        RunningStatistics result;
        for (const LightMoments& m : list) result.add(value(m));
        return result;
    };
    const auto sum = [](const LightMoments& m) { return m.sum; };
    const auto square = [](const LightMoments& m) { return m.square; };
    EXPECT_TRUE(agree(over(all, sum), over(some, sum), 0.02));
    EXPECT_TRUE(agree(over(all, square), over(some, square), 0.05));
    std::size_t tested = 0;
    for (const LightMoments& m : some) tested += m.entries.size();
    EXPECT_LT(tested, 5 * some.size());
}

TEST(LightOracle, no_choice_is_better_than_the_bound) {
    const TestScene test = scene_with(squares, "uniform");
    const OracleKind kind(evaluate_all(test.scene(), {}, oracle_points(test.scene(), 0, 16, 0)));
    const double bound = kind.bound().mean;
    EXPECT_GT(bound, 0);
    EXPECT_GT(kind.unoccluded().mean, bound);
    EXPECT_GT(kind.judge(*test.scene().light_sampler()).mean, kind.unoccluded().mean);
}

/// Draws the first light only.
class FirstLight final : public LightSampler {
public:
    struct Distribution {
        std::optional<LightChoice> sample(double) const {
            return LightChoice{.light = 0, .pmf = 1};
        }
        float pmf(std::uint32_t light) const { return light == 0; }
    };
    Distribution at(const Receiver&) const { return {}; }
};

TEST(LightOracle, sees_lights_that_are_never_drawn) {
    const TestScene test = scene_with(point_lights(3), "uniform");
    const OracleKind kind(evaluate_all(test.scene(), {}, oracle_points(test.scene(), 0, 5, 0)));
    FirstLight first;
    LightSampler::Batch::attach(first);
    const OracleFigures figures = kind.judge(first);
    EXPECT_EQ(figures.blind, 5u);
    EXPECT_NEAR(figures.lost, 5.0 / 6, 1e-6);  // of 1 + 2 + 3
    EXPECT_EQ(kind.judge(*test.scene().light_sampler()).blind, 0u);
}

TEST(LightOracle, bounds_its_work) {
    const OracleOptions few = OracleOptions::for_lights(5000, 200);
    EXPECT_EQ(few.points, 200u);
    EXPECT_EQ(few.samples, 4u);
    const OracleOptions many = OracleOptions::for_lights(1000000, 200);
    EXPECT_EQ(many.points, 50u);
    EXPECT_EQ(many.samples, 2u);
}

}  // namespace
}  // namespace lucerna
