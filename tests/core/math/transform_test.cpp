// SPDX-License-Identifier: Apache-2.0
#include "core/math/transform.h"

#include "core/math/sequences.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace lucerna {
namespace {

Vector3d random_vector(Rng& rng) {
    const double x = rng.next_double(), y = rng.next_double(), z = rng.next_double();
    return Vector3d(x, y, z) * 2.0 - 1.0;
}

}  // namespace

TEST(Transform, I1_singular_matrices_are_refused) {
    EXPECT_THROW(Transform::scale({1, 0, 1}), std::invalid_argument);
    EXPECT_THROW(Transform(Matrix4d(0.0)), std::invalid_argument);
    EXPECT_THROW(Transform(Matrix4d(std::nan(""))), std::invalid_argument);
    Matrix4d flat(1.0);
    flat[1] = flat[0];
    EXPECT_THROW(Transform{flat}, std::invalid_argument);
    // Rank two only after rounding: the determinant is not exactly zero.
    const Matrix3d turned(Transform::rotate({1, 2, 3}, 40).matrix());
    const Matrix3d squashed = turned * Matrix3d(1, 0, 0, 0, 1, 0, 0, 0, 0) * glm::transpose(turned);
    EXPECT_THROW(Transform(Matrix4d(squashed)), std::invalid_argument);
    EXPECT_THROW(Transform::rotate({0, 0, 0}, 10), std::invalid_argument);
}

TEST(Transform, I2_mirroring_is_noticed) {
    EXPECT_TRUE(Transform::scale({-1, 2, 3}).swaps_handedness());
    EXPECT_FALSE(Transform::scale({-1, -2, 3}).swaps_handedness());
    EXPECT_FALSE(Transform::rotate({1, 1, 0}, 77).swaps_handedness());
    EXPECT_TRUE(
        Transform(Matrix4d(-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)).swaps_handedness());
}

TEST(Transform, I3_normals_stay_perpendicular) {
    Rng rng(1);
    for (int i = 0; i < 1000; ++i) {
        const Transform t = Transform::rotate(random_vector(rng), 360 * rng.next_double()) *
                            Transform::scale({1e-3, 1, 1e3}) *
                            Transform::translate(random_vector(rng));
        const Vector3d a = random_vector(rng), n = glm::cross(a, random_vector(rng));
        const Vector3d moved = glm::normalize(t.direction(a));
        EXPECT_NEAR(glm::dot(moved, glm::normalize(t.normal(n))), 0, 1e-9);
    }
}

TEST(Transform, I4_extreme_scales_and_chains) {
    for (const double scale : {1e-30, 1e-6, 1.0, 1e8, 1e30}) {
        for (const double shift : {0.0, 1.0, 1e12}) {
            const Transform t = Transform::translate({shift, -shift, shift}) *
                                Transform::rotate({1, 2, 3}, 33) * Transform::scale({scale, 1, 1});
            const Transform again(t.matrix());
            for (int c = 0; c < 4; ++c) {
                for (int r = 0; r < 4; ++r) {
                    const double expected = t.inverse_matrix()[c][r];
                    EXPECT_NEAR(again.inverse_matrix()[c][r], expected,
                                1e-12 * std::abs(expected) + 1e-14 * (1 + shift) / scale);
                }
            }
        }
    }
    Transform chain;
    const Transform step = Transform::rotate({0, 0, 1}, 1) * Transform::translate({1, 0, 0}) *
                           Transform::scale({1.01, 1.01, 1.01});
    for (int i = 0; i < 40; ++i) chain = chain * step;
    for (int i = 0; i < 40; ++i) chain = chain * step.inverse();
    const Vector3d p(1, 2, 3);
    EXPECT_LT(glm::length(chain.point(p) - p), 1e-12);
    EXPECT_LT(glm::length((chain * chain.inverse()).point(p) - p), 1e-12);
}

TEST(Transform, I5_look_at) {
    const Transform t = Transform::look_at({1, 2, 3}, {1, 2, 7}, {0, 1, 0});
    EXPECT_EQ(t.point(Vector3d(0)), Vector3d(1, 2, 3));
    EXPECT_EQ(t.direction(Vector3d(0, 0, 1)), Vector3d(0, 0, 1));
    EXPECT_EQ(t.direction(Vector3d(0, 1, 0)), Vector3d(0, 1, 0));
    EXPECT_EQ(t.direction(Vector3d(1, 0, 0)), Vector3d(1, 0, 0)) << "x points to the left";
    EXPECT_THROW(Transform::look_at({1, 2, 3}, {1, 2, 3}, {0, 1, 0}), std::invalid_argument);
    EXPECT_THROW(Transform::look_at({HUGE_VAL, 2, 3}, {1, 2, 3}, {0, 1, 0}), std::invalid_argument);
    for (const Vector3d up : {Vector3d(0, 5, 0), Vector3d(0, -1e-9, 0), Vector3d(0)}) {
        const Transform down = Transform::look_at({0, 3, 0}, {0, 0, 0}, up);
        EXPECT_FALSE(down.swaps_handedness());
        EXPECT_EQ(down.direction(Vector3d(0, 0, 1)), Vector3d(0, -1, 0));
        EXPECT_LT(glm::length(down.inverse().point(Vector3d(0, 3, 0))), 1e-15);
    }
}

TEST(Transform, quarter_turns_are_exact) {
    const Vector3d x(1, 0, 0);
    EXPECT_EQ(Transform::rotate({0, 0, 2}, 90).direction(x), Vector3d(0, 1, 0));
    EXPECT_EQ(Transform::rotate({0, 0, 1}, 180).direction(x), Vector3d(-1, 0, 0));
    EXPECT_EQ(Transform::rotate({0, 0, 1}, -90).direction(x), Vector3d(0, -1, 0));
    EXPECT_EQ(Transform::rotate({0, 0, 1}, 630).direction(x), Vector3d(0, -1, 0));
    const Vector3d turned = Transform::rotate({0, 1, 0}, 30).direction(x);
    EXPECT_LT(glm::length(turned - Vector3d(std::sqrt(0.75), 0, -0.5)), 1e-15);
    EXPECT_TRUE(Transform::rotate({0, 1, 0}, 360).is_identity());
}

TEST(Transform, perspective_divides) {
    // x/z, y/z, and a depth: w is the old z.
    const Transform project(Matrix4d(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 1, 0, 0, -1, 0));
    EXPECT_EQ(project.point(Vector3d(4, 6, 2)), Vector3d(2, 3, 1.5));
    EXPECT_LT(glm::length(project.inverse().point(Vector3d(2, 3, 1.5)) - Vector3d(4, 6, 2)), 1e-12);
}

TEST(Transform, bounds_hold_every_point) {
    Rng rng(7);
    const Bounds3 box{Vector3(-1, 0, 2), Vector3(1, 0, 3)};
    const Transform t = Transform::translate({0.1, 1e3, 0}) * Transform::rotate({3, 2, 1}, 50);
    const Bounds3 moved = t.bounds(box);
    for (int i = 0; i < 10000; ++i) {
        const double x = rng.next_double(), z = rng.next_double();
        EXPECT_TRUE(moved.contains(t.point(Vector3(Vector3d(2 * x - 1, 0, 2 + z)))));
    }
    EXPECT_TRUE(t.bounds(Bounds3()).empty());
}

}  // namespace lucerna
