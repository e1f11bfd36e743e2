// SPDX-License-Identifier: Apache-2.0
#include "core/math/solid_angle.h"

#include "tests/statistics.h"

namespace lucerna {
namespace {

const Vector3 origin(0);

Vector3 random_vector(Rng& rng) {
    const float x = rng.next_float(), y = rng.next_float(), z = rng.next_float();
    return 2.0f * Vector3(x, y, z) - 1.0f;
}

/// Van Oosterom and Strackee in quadruple precision.
double reference_solid_angle(Vector3 v0, Vector3 v1, Vector3 v2) {
    using Real = __float128;
    struct V {
        Real x, y, z;
    };
    const auto wide = [](Vector3 v) { return V{v.x, v.y, v.z}; };
    const auto dot = [](V a, V b) { return a.x * b.x + a.y * b.y + a.z * b.z; };
    const auto length = [&dot](V a) {
        const Real squared = dot(a, a);
        Real root = std::sqrt(static_cast<double>(squared));
        root = (root + squared / root) / 2;
        return (root + squared / root) / 2;
    };
    const V a = wide(v0), b = wide(v1), c = wide(v2);
    const V n{b.y * c.z - b.z * c.y, b.z * c.x - b.x * c.z, b.x * c.y - b.y * c.x};
    const Real la = length(a), lb = length(b), lc = length(c);
    const Real volume = dot(a, n);
    const Real rest = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    return 2 * std::atan2(std::abs(static_cast<double>(volume)), static_cast<double>(rest));
}

/// χ² of points on a triangle against the solid angles of its k² equal parts.
testing::AssertionResult fills_by_solid_angle(Vector3 v0, Vector3 v1, Vector3 v2) {
    constexpr int k = 12, samples = 300000;
    const SphericalTriangle triangle(origin, v0, v1, v2);
    std::vector<double> observed(2 * k * k), expected(2 * k * k);
    const auto at = [&](int i, int j) {
        const double b0 = i / double{k}, b1 = j / double{k};
        return b0 * Vector3d(v0) + b1 * Vector3d(v1) + (1 - b0 - b1) * Vector3d(v2);
    };
    const Vector3d p(0);
    for (int i = 0; i < k; ++i) {
        for (int j = 0; i + j < k; ++j) {
            const auto cell = static_cast<std::size_t>(2 * (i * k + j));
            const double scale = samples / triangle.solid_angle();
            expected[cell] = triangle_solid_angle(p, at(i, j), at(i + 1, j), at(i, j + 1)) * scale;
            if (i + j + 1 == k) continue;
            expected[cell + 1] =
                triangle_solid_angle(p, at(i + 1, j + 1), at(i + 1, j), at(i, j + 1)) * scale;
        }
    }
    Rng rng(11);
    for (int n = 0; n < samples; ++n) {
        const double x = rng.next_double(), y = rng.next_double();
        const Vector2 b = triangle.sample({x, y}).barycentrics;
        const float i = std::floor(k * b.x), j = std::floor(k * b.y);
        const bool upper = k * b.x - i + (k * b.y - j) > 1 && i + j + 1 < k;
        const auto cell = static_cast<std::size_t>(2 * (i * k + j)) + (upper ? 1 : 0);
        if (cell < observed.size()) ++observed[cell];
    }
    return counts_match(observed, expected);
}

}  // namespace

TEST(SolidAngle, C6_small_spherical_triangle) {
    Rng rng(1);
    for (const float size : {0.1f, 1e-2f, 3e-3f, 1e-3f, 1e-4f, 1e-6f}) {
        double worst = 0;
        for (int i = 0; i < 1000; ++i) {
            const Vector3 v0 = glm::normalize(random_vector(rng)) * 3.0f;
            const Vector3 v1 = v0 + size * random_vector(rng);
            const Vector3 v2 = v0 + size * random_vector(rng);
            const double reference = reference_solid_angle(v0, v1, v2);
            const double error = triangle_solid_angle(Vector3d(0), v0, v1, v2) - reference;
            if (reference > 0) worst = std::max(worst, std::abs(error) / reference);
        }
        EXPECT_LT(worst, 1e-12) << "size " << size;
    }
    const Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), p(0);
    EXPECT_DOUBLE_EQ(triangle_solid_angle(p, x, y, z), std::numbers::pi / 2);
    EXPECT_DOUBLE_EQ(triangle_solid_angle(p, y, x, 1e-12 * z), std::numbers::pi / 2);
}

