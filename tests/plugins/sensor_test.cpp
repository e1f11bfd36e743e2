// SPDX-License-Identifier: Apache-2.0
/// What every sensor must satisfy, tried on all that the registry finds, and the geometry of each.
#include "core/interfaces/sensor.h"
#include "core/math/sequences.h"
#include "core/scene/scene.h"
#include "plugins/commands/contracts/sensor.h"
#include "tests/plugins/workshop.h"
#include "tests/statistics.h"

#include <map>

namespace lucerna {
namespace {

std::string sensor(const std::string& type, const std::string& body = "") {
    return fmt::format("<sensor type='{}'>{}</sensor>", type, body);
}
std::string film(int width, int height) {
    return "<film type='hdrfilm'>" + whole("width", width) + whole("height", height) + "</film>";
}
std::string to_world(const std::string& steps) {
    return "<transform name='to_world'>" + steps + "</transform>";
}

/// What a plugin cannot be made without.
const std::map<std::string, std::string> bodies = {
    {"thinlens", number("aperture_radius", 0.1) + number("focus_distance", 3)}};

std::string body_of(const std::string& type) {
    const auto found = bodies.find(type);
    return found == bodies.end() ? "" : found->second;
}

/// The direction of a ray in degrees to the left of and above the view along +z.
Vector2d angles(const Ray& ray) {
    const Vector3d d(ray.d);
    const double degrees = 180 / std::numbers::pi;
    return {std::atan2(d.x, d.z) * degrees, std::atan2(d.y, d.z) * degrees};
}

class Sensors : public testing::Test {
protected:
    const Sensor& make(const std::string& type, const std::string& body = "") {
        return workshop_.make<Sensor>(sensor(type, body_of(type) + body));
    }
    /// A perspective sensor of a film of 400 × 200.
    const Sensor& wide(const std::string& body) {
        return make("perspective", film(400, 200) + body);
    }

