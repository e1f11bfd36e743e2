// SPDX-License-Identifier: Apache-2.0
/// Depth is the distance from the lens, wherever the near clip plane lies.
#include "tests/render_scene.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lucerna {
namespace {

/// A wall at z = 1, seen from the origin at `degrees` from its normal.
std::string wall_seen_by(const std::string& camera, double near_clip, double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    const std::string thinlens = number("aperture_radius", 1e-6) + number("focus_distance", 1);
    return xml({.to_world = look({0, 0, 0}, {std::tan(angle), 0, 1}),
                .near_clip = near_clip,
                .type = camera,
                .inside = camera == "thinlens" ? thinlens : ""}) +
           shape("rectangle", scale(5) + translate({0, 0, 1}), "");
}

TEST(Depth, P7_CountsFromTheLensAndNotFromTheNearClipPlane) {
    for (const char* camera : {"perspective", "thinlens", "orthographic"}) {
        for (const double near_clip : {0.01, 0.5}) {
            for (const double degrees : {0.0, 30.0}) {
                if (degrees > 0 && camera == std::string_view("orthographic")) continue;
                SCOPED_TRACE(testing::Message() << camera << near_clip << " " << degrees);
                const double expected = 1 / std::cos(degrees * std::numbers::pi / 180);
                const std::string wall = wall_seen_by(camera, near_clip, degrees);
                const TestScene depth("<integrator type='depth'/>" + wall);
                EXPECT_TRUE(is_constant(depth.render({}), expected, 2e-4));
                const TestScene aov(
                    "<integrator type='aov'><string name='aovs' value='d:depth'/>"
                    "</integrator>" +
                    wall);
                EXPECT_TRUE(is_constant(aov.render({}), expected, 2e-4));
            }
        }
    }
}

TEST(Depth, OfATiltedOrthographicCamera) {
    const TestScene scene("<integrator type='depth'/>" +
                          xml({.to_world = scale(1e-4) + look({0, 0, 0}, {1, 0, 1}),
                               .near_clip = 0.25,
                               .type = "orthographic"}) +
                          shape("rectangle", scale(5) + translate({0, 0, 1}), ""));
    EXPECT_TRUE(is_constant(scene.render({}), std::sqrt(2), 2e-4));
}

}  // namespace
}  // namespace lucerna