TEST(SolidAngle, C6_C7_triangle_samples_are_uniform) {
    EXPECT_TRUE(fills_by_solid_angle({1, 0, 0}, {0, 1, 0}, {0, 0, 1}));
    EXPECT_TRUE(fills_by_solid_angle({-1, -1, 0.2f}, {1, -1, 0.2f}, {0, 2, 0.2f}));
    EXPECT_TRUE(fills_by_solid_angle({3, 0, 1}, {3, 1, 0}, {30, 1, 5}));
    EXPECT_TRUE(fills_by_solid_angle({3, 0, 1}, {3.02f, 0, 1}, {3, 0.02f, 1.01f}));
    EXPECT_TRUE(fills_by_solid_angle({3, 0, 1}, {3.00001f, 0, 1}, {3, 0.00001f, 1.00001f}));
    EXPECT_TRUE(fills_by_solid_angle({-9, -9, 0.02f}, {9, -9, 0.02f}, {0, 18, 0.02f}));
}

TEST(SolidAngle, C10_triangle_inverts) {
    Rng rng(2);
    int tested = 0;
    for (int i = 0; i < 3000; ++i) {
        const float size = std::exp2(-6 * rng.next_float());
        const Vector3 v0 = random_vector(rng) * 2.0f;
        const Vector3 v1 = v0 + size * random_vector(rng), v2 = v0 + size * random_vector(rng);
        const SphericalTriangle triangle(origin, v0, v1, v2);
        if (!sample_by_solid_angle(triangle.solid_angle())) continue;
        ++tested;
        const Vector2d u(0.01 + 0.98 * rng.next_double(), 0.01 + 0.98 * rng.next_double());
        const SphericalTriangle::Sample s = triangle.sample(u);
        const Vector2d b(s.barycentrics);
        const Vector3d hit =
            b.x * Vector3d(v0) + b.y * Vector3d(v1) + (1 - b.x - b.y) * Vector3d(v2);
        EXPECT_LT(glm::length(glm::normalize(hit) - Vector3d(s.direction)), 1e-6);
        EXPECT_LT(glm::length(triangle.invert(hit) - u), 1e-3) << triangle.solid_angle();
    }
    EXPECT_GT(tested, 1000);
}

TEST(SolidAngle, C8_degenerate_views_of_a_triangle) {
    const Vector3 a(1, 0, 0), b(2, 1, 0), c(1, 1, 0);
    EXPECT_EQ(SphericalTriangle(origin, a, b, c).solid_angle(), 0) << "in its plane";
    EXPECT_EQ(SphericalTriangle(a, a, b, c).solid_angle(), 0) << "on a vertex";
    EXPECT_EQ(SphericalTriangle(origin, a, a, b).solid_angle(), 0) << "no triangle";
    EXPECT_FALSE(sample_by_solid_angle(SphericalTriangle({1.2f, 0.8f, 0}, a, b, c).solid_angle()));
    const SphericalTriangle above({1.2f, 0.8f, 1e-6f}, a, b, c);
    EXPECT_FALSE(sample_by_solid_angle(above.solid_angle()));
    for (const double x : {0.0, 0x1p-24, 0.5, 1 - 0x1p-24}) {
        for (const double y : {0.0, 0x1p-24, 0.5, 1 - 0x1p-24}) {
            for (const Vector3 p : {Vector3(0, 0, 1), Vector3(1.2f, 0.8f, 0.01f)}) {
                const auto s = SphericalTriangle(p, a, b, c).sample({x, y});
                EXPECT_TRUE(is_finite(s.direction));
                const Vector2 t = s.barycentrics;
                EXPECT_TRUE(t.x >= 0 && t.y >= 0 && t.x + t.y <= 1 + 1e-6f);
            }
        }
    }
}

