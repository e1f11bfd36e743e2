// SPDX-License-Identifier: Apache-2.0
/// Curves: straight ones are cylinders, bent ones are where their formula says.
#include "core/math/warp.h"
#include "core/scene/scene.h"
#include "tests/paths.h"
#include "tests/plugins/world.h"
#include "tests/statistics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace lucerna {
namespace {

class Curves : public testing::Test {
protected:
    std::string curve(const std::string& type, const std::string& points,
                      const std::string& body = "") {
        const std::filesystem::path path = folder_ / fmt::format("{}.txt", ++files_);
        std::ofstream(path) << points;
        return fmt::format("<shape type='{}'><string name='filename' value='{}'/>{}</shape>", type,
                           path.string(), body);
    }

    TemporaryFolder folder_;
    int files_ = 0;
};

const std::string straight = "0 0 0 0.1\n1 0 0 0.1\n2 0 0 0.1\n3 0 0 0.1\n4 0 0 0.1\n";
const std::string bent =
    "0 0 0 0.1\n1 0.2 0 0.1\n2 0 0.5 0.2\n3 1 0.2 0.15\n4 2 0 0.1\n5 2 1 0.05\n"
    "\n\n0 0 2 0.02\n1 0 2 0.03\n2 1 2 0.02\n3 0 2 0.04\n";

Ray towards(Vector3 from, Vector3 target) {
    return {.o = from, .d = glm::normalize(target - from)};
}

TEST_F(Curves, straight_ones_are_cylinders) {
    for (const std::string type : {"linearcurve", "bsplinecurve"}) {
        const World world(curve(type, straight));
        const bool linear = type == "linearcurve";
        EXPECT_EQ(world.shape().primitive_count(), linear ? 4u : 2u);
        Rng rng(1);
        for (int i = 0; i < 1000; ++i) {
            const float angle = 2 * pi * rng.next_float(), x = 1.01f + 1.98f * rng.next_float();
            const Vector3 n(0, std::cos(angle), std::sin(angle));
            const auto at = world.scene().intersect(towards(Vector3(x, 0, 0) + n, {x, 0, 0}));
            ASSERT_TRUE(at);
            EXPECT_NEAR(at->t, 0.9f, 2e-5f);
            EXPECT_LT(glm::distance(at->p, Vector3(x, 0, 0) + 0.1f * n), 2e-5f);
            EXPECT_GT(glm::dot(at->n, n), 0.99999f);
            EXPECT_NEAR(at->uv.x, angle / (2 * pi), 1e-4f);
            EXPECT_NEAR(at->uv.y, 1 - (linear ? x / 4 : (x - 1) / 2), 1e-4f);
            EXPECT_LT(glm::distance(at->dpdu, 0.2f * pi * glm::cross(Vector3(1, 0, 0), n)), 1e-4f);
            EXPECT_LT(glm::distance(at->dpdv, Vector3(linear ? -4 : -2, 0, 0)), 1e-3f);
            EXPECT_GT(at->shading.t.x, 0.9999f);  // along the curve
        }
        // From inside, nothing is met.
        EXPECT_FALSE(world.scene().intersect({.o = {2, 0, 0}, .d = {0, 0, 1}}));
    }
}

/// As in Mitsuba 3.9.1: control points are transformed, and radii stay, so that curves stay round.
TEST_F(Curves, A20_to_world_leaves_radii_as_they_are) {
    for (const char* type : {"linearcurve", "bsplinecurve"}) {
        for (const char* steps : {"<scale value='3'/>", "<scale x='3' y='1' z='0.5'/>"}) {
            const World world(curve(
                type, straight, fmt::format("<transform name='to_world'>{}</transform>", steps)));
            for (const Vector3 n : {Vector3(0, 1, 0), Vector3(0, 0, -1), Vector3(0, 0.6f, 0.8f)}) {
                const auto at = world.scene().intersect(towards(Vector3(6, 0, 0) + n, {6, 0, 0}));
                ASSERT_TRUE(at) << type << steps;
                EXPECT_NEAR(at->t, 0.9f, 2e-5f) << type << steps;
                EXPECT_GT(glm::dot(at->n, n), 0.99999f);
            }
        }
    }
}

/// The same control points with other radii.
std::string with_radii_times(double scale, const std::string& points) {
    std::istringstream lines(points);
    std::string result;
    for (std::string line; std::getline(lines, line);) {
        const std::size_t radius = line.rfind(' ');
        if (radius != std::string::npos) {
            line = fmt::format("{} {}", line.substr(0, radius),
                               scale * std::stod(line.substr(radius)));
        }
        result += line + "\n";
    }
    return result;
}

TEST_F(Curves, hits_lie_on_their_rays_and_rays_leave_them) {
    for (const char* type : {"linearcurve", "bsplinecurve"}) {
        // Smaller linear curves are met beside their joints: Embree's tolerance is absolute there.
        for (const double scale : {1e-2, 1.0, 1e3}) {
            const World world(curve(type, with_radii_times(scale, bent),
                                    fmt::format("<transform name='to_world'><rotate x='1' y='2' "
                                                "angle='40'/><scale value='{}'/>"
                                                "<translate x='{}'/></transform>",
                                                scale, 3 * scale)));
            const Bounds3 box = world.shape().bounds();
            const float size = max_component(box.extent());
            Rng rng(2);
            int hits = 0, again = 0, beside = 0;
            for (int i = 0; i < 100000; ++i) {
                const Vector3 u(rng.next_float(), rng.next_float(), rng.next_float());
                const Vector3 from =
                    box.center() + 2 * size * square_to_uniform_sphere(rng.next_float2());
                const Ray ray = towards(from, box.min + u * box.extent());
                const auto at = world.scene().intersect(ray);
                if (!at) continue;
                ++hits;
                EXPECT_TRUE((Bounds3{box.min - Vector3(at->error), box.max + Vector3(at->error)})
                                .contains(at->p));
                EXPECT_LT(glm::dot(ray.d, at->n), 0.05f);
                const Vector3 off = at->p - ray.o - at->t * ray.d;
                beside += glm::length(off) > 2 * at->error + 1e-6f * size;
                EXPECT_NEAR(glm::length(at->n), 1, 1e-5f);
                const Vector3 w = Frame::from_normal(at->n).to_world(
                    square_to_cosine_hemisphere(rng.next_float2()));
                const auto next = world.scene().intersect(at->spawn_ray(w));
                if (next && next->t < 16 * at->error) ++again;
            }
            EXPECT_GT(hits, 1000) << type << scale;
            EXPECT_LE(again, hits / 500) << type << scale;
            EXPECT_LE(beside, hits / 1000) << type << scale;  // at grazing angles
        }
    }
}

TEST_F(Curves, derivatives_follow_the_parameters) {
    const World world(curve("bsplinecurve", bent));
    const Bounds3 box = world.shape().bounds();
    Rng rng(3);
    int compared = 0;
    for (int i = 0; i < 100000 && compared < 500; ++i) {
        const Vector3 u(rng.next_float(), rng.next_float(), rng.next_float());
        const Vector3 d = square_to_uniform_sphere(rng.next_float2());
        const Vector3 target = box.min + u * box.extent();
        const auto a = world.scene().intersect({.o = target - 5.0f * d, .d = d});
        if (!a || glm::dot(a->n, d) > -0.7f) continue;
        const Vector3 step = 2e-3f * a->shading.to_world({0.8f, 0.6f, 0});
        const auto b = world.scene().intersect({.o = target - 5.0f * d + step, .d = d});
        if (!b || b->primitive != a->primitive) continue;
        const Vector2 duv = b->uv - a->uv;
        if (std::abs(duv.x) > 0.1f) continue;  // the seam
        const Vector3 expected = duv.x * a->dpdu + duv.y * a->dpdv;
        EXPECT_LT(glm::length(expected - (b->p - a->p)), 0.15f * glm::length(b->p - a->p));
        ++compared;
    }
    EXPECT_EQ(compared, 500);
}

/// Where rays of Mitsuba 3.9.1 (llvm_ad_rgb) meet the same curves.
TEST_F(Curves, are_those_of_mitsuba) {
    const std::string points =
        "0 0 0 0.1\n1 0 0 0.1\n2 0 0 0.2\n3 1 0 0.1\n4 2 0 0.1\n\n0 0 2 .1\n1 0 2 .1\n2 0 2 "
        ".1\n3 0 2 .1\n";
    struct Expected {
        const char* type;
        Vector3 from;
        float t;
        Vector3 n;
        Vector2 uv;  ///< v downwards
    };
    const Expected all[] = {
        {"bsplinecurve",
         {2.5f, 0.5f, 5},
         4.8523f,
         {0.1044f, -0.0491f, 0.9933f},
         {0.2668f, 0.4966f}},
        {"bsplinecurve", {1.7f, 0, 1}, 0.8517f, {0.0368f, -0.3515f, 0.9355f}, {0.3071f, 0.2291f}},
        {"linearcurve", {2.5f, 0.5f, 5}, 4.8496f, {0.05f, 0.05f, 0.9975f}, {0.25f, 0.3561f}},
        {"linearcurve", {1.7f, 0, 1}, 0.8291f, {-0.1f, 0, 0.995f}, {0.25f, 0.2453f}},
    };
    for (const Expected& e : all) {
        const World world(curve(e.type, points));
        const auto at = world.scene().intersect({.o = e.from, .d = {0, 0, -1}});
        ASSERT_TRUE(at);
        EXPECT_NEAR(at->t, e.t, 1e-4f) << e.type;
        EXPECT_LT(glm::distance(at->n, e.n), 2e-3f) << e.type << at->n.x << ' ' << at->n.y;
        EXPECT_NEAR(at->uv.x, e.uv.x, 1e-3f) << e.type;
        EXPECT_NEAR(1 - at->uv.y, e.uv.y, 1e-3f) << e.type;
    }
}

TEST_F(Curves, can_be_instances) {
    const World direct(curve("bsplinecurve", bent));
    const World merged("<shape type='merge'>" + curve("bsplinecurve", bent) + "</shape>");
    Rng rng(4);
    for (int i = 0; i < 1000; ++i) {
        const Vector3 from = 10.0f * square_to_uniform_sphere(rng.next_float2());
        const Ray ray = towards(from, {2.5f, 0.7f, 0.4f});
        const auto a = direct.scene().intersect(ray), b = merged.scene().intersect(ray);
        ASSERT_EQ(a.has_value(), b.has_value());
        if (!a) continue;
        EXPECT_LT(glm::distance(a->p, b->p), 1e-4f);
        EXPECT_LT(glm::distance(a->shading.t, b->shading.t), 1e-3f);
    }
}

}  // namespace
}  // namespace lucerna