    Workshop workshop_;
};

TEST_F(Sensors, RaysAreUnitAndFinite) {
    const auto names = workshop_.registry().names("sensor");
    EXPECT_GE(names.size(), 3u);
    const std::string pose = to_world("<lookat origin='1 2 3' target='-4 0 2' up='0 0 1'/>");
    for (const std::string& name : names) {
        SCOPED_TRACE(name);
        const Sensor& s = make(name, pose + film(64, 48));
        EXPECT_TRUE(holds(contracts::sensor_rays(s, {})));
        EXPECT_TRUE(holds(contracts::sensor_connections(s, {})));
        EXPECT_TRUE(holds(contracts::sensor_importance(s, {})));
        EXPECT_GT(glm::dot(s.sample_ray({32, 24}, {0.5f, 0.5f}).d, Vector3(-5, -2, -1)), 0);
        EXPECT_TRUE(s.connect({-4, 0, 2}, {0.5f, 0.5f}));
    }
}

TEST_F(Sensors, TheCentreLooksAlongTheView) {
    for (const std::string& name : workshop_.registry().names("sensor")) {
        SCOPED_TRACE(name);
        const Sensor& s = make(
            name, film(64, 48) + to_world("<lookat origin='1 2 3' target='1 7 3' up='0 0 1'/>"));
        const Ray middle = s.sample_ray({32, 24}, {0.5f, 0.5f});
        EXPECT_NEAR(middle.d.y, 1, 1e-6f);
        EXPECT_NEAR(middle.o.x, 1, 1e-5f);
        EXPECT_NEAR(middle.o.z, 3, 1e-5f);
        // Looking along +y with z up, +x is to the right, where film x grows; film y grows down.
        const Ray right = s.sample_ray({60, 24}, {0.5f, 0.5f});
        const Ray low = s.sample_ray({32, 40}, {0.5f, 0.5f});
        EXPECT_GT((right.o + 10.0f * right.d).x, 1);
        EXPECT_LT((low.o + 10.0f * low.d).z, 3);
    }
}

TEST_F(Sensors, I2_AMirroringTransformMirrorsTheImage) {
    for (const std::string& name : workshop_.registry().names("sensor")) {
        SCOPED_TRACE(name);
        const Sensor& s = make(name, film(64, 48));
        const Sensor& mirrored = make(name, film(64, 48) + to_world("<scale x='-1'/>"));
        const Ray a = s.sample_ray({10, 15}, {0.5f, 0.5f});
        const Ray b = mirrored.sample_ray({54, 15}, {0.5f, 0.5f});
        EXPECT_LT(glm::length(a.d - b.d), 1e-6f);
        EXPECT_LT(glm::length(a.o - b.o), 1e-6f);
    }
}

TEST_F(Sensors, I5_LookAtWithAParallelUpVector) {
    const std::string pose = to_world("<lookat origin='0 5 0' target='0 0 0' up='0 1 0'/>");
    const Ray ray = make("perspective", pose).sample_ray({384, 288}, {0, 0});
    EXPECT_NEAR(ray.d.y, -1, 1e-6f);
}

TEST_F(Sensors, I6_TinyFieldsOfViewResolveTheirPixels) {
    const Sensor& s = make("perspective", number("fov", 0.01) + film(16, 16));
    for (int x = 0; x < 16; ++x) {
        const Vector2 position(static_cast<float>(x) + 0.5f, 8);
        const double wanted = 0.01 * (0.5 - static_cast<double>(position.x) / 16);
        EXPECT_NEAR(angles(s.sample_ray(position, {0, 0})).x, wanted, 1e-5);
    }
}

TEST_F(Sensors, I7_FieldsOfViewAreExactUpToNearly180Degrees) {
    for (const double fov : {0.01, 1.0, 45.0, 90.0, 179.0}) {
        SCOPED_TRACE(fov);
        const Sensor& s = wide(number("fov", fov));
        EXPECT_NEAR(angles(s.sample_ray({0, 100}, {0, 0})).x, fov / 2, 1e-4);
        EXPECT_NEAR(angles(s.sample_ray({400, 100}, {0, 0})).x, -fov / 2, 1e-4);
    }
    for (const double fov : {0.0, 180.0, -5.0}) {
        EXPECT_NE(refusal(sensor("perspective", number("fov", fov))), "") << fov;
    }
}

TEST_F(Sensors, I9_AxisOfTheFieldOfView) {
    const auto corner = [&](const Sensor& s) { return angles(s.sample_ray({0, 0}, {0, 0})); };
    const auto axis = [](const char* name) { return number("fov", 60) + word("fov_axis", name); };
    const double along = 30, across = std::atan(std::tan(along * std::numbers::pi / 180) / 2) *
                                      180 / std::numbers::pi;
    EXPECT_NEAR(corner(wide(axis("x"))).x, along, 1e-4);
    EXPECT_NEAR(corner(wide(axis("x"))).y, across, 1e-4);
    EXPECT_NEAR(corner(wide(axis("y"))).y, along, 1e-4);
    EXPECT_NEAR(corner(wide(axis("larger"))).x, along, 1e-4);
    EXPECT_NEAR(corner(wide(axis("smaller"))).y, along, 1e-4);
    const Sensor& tall = make("perspective", film(200, 400) + axis("smaller"));
    EXPECT_NEAR(corner(tall).x, along, 1e-4);
    const Ray diagonal = wide(axis("diagonal")).sample_ray({0, 0}, {0, 0});
    EXPECT_NEAR(std::acos(diagonal.d.z) * 180 / pi, along, 1e-3);
}

TEST_F(Sensors, I9_PixelsCoverTheSolidAngleOfTheImage) {
    const Sensor& s = wide(number("fov", 90));
    double sum = 0;
    const double pixel = 2.0 / 400;
    for (int y = 0; y < 200; ++y) {
        for (int x = 0; x < 400; ++x) {
            const Vector2 position(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
            sum += pixel * pixel * std::pow(static_cast<double>(s.sample_ray(position, {}).d.z), 3);
        }
    }
    // Of a rectangle of 2a × 2b at distance 1: 4 asin(ab / √((1 + a²)(1 + b²))).
    EXPECT_NEAR(sum, 4 * std::asin(0.5 / std::sqrt(2 * 1.25)), 1e-5);
}

TEST_F(Sensors, FocalLengthIsThatOfFilmOf35mm) {
    const auto half_diagonal = [&](const std::string& body) {
        return std::acos(static_cast<double>(wide(body).sample_ray({0, 0}, {}).d.z));
    };
    EXPECT_NEAR(half_diagonal(""), std::atan(std::hypot(18, 12) / 50), 1e-5);
    EXPECT_NEAR(half_diagonal(word("focal_length", "21.5mm")), std::atan(std::hypot(18, 12) / 21.5),
                1e-5);
    EXPECT_NEAR(half_diagonal(word("focal_length", "85")), std::atan(std::hypot(18, 12) / 85),
                1e-5);
    for (const char* wrong : {"", "mm", "-5mm", "0", "12 apples"}) {
        EXPECT_NE(refusal(sensor("perspective", word("focal_length", wrong))), "") << wrong;
    }
    EXPECT_NE(refusal(sensor("perspective", word("focal_length", "50mm") + number("fov", 40))), "");
}

TEST_F(Sensors, PrincipalPointMovesTheFilm) {
    const Sensor& s = wide(number("fov", 50));
    const Sensor& moved = wide(number("fov", 50) + number("principal_point_offset_x", 0.25) +
                               number("principal_point_offset_y", -0.5));
    const Ray a = s.sample_ray({250, 50}, {}), b = moved.sample_ray({150, 150}, {});
    EXPECT_LT(glm::length(a.d - b.d), 1e-6f);
}

TEST_F(Sensors, I8_ClipPlanesCutAtTheirDepth) {
    for (const std::string& name : workshop_.registry().names("sensor")) {
        SCOPED_TRACE(name);
        const Sensor& s = make(name, number("near_clip", 2) + number("far_clip", 7));
        for (const Vector2 position : {Vector2(0), Vector2(384, 288), Vector2(700, 10)}) {
            const Ray ray = s.sample_ray(position, {0.1f, 0.7f});
            EXPECT_NEAR(ray.o.z, 2, 1e-5f);
            EXPECT_NEAR((ray.o + ray.tmax * ray.d).z, 7, 1e-4f);
        }
        const std::string body = body_of(name);
        EXPECT_NE(refusal(sensor(name, body + number("near_clip", 0))), "");
        EXPECT_NE(refusal(sensor(name, body + number("near_clip", 5) + number("far_clip", 5))), "");
    }
}

TEST_F(Sensors, I8_ALensOfRadiusZeroIsAPinhole) {
    const Sensor& pinhole = make("perspective");
    const Sensor& lens = workshop_.make<Sensor>(
        sensor("thinlens", number("aperture_radius", 0) + number("focus_distance", 4)));
    for (const Vector2 position : {Vector2(0), Vector2(500, 20), Vector2(768, 576)}) {
        const Ray a = pinhole.sample_ray(position, {}), b = lens.sample_ray(position, {0.9f, 0.1f});
        EXPECT_EQ(a.o, b.o);
        EXPECT_EQ(a.d, b.d);
    }
    EXPECT_NE(refusal(sensor("thinlens")), "");
    EXPECT_NE(refusal(sensor("thinlens", number("aperture_radius", -1))), "");
    EXPECT_NE(
        refusal(sensor("thinlens", number("aperture_radius", 1) + number("focus_distance", 0))),
        "");
}

TEST_F(Sensors, O15_I8_BlurOfAThinLens) {
    // Aperture 0.1, focus 5: the blur has diameter 0.1 |10 − 5| / 5 at depth 10, 0 at depth 5.
    const Sensor& s = workshop_.make<Sensor>(
        sensor("thinlens", number("aperture_radius", 0.05) + number("focus_distance", 5)));
    const Ray center = make("perspective").sample_ray({100, 400}, {});
    const auto at_depth = [](const Ray& ray, float z) {
        return ray.o + ray.d * ((z - ray.o.z) / ray.d.z);
    };
    Rng rng(3);
    float widest = 0;
    RunningStatistics inside;
    for (int i = 0; i < 20000; ++i) {
        const Ray ray = s.sample_ray({100, 400}, rng.next_float2());
        EXPECT_LT(glm::distance(at_depth(ray, 5), at_depth(center, 5)), 1e-5f);
        const float off = glm::distance(at_depth(ray, 10), at_depth(center, 10));
        widest = std::max(widest, off);
        inside.add(off < 0.05f / std::numbers::sqrt2_v<float> ? 1 : 0);
    }
    EXPECT_NEAR(2 * widest, 0.1f, 1e-3f);
    EXPECT_TRUE(mean_matches(inside, 0.5));  // energy is even over the disk
}

TEST_F(Sensors, OrthographicFilmIsTwoWide) {
    const std::string square = film(200, 100);
    const Sensor& s = make("orthographic", square);
    EXPECT_LT(glm::length(s.sample_ray({0, 0}, {}).o - Vector3(1, 0.5f, 0.01f)), 1e-6f);
    EXPECT_LT(glm::length(s.sample_ray({200, 100}, {}).o - Vector3(-1, -0.5f, 0.01f)), 1e-6f);
    EXPECT_EQ(s.sample_ray({7, 8}, {}).d, Vector3(0, 0, 1));
    const Sensor& large = make("orthographic", square + to_world("<scale x='10' y='10'/>"
                                                                 "<translate z='3'/>"));
    EXPECT_LT(glm::length(large.sample_ray({0, 0}, {}).o - Vector3(10, 5, 3.01f)), 1e-5f);
}

TEST_F(Sensors, StretchingTransformsAreRefused) {
    const std::string pose = to_world("<scale x='2'/>");
    EXPECT_NE(refusal(sensor("perspective", pose)).find("stretch"), std::string::npos);
    EXPECT_EQ(refusal(sensor("perspective", to_world("<scale value='2'/>"))), "");
}

TEST_F(Sensors, TellWhatHasNoEffect) {
    make("perspective", number("focus_distance", 3) + number("shutter_open", 0) +
                            "<boolean name='jitter' value='true'/>" + number("cone_scale", 1));
    EXPECT_NE(workshop_.warnings().find("\"focus_distance\" has no effect"), std::string::npos);
    for (const char* name : {"shutter_open", "jitter", "cone_scale"}) {
        EXPECT_NE(workshop_.warnings().find(fmt::format("\"{}\" has no effect", name)),
                  std::string::npos);
    }
}

}  // namespace
}  // namespace lucerna
