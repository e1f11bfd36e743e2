// SPDX-License-Identifier: Apache-2.0
/// Light samplers at points of media, which have no normal: for all of them by name.
#include "core/interfaces/light_sampler.h"
#include "plugins/commands/contracts/light_sampler.h"
#include "plugins/light_samplers/learning/pilot_paths.h"
#include "tests/prepared_sampler.h"
#include "tests/render_scene.h"

#include <fmt/format.h>

namespace lucerna {
namespace {

class LightsInMedia : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(All, LightsInMedia, testing::ValuesIn(tested_samplers()),
                         [](const auto& type) { return type.param; });

/// Lamps of each kind over a floor, in fog.
std::string foggy_yard() {
    TestCamera camera{
        .to_world = look({7, -8, 6}, {0, 0, 0.5}), .fov = 50, .width = 32, .height = 32};
    camera.inside = "<medium type='homogeneous'>" + number("sigma_t", 0.1) + "</medium>";
    std::string text = "<integrator type='volpath'/>" + xml(camera) + constant_light(0.02) +
                       shape("rectangle", scale(10), diffuse(0.5));
    for (int i = 0; i < 25; ++i) {
        const double x = 2.0 * (i % 5) - 4, y = 2.0 * (i / 5) - 4;
        text += shape("rectangle", scale(0.1) + look({x, y, 0.5}, {x + 1, y, 0.7}), area_light(3));
        text += point_light({x + 1, y + 0.7, 0.3}, 0.2 + 0.05 * i);
        text += sphere({x - 0.9, y + 0.2, 0.4}, 0.05, area_light(20));
    }
    return text;
}

/// Points that the fog scatters to the camera, and some that no path has met.
std::vector<Receiver> points_in_fog(const Scene& scene) {
    std::vector<Receiver> points;
    for (const Receiver& at :
         pilot_receivers(scene, {.count = 64, .bounces = 1, .seed = 5}, Workers(1))) {
        if (!at.has_normal() && points.size() < 24) points.push_back(at);
    }
    for (const Vector3 p : {Vector3(0, 0, 40), Vector3(0.1f, 0.2f, 0.5f), Vector3(-9, 9, 0.01f)}) {
        points.push_back(Receiver::in_medium(*scene.sensor().medium(), p, {0, 0, 1}, 0));
    }
    return points;
}

TEST_P(LightsInMedia, E7_E8_E9_ProbabilitiesHold) {
    const TestScene scene(foggy_yard());
    const PreparedSampler sampler(tested_sampler(GetParam()), scene.scene());
    const std::vector<Receiver> points = points_in_fog(scene.scene());
    ASSERT_GT(points.size(), 20u);
    const std::size_t lights = scene.scene().lights().size();
    for (const Receiver& at : points) {
        ASSERT_FALSE(at.has_normal());
        const LightDistribution distribution = sampler->at(at);
        double sum = 0;
        for (std::uint32_t i = 0; i < lights; ++i) {
            const float pmf = distribution.pmf(i);
            EXPECT_GE(pmf, 0);
            sum += static_cast<double>(pmf);
            const Light& light = scene.scene().lights()[i];
            const auto lit = light.emitter->sample_li(light, at, Vector2(0.4f, 0.6f));
            if (lit && !is_black(lit->radiance) && !scene.scene().occluded(at, *lit)) {
                EXPECT_GT(pmf, 0) << "light " << i;
            }
        }
        // Samplers may leave lights out that their lists hold twice.
        EXPECT_LE(sum, 1 + 1e-4);
        EXPECT_GT(sum, 0.5);
    }
}

TEST_P(LightsInMedia, DrawsFollowTheProbabilities) {
    const TestScene scene(foggy_yard());
    const PreparedSampler sampler(tested_sampler(GetParam()), scene.scene());
    const std::vector<Receiver> points = points_in_fog(scene.scene());
    std::vector<Receiver> some;
    for (std::size_t k = 0; k < points.size(); k += 5) some.push_back(points[k]);
    const contracts::LightSamplerTrial trial{
        .sampler = *sampler, .scene = scene.scene(), .points = some};
    EXPECT_TRUE(holds(contracts::pmf_of_draws(trial)));
    EXPECT_TRUE(holds(contracts::draw_frequencies(trial, {})));
}

}  // namespace
}  // namespace lucerna
