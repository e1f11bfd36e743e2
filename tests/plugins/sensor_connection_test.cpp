// SPDX-License-Identifier: Apache-2.0
/// `Sensor::connect` is the inverse of `Sensor::sample_ray`.
#include "core/interfaces/sensor.h"
#include "core/math/sequences.h"
#include "tests/plugins/workshop.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

const std::string inside =
    "<transform name='to_world'><lookat origin='1 2 3' target='-4 0 2' up='0 0 1'/></transform>"
    "<film type='hdrfilm'><integer name='width' value='64'/><integer name='height' value='48'/>"
    "</film>";
/// Types, and what else they need.
const std::pair<std::string, std::string> sensors[] = {
    {"perspective", ""},
    {"orthographic", ""},
    {"thinlens", number("aperture_radius", 0.2) + number("focus_distance", 3)}};

class SensorConnections : public testing::Test {
protected:
    const Sensor& make(const std::string& type, const std::string& body) {
        return workshop_.make<Sensor>("<sensor type='" + type + "'>" + body + inside + "</sensor>");
    }
    Workshop workshop_;
};

TEST_F(SensorConnections, InvertsRays) {
    for (const auto& [type, body] : sensors) {
        SCOPED_TRACE(type);
        const Sensor& sensor = make(type, body);
        Rng rng(1);
        for (int i = 0; i < 1000; ++i) {
            const Vector2 position = Vector2(80, 60) * rng.next_float2() - 8.0f;
            const Vector2 u_lens = rng.next_float2();
            const Ray ray = sensor.sample_ray(position, u_lens);
            const float t = 1 + 5 * rng.next_float();
            const auto seen = sensor.connect(ray.o + t * ray.d, u_lens);
            ASSERT_TRUE(seen);
            EXPECT_LT(glm::length(seen->position - position), 1e-3f);
            EXPECT_LT(glm::length(seen->p - ray.o), 1e-5f);
            EXPECT_LT(glm::length(seen->wi + ray.d), 1e-5f);
            EXPECT_NEAR(seen->distance, t, 1e-4f);
            EXPECT_FALSE(sensor.connect(ray.o - 0.1f * ray.d, u_lens)) << "behind";
        }
    }
}

/// A small square that faces the lens covers importance · area of the film.
TEST_F(SensorConnections, ImportanceIsTheScaleOfTheImage) {
    for (const auto& [type, body] : sensors) {
        SCOPED_TRACE(type);
        const Sensor& sensor = make(type, body);
        Rng rng(2);
        for (int i = 0; i < 100; ++i) {
            const Vector2 u_lens = rng.next_float2();
            const Ray ray = sensor.sample_ray(Vector2(64, 48) * rng.next_float2(), u_lens);
            const Vector3 p = ray.o + 4.0f * ray.d;
            const Frame facing = Frame::from_normal(ray.d);
            const auto at = [&](Vector3 offset) {
                return sensor.connect(p + offset, u_lens)->position;
            };
            const float h = 0.02f;
            const Vector2 a = (at(h * facing.s) - at(-h * facing.s)) / (2 * h);
            const Vector2 b = (at(h * facing.t) - at(-h * facing.t)) / (2 * h);
            const float importance = sensor.connect(p, u_lens)->importance;
            EXPECT_NEAR(std::abs(a.x * b.y - a.y * b.x), importance, 0.003f * importance);
        }
    }
}

}  // namespace
}  // namespace lucerna