TEST(SolidAngle, C9_spherical_rectangle) {
    for (const double size : {1e-1, 1e-2, 1e-3, 1e-4}) {
        for (const Vector3d at : {Vector3d(0, 0, 1), Vector3d(3, -2, 1), Vector3d(0.1, 5, 0.01)}) {
            const auto corner = [&](double s, double t) {
                return at + Vector3d(s * size, t * size, 0);
            };
            const SphericalRectangle r(origin, Vector3(at), Vector3(Vector3d(size, 0, 0)),
                                       Vector3(Vector3d(0, size, 0)));
            const double expected =
                triangle_solid_angle(Vector3d(0), at, corner(1, 0), corner(1, 1)) +
                triangle_solid_angle(Vector3d(0), at, corner(1, 1), corner(0, 1));
            EXPECT_NEAR(r.solid_angle() / expected, 1, 2e-5) << "rounding of the float corner";
        }
    }
    const SphericalRectangle face({0, 0, 0}, {-1, -1, 1}, {2, 0, 0}, {0, 2, 0});
    EXPECT_NEAR(face.solid_angle(), 4 * std::numbers::pi / 6, 1e-14);
    EXPECT_EQ(SphericalRectangle(origin, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}).solid_angle(), 0);
}

TEST(SolidAngle, C9_rectangle_samples_are_uniform) {
    constexpr int k = 16, samples = 300000;
    const struct {
        Vector3 corner, x, y;
    } cases[] = {{{-1, -1, 1}, {2, 0, 0}, {0, 2, 0}},
                 {{-1, -1, -0.05f}, {3, 0, 0}, {0, 1.5f, 0}},
                 {{2, 1, 1}, {0, 0, 3}, {0, 5, 0}},
                 {{2, 1, 1}, {0.03f, 0.04f, 0}, {-0.04f, 0.03f, 0}},
                 {{0, 0, 1}, {0.01f, 0, 0}, {0, 0.01f, 0}}};
    for (const auto& [corner, x, y] : cases) {
        const SphericalRectangle r(origin, corner, x, y);
        std::vector<double> observed(k * k), expected(k * k);
        const auto at = [c = Vector3d(corner), ex = Vector3d(x), ey = Vector3d(y)](int i, int j) {
            return c + ex * (i / double{k}) + ey * (j / double{k});
        };
        for (int i = 0; i < k * k; ++i) {
            const int s = i / k, t = i % k;
            const Vector3d p(0), a = at(s, t), b = at(s + 1, t), c = at(s + 1, t + 1);
            const double part =
                triangle_solid_angle(p, a, b, c) + triangle_solid_angle(p, a, c, at(s, t + 1));
            expected[static_cast<std::size_t>(i)] = samples * part / r.solid_angle();
        }
        Rng rng(3);
        for (int i = 0; i < samples; ++i) {
            const double u = rng.next_double(), v = rng.next_double();
            const Vector2 st = r.sample({u, v});
            const int s = std::min(static_cast<int>(st.x * k), k - 1);
            const int t = std::min(static_cast<int>(st.y * k), k - 1);
            ++observed[static_cast<std::size_t>(s * k + t)];
        }
        EXPECT_TRUE(counts_match(observed, expected)) << r.solid_angle() << " sr";
    }
}

TEST(SolidAngle, C10_rectangle_inverts) {
    Rng rng(4);
    int tested = 0;
    for (int i = 0; i < 3000; ++i) {
        const Vector3 corner = 2.0f * random_vector(rng), x = random_vector(rng);
        const Vector3 y = glm::cross(x, random_vector(rng)) * rng.next_float();
        const SphericalRectangle r(origin, corner, x, y);
        if (!sample_by_solid_angle(r.solid_angle())) continue;
        ++tested;
        const Vector2d u(rng.next_double(), rng.next_double());
        EXPECT_LT(glm::length(r.invert(Vector2d(r.sample(u))) - u), 1e-3) << r.solid_angle();
        for (const double e : {0.0, 1 - 0x1p-24}) {
            const Vector2 st = r.sample({e, e});
            EXPECT_TRUE(st.x >= 0 && st.y >= 0 && st.x <= 1 && st.y <= 1);
        }
    }
    EXPECT_GT(tested, 1000);
}

