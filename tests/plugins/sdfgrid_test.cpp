// SPDX-License-Identifier: Apache-2.0
/// Distances on a grid: where rays meet their zero set, against closed forms.
#include "core/math/rounding.h"
#include "core/math/sequences.h"
#include "core/math/warp.h"
#include "plugins/commands/contracts/statistics.h"
#include "tests/paths.h"
#include "tests/plugins/world.h"
#include "tests/vol_writer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace lucerna {
namespace {

using Function = std::function<double(Vector3d)>;

/// At the nodes of a grid that fills the unit cube.
std::vector<float> at_nodes(std::array<std::int32_t, 3> n, const Function& f) {
    std::vector<float> numbers;
    for (int z = 0; z < n[2]; ++z) {
        for (int y = 0; y < n[1]; ++y) {
            for (int x = 0; x < n[0]; ++x) {
                const Vector3d nodes(n[0] - 1, n[1] - 1, n[2] - 1);
                numbers.push_back(static_cast<float>(f(Vector3d(x, y, z) / nodes)));
            }
        }
    }
    return numbers;
}

class SDFGrids : public testing::Test {
protected:
    std::string shape(std::array<std::int32_t, 3> n, const Function& f,
                      const std::string& body = "") {
        return shape(VolHeader{.resolution = n}, at_nodes(n, f), body);
    }
    std::string shape(const VolHeader& header, const std::vector<float>& numbers,
                      const std::string& body = "") {
        const std::filesystem::path path = folder_ / "a.vol";
        write_bytes(path, vol_bytes(header, numbers));
        return fmt::format("<shape type='sdfgrid'><string name='filename' value='{}'/>{}</shape>",
                           path.string(), body);
    }
    std::string message(const VolHeader& header, const std::vector<float>& numbers) {
        return refusal(shape(header, numbers));
    }

private:
    TemporaryFolder folder_;
};

double ball(Vector3d p) { return glm::length(p - 0.5) - 0.4; }

const std::string turned =
    "<transform name='to_world'><rotate x='1' y='2' z='-0.5' angle='40'/>"
    "<scale x='1.5' y='-1' z='2'/><translate x='0.3' y='-0.7' z='2'/></transform>";

/// A ray from outside of the unit cube to a point in it.
Ray ray_to_cube(Rng& rng) {
    const Vector3 target(rng.next_float(), rng.next_float(), rng.next_float());
    const Vector3 o = Vector3(0.5f) + 3.0f * square_to_uniform_sphere(rng.next_float2());
    return {.o = o, .d = glm::normalize(target - o)};
}

/// xyz is trilinear itself, so that its level sets are met exactly: by the first root of a cubic.
TEST_F(SDFGrids, A25_cubics_are_met_at_their_first_root) {
    const Function f = [](Vector3d p) {
        return (p.x - 0.5) * (p.y - 0.25) * (p.z - 0.75) + 0.015625;
    };
    const World world(shape({5, 9, 17}, f));
    Rng rng(1);
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {
        const Ray ray = ray_to_cube(rng);
        const Vector3d o(ray.o), d(ray.d);
        double t0 = 0, t1 = 10;
        for (int k = 0; k < 3; ++k) {
            t0 = std::max(t0, std::min(-o[k] / d[k], (1 - o[k]) / d[k]));
            t1 = std::min(t1, std::max(-o[k] / d[k], (1 - o[k]) / d[k]));
        }
        constexpr int steps = 4000;
        std::optional<double> expected;
        double nearest_zero = 1;  // of |f|: roots that a step may hide
        for (int s = 0; s < steps && !expected; ++s) {
            double a = t0 + (t1 - t0) * s / steps, b = t0 + (t1 - t0) * (s + 1) / steps;
            nearest_zero = std::min(nearest_zero, std::abs(f(o + a * d)));
            if ((f(o + a * d) > 0) == (f(o + b * d) > 0)) continue;
            for (int k = 0; k < 60; ++k) {
                const double m = 0.5 * (a + b);
                (f(o + a * d) > 0) == (f(o + m * d) > 0) ? a = m : b = m;
            }
            expected = a;
        }
        const auto hit = world.scene().intersect(ray);
        if (!expected && nearest_zero < 1e-5) continue;
        ASSERT_EQ(hit.has_value(), expected.has_value()) << i;
        if (!hit) continue;
        ++hits;
        const Vector3d p = Vector3d(hit->p) - Vector3d(0.5, 0.25, 0.75);
        const Vector3d gradient(p.y * p.z, p.x * p.z, p.x * p.y);
        constexpr double rounding = 0x1p-26;  // of the numbers of the grid, which are below 1/2
        EXPECT_NEAR(hit->t, *expected,
                    0x1p-23 * *expected + rounding / std::abs(glm::dot(gradient, d)))
            << i;
        EXPECT_GT(glm::dot(Vector3d(hit->n), glm::normalize(gradient)), 1 - 1e-6) << i;
        EXPECT_LE(std::abs(f(Vector3d(hit->p))),
                  2 * glm::length(gradient) * static_cast<double>(hit->error) + rounding)
            << i;
    }
    EXPECT_GT(hits, 500);
}

/// Half the distance of nodes leaves a quarter of the error of trilinear interpolation.
TEST_F(SDFGrids, approach_the_sphere_whose_distances_they_hold) {
    const auto error = [&](int n, const char* normals) {
        const World world(
            shape({n, n, n}, ball, fmt::format("<string name='normals' value='{}'/>", normals)));
        RunningStatistics position, normal;
        Rng rng(2);
        for (int i = 0; i < 4000; ++i) {
            const auto hit = world.scene().intersect(ray_to_cube(rng));
            if (!hit) continue;
            const Vector3d out = Vector3d(hit->p) - 0.5;
            position.add(std::abs(glm::length(out) - 0.4));
            normal.add(glm::length(Vector3d(hit->shading.n) - glm::normalize(out)));
        }
        return std::pair(position.mean(), normal.mean());
    };
    const auto [position, analytic] = error(17, "analytic");
    const auto [fine_position, fine_analytic] = error(33, "analytic");
    EXPECT_NEAR(position / fine_position, 4, 0.4);
    EXPECT_NEAR(analytic / fine_analytic, 2, 0.2);
    // Smooth normals err by the square, too.
    const auto [same, smooth] = error(17, "smooth");
    const auto [fine_same, fine_smooth] = error(33, "smooth");
    EXPECT_EQ(same, position);
    EXPECT_LT(smooth, 0.25 * analytic);
    EXPECT_NEAR(smooth / fine_smooth, 4, 0.6);
}

/// Lines go through a closed surface as often outwards as inwards, also along edges of voxels.
TEST_F(SDFGrids, A6_A7_A21_closed_surfaces_do_not_leak) {
    for (const std::string& body : {std::string(), turned}) {
        const World world(shape({9, 9, 9}, ball, body));
        const Transform from_cube = body.empty() ? Transform()
                                                 : Transform::translate({0.3, -0.7, 2}) *
                                                       Transform::scale({1.5, -1, 2}) *
                                                       Transform::rotate({1, 2, -0.5}, 40);
        Rng rng(3);
        for (int i = 0; i < 5000; ++i) {
            // Targets and, for a part, origins are nodes of the grid.
            const auto node = [&] {
                return Vector3d(rng.next_uint() % 9, rng.next_uint() % 9, rng.next_uint() % 9) /
                       8.0;
            };
            const Vector3d inside = 0.5 + 0.5 * (node() - 0.5);
            const Vector3 o(from_cube.point(inside));
            const Vector3 d = i % 2 == 0 ? square_to_uniform_sphere(rng.next_float2())
                                         : Vector3(from_cube.direction(node() - inside));
            if (glm::length(d) == 0 || ball(inside) > -0.01) continue;
            const auto out = world.scene().intersect({.o = o, .d = glm::normalize(d)});
            ASSERT_TRUE(out) << i;
            EXPECT_GT(glm::dot(out->n, d), 0) << i;
            EXPECT_FALSE(world.scene().intersect(out->spawn_ray(glm::normalize(d)))) << i;
        }
    }
}

TEST_F(SDFGrids, B8_B11_points_are_on_the_surface_within_their_error) {
    for (const double scale : {1e-4, 1.0, 1e4}) {
        const std::string placed = fmt::format(
            "<transform name='to_world'><translate x='7'/><scale value='{}'/></transform>", scale);
        const World world(shape({33, 33, 33}, ball, placed));
        Rng rng(4);
        int hits = 0, lost = 0;
        for (int i = 0; i < 4000; ++i) {
            const Ray near = ray_to_cube(rng);
            const float far = std::exp2(20 * rng.next_float());
            const Vector3 target = near.o + 3.0f * near.d;
            const auto s = static_cast<float>(scale);
            const auto hit = world.scene().intersect(
                {.o = s * (target - far * near.d + Vector3(7, 0, 0)), .d = near.d});
            if (!hit) continue;
            ++hits;
            for (const float side : {1.0f, -1.0f}) {
                const auto next = world.scene().intersect(hit->spawn_ray(side * hit->n));
                EXPECT_TRUE(!next || next->t >= 16 * hit->error) << scale << " " << i;
            }
            const Vector3 start = offset_ray_origin(hit->p, hit->error, hit->n, hit->n);
            const auto through = world.scene().intersect({.o = start, .d = -hit->n});
            if (!through || through->t > 8 * hit->error) ++lost;
        }
        EXPECT_GT(hits, 1000);
        EXPECT_LE(lost, hits / 200) << scale;  // beside an edge
    }
}

TEST_F(SDFGrids, I2_normals_point_to_growing_distances) {
    for (const auto& [body, side] :
         {std::pair(std::string(), 1.0f), std::pair(turned, 1.0f),
          std::pair(std::string("<boolean name='flip_normals' value='true'/>"), -1.0f)}) {
        const World world(shape({9, 9, 9}, ball, body));
        const Vector3 center = world.shape().bounds().center();
        Rng rng(5);
        for (int i = 0; i < 100; ++i) {
            const Vector3 d = square_to_uniform_sphere(rng.next_float2());
            const auto hit = world.scene().intersect({.o = center - 10.0f * d, .d = d});
            ASSERT_TRUE(hit);
            EXPECT_LT(side * glm::dot(hit->n, d), 0);
            EXPECT_GT(glm::dot(hit->n, hit->shading.n), 0);
        }
    }
}

TEST_F(SDFGrids, L21_what_is_wrong_is_named) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(message({.resolution = {2, 2, 2}}, {-1, 1, 1, 1, 1, 1, 1, 1}), "");
    EXPECT_EQ(message({.resolution = {2, 2, 2}}, {2, 1, 1, 1, 1, 1, 1, 1}),
              "a.vol: there is no surface: its numbers all have the same sign");
    EXPECT_EQ(message({.resolution = {2, 2, 2}}, {2, 1, nan, 1, 1, -1, 1, 1}),
              "a.vol: the distance at (0, 1, 0) is not finite: nan");
    EXPECT_EQ(message({.resolution = {1, 2, 2}}, {2, 1, -1, 1}),
              "a.vol: 1 × 2 × 2 numbers have no surface between them: there must be 2 or more "
              "along each axis");
    EXPECT_EQ(message({.resolution = {2, 1, 1}, .channels = 3}, {1, 1, 1, 1, 1, 1}),
              "a.vol: it has 3 channels; distances are one");
    EXPECT_EQ(refusal(shape({3, 3, 3}, ball, "<emitter type='area'/>")),
              "an sdfgrid cannot emit light: its area is not known; use a mesh");
}

}  // namespace
}  // namespace lucerna
