// SPDX-License-Identifier: Apache-2.0
/// Different ways to find the same light have the same mean.
#include "tests/render_scene.h"

#include <fmt/format.h>

namespace lucerna {
namespace {

std::string rough_metal(double alpha) {
    return "<bsdf type='roughconductor'><string name='distribution' value='ggx'/>" +
           number("alpha", alpha) + "<string name='material' value='Cr'/></bsdf>";
}

/// A corner with glossy and diffuse things and lights of many kinds.
const std::string still_life =
    xml({.to_world = look({3, 2.5, 4}, {0, 0.6, 0}),
         .fov = 45,
         .width = 24,
         .height = 16,
         .sampler = "sobol"}) +
    shape("rectangle", scale(6) + look({0, 0, 0}, {0, 1, 0}), rough_metal(0.3)) +
    shape("rectangle", scale(6) + translate({0, 0, -3}), diffuse(0.7)) +
    sphere({0, 0.7, 0}, 0.7, rough_metal(0.2)) + sphere({1.6, 0.5, 0.5}, 0.5, diffuse(0.6)) +
    shape("cube", scale(0.4) + translate({-1.5, 0.4, 0.8}),
          "<bsdf type='roughplastic'>" + number("alpha", 0.2) + "</bsdf>");

const std::string surface_lights =
    shape("rectangle", scale(0.8) + look({-2, 4, 2}, {0, 0, 0}), diffuse(0) + area_light(6)) +
    sphere({2.5, 3, 1}, 0.5, diffuse(0) + area_light(8)) +
    shape("disk", scale(0.7) + look({0, 3, 3}, {0, 0, 0}), diffuse(0.5) + area_light(5)) +
    shape("cube", scale(0.3) + translate({-2.2, 1.2, 0}), diffuse(0.5) + area_light(4));

const std::string other_lights =
    point_light({1, 2, 2}, 3) + constant_light(0.2) +
    "<emitter type='directional'><vector name='direction' value='-1, -2, -1'/>"
    "<rgb name='irradiance' value='0.7'/></emitter>"
    "<emitter type='spot'><rgb name='intensity' value='9'/><transform name='to_world'>" +
    look({0, 4, 1}, {0.3, 0, 0}) + "</transform></emitter>";

std::string strategies(int emitter_samples, int bsdf_samples) {
    return direct_integrator(integer("emitter_samples", emitter_samples) +
                             integer("bsdf_samples", bsdf_samples)) +
           still_life + surface_lights;
}

TEST(Strategies, G11_DirectAndPathAtDepthTwo) {
    const std::string content = still_life + surface_lights + other_lights;
    const auto depth_two = [](const std::string& inside) {
        return path_integrator(integer("max_depth", 2) + inside);
    };
    const RunningStatistics direct =
        image_means(with_all_lights(direct_integrator, content) + content, 96);
    const RunningStatistics path = image_means(with_all_lights(depth_two, content) + content, 96);
    EXPECT_TRUE(agree(direct, path));
}

TEST(Strategies, G7_G11_E19_EachStrategyAlone) {
    const RunningStatistics both = image_means(strategies(1, 1), 128);
    EXPECT_TRUE(agree(image_means(strategies(1, 0), 128), both));
    EXPECT_TRUE(agree(image_means(strategies(0, 1), 384), both, 0.003));
    EXPECT_TRUE(agree(image_means(strategies(3, 2), 64), both));
    EXPECT_TRUE(agree(image_means(strategies(1, 4), 64), both));
}

/// Lights of all kinds, many of them small.
std::string with_sampler(const std::string& sampler, int emitter_samples = 0) {
    std::string content =
        path_integrator(integer("max_depth", 3) + integer("emitter_samples", emitter_samples) +
                        "<light_sampler type='" + sampler + "'/>") +
        still_life + surface_lights + other_lights;
    for (int i = 0; i < 12; ++i) {
        content += point_light({-2 + 0.4 * i, 1.5 + 0.1 * i, 2.5 - 0.2 * i}, 0.1 + 0.05 * i);
    }
    return content;
}

TEST(Strategies, G11_E8_E18_EveryLightSamplerHasTheSameMean) {
    const RunningStatistics all = image_means(with_sampler("uniform", 24), 24);
    Registry registry;
    for (const std::string& name : registry.names("light_sampler")) {
        EXPECT_TRUE(
            agree(image_means(with_sampler(name), name == "uniform" ? 384 : 192), all, 0.003))
            << name;
    }
}

TEST(Strategies, O28_MovedTurnedAndScaledSceneIsTheSame) {
    const auto placed = [](const std::string& motion) {
        const auto put = [&](const std::string& type, const std::string& steps,
                             const std::string& inside) {
            return shape(type, steps + motion, inside);
        };
        return direct_integrator() +
               xml({.to_world = look({3, 2.5, 4}, {0, 0.6, 0}) + motion,
                    .fov = 45,
                    .width = 24,
                    .height = 16,
                    .sampler = "sobol"}) +
               put("rectangle", scale(6) + look({0, 0, 0}, {0, 1, 0}), rough_metal(0.3)) +
               put("sphere", scale(0.7) + translate({0, 0.7, 0}), rough_metal(0.2)) +
               put("cube", scale(0.4) + translate({-1.5, 0.4, 0.8}), diffuse(0.7)) +
               put("disk", scale(0.7) + look({0, 3, 3}, {0, 0, 0}), diffuse(0.5) + area_light(5));
    };
    const RunningStatistics still = image_means(placed(""), 128, 2);
    const std::string turned = "<rotate value='1, 2, 3' angle='70'/>" + translate({3, -4, 5});
    // The same random numbers: what differs is rounding, pixels at edges, and tangents.
    EXPECT_NEAR(image_means(placed(turned), 128, 2).mean() / still.mean(), 1, 1e-3);
}

}  // namespace
}  // namespace lucerna