TEST(SolidAngle, C1_C2_C3_sphere_cone) {
    for (const double distance : {1e1, 1e3, 1e4, 1e6}) {
        const auto cone = SphereCone::from(origin, {0, 0, static_cast<float>(distance)}, 1);
        // 2π (1 − √(1 − s²)) by its series.
        const double s2 = 1 / (distance * distance);
        const double series =
            std::numbers::pi * s2 * (1 + s2 / 4 + s2 * s2 / 8 + 5 * s2 * s2 * s2 / 64);
        EXPECT_NEAR(cone->pdf() * series, 1, 8 * 0x1p-24);
    }
    EXPECT_FALSE(SphereCone::from(origin, {0, 0, 0.5f}, 1)) << "inside";
    EXPECT_FALSE(SphereCone::from(origin, {0, 0, 1}, 1)) << "on it";
    EXPECT_FALSE(SphereCone::from(origin, origin, 1)) << "at its center";
    const auto close = SphereCone::from(origin, {0, 0, 1.0001f}, 1);
    EXPECT_NEAR(close->solid_angle(), 2 * std::numbers::pi * (1 - std::sqrt(1 - 1 / sqr(1.0001))),
                1e-4);
}

TEST(SolidAngle, sphere_cone_samples_lie_on_the_near_side) {
    Rng rng(5);
    for (const float distance : {1.001f, 1.5f, 10.0f, 1e3f}) {
        const Vector3 center = distance * glm::normalize(Vector3(1, -2, 3));
        const auto cone = SphereCone::from(origin, center, 1);
        const Vector3d axis = glm::normalize(Vector3d(center));
        RunningStatistics along;
        for (int i = 0; i < 100000; ++i) {
            const double x = rng.next_double(), y = rng.next_double();
            const SphereCone::Sample s = cone->sample({x, y});
            const Vector3d point = Vector3d(center) + Vector3d(s.normal);
            const double off = glm::length(glm::cross(point, Vector3d(s.direction)));
            ASSERT_LT(off, 1e-6 * distance + 1e-6);
            ASSERT_LT(glm::dot(s.normal, s.direction), 1e-6 + 1e-6 * distance);
            // 1 − cos, from the chord.
            const Vector3d chord = Vector3d(s.direction) - axis;
            along.add(0.5 * glm::dot(chord, chord));
        }
        EXPECT_TRUE(equivalent(along, cone->solid_angle() / (4 * std::numbers::pi), 0.01));
    }
}

/// O-6: irradiance of a square light, by solid angle sampling: E = Ω · mean(cos θ).
TEST(SolidAngle, O6_irradiance_of_a_square) {
    constexpr int samples = 200000;
    const Vector3 corner(-0.5f, -0.5f, 1);
    const SphericalRectangle r(origin, corner, {1, 0, 0}, {0, 1, 0});
    const SphericalTriangle lower(origin, corner, {0.5f, -0.5f, 1}, {0.5f, 0.5f, 1});
    const SphericalTriangle upper(origin, corner, {0.5f, 0.5f, 1}, {-0.5f, 0.5f, 1});
    RunningStatistics by_rectangle, by_triangles;
    Rng rng(6);
    for (int i = 0; i < samples; ++i) {
        const double x = rng.next_double(), y = rng.next_double();
        const Vector2 st = r.sample({x, y});
        by_rectangle.add(glm::normalize(corner + Vector3(st, 0)).z * r.solid_angle());
        by_triangles.add(lower.sample({x, y}).direction.z * lower.solid_angle() +
                         upper.sample({x, y}).direction.z * upper.solid_angle());
    }
    EXPECT_TRUE(equivalent(by_rectangle, 0.752274688, 0.005));
    EXPECT_TRUE(equivalent(by_triangles, 0.752274688, 0.005));
}

/// O-7, C4: irradiance of a sphere light above, at and partly below the horizon.
TEST(SolidAngle, C4_O7_irradiance_of_a_sphere) {
    const struct {
        double cos, expected;
    } cases[] = {{0.5, 0.174532925}, {0.2, 0.072810967}, {0, 0.025567229}, {-0.2, 0.002997797}};
    for (const auto& [c, expected] : cases) {
        const Vector3 center(Vector3d(3 * std::sqrt(1 - c * c), 0, 3 * c));
        const auto cone = SphereCone::from(origin, center, 1);
        RunningStatistics irradiance;
        for (std::uint64_t replicate = 0; replicate < 64; ++replicate) {
            double sum = 0;
            for (std::uint64_t i = 0; i < 4096; ++i) {
                const Vector2d u = sobol_owen_2d_bits(i, replicate).to_double();
                sum += std::max(cone->sample(u).direction.z, 0.0f);
            }
            irradiance.add(sum / 4096 * cone->solid_angle());
        }
        EXPECT_TRUE(equivalent(irradiance, expected, 0.005)) << "cos " << c;
    }
}

}  // namespace lucerna
