// SPDX-License-Identifier: Apache-2.0
#include "core/math/microfacet.h"

#include "core/math/rounding.h"
#include "core/math/warp.h"
#include "tests/statistics.h"

namespace lucerna {
namespace {

using Type = Microfacet::Type;

const Microfacet distributions[] = {
    {Type::ggx, 1, 1},         {Type::ggx, 0.3f, 0.3f},       {Type::ggx, 0.05f, 0.4f},
    {Type::beckmann, 1, 1},    {Type::beckmann, 0.3f, 0.3f},  {Type::beckmann, 0.05f, 0.4f},
    {Type::ggx, 0.02f, 0.02f}, {Type::beckmann, 0.02f, 0.02f}};

Vector3 from_angles(double theta, double phi) {
    return Vector3(Vector3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                            std::cos(theta)));
}

/// A direction at cos θ = c, also where c is tiny.
Vector3 at_height(float c, float phi) {
    const float s = safe_sqrt(1 - c * c);
    return {s * std::cos(phi), s * std::sin(phi), c};
}

std::string name_of(const Microfacet& d) {
    return (d.type == Type::ggx ? "ggx " : "beckmann ") + std::to_string(d.alpha_x) + " " +
           std::to_string(d.alpha_y);
}

}  // namespace

TEST(Microfacet, projected_area_is_one) {
    for (const Microfacet& d : distributions) {
        const auto area = [&d](Vector3 m) { return static_cast<double>(d.D(m)) * m.z; };
        EXPECT_NEAR(integrate_sphere(area), 1, 2e-5) << name_of(d);
    }
}

TEST(Microfacet, D1_alpha_to_zero) {
    for (const float alpha : {1e-4f, 1e-3f, 1e-2f, 0.5f}) {
        for (const double t : {0.0, 0.1, 1.0, 3.0}) {
            const double tan = t * alpha, cos = 1 / std::sqrt(1 + tan * tan);
            const Vector3 m(Vector3d(tan * cos * 0.6, tan * cos * 0.8, cos));
            const double e = tan * tan / sqr(static_cast<double>(alpha));
            const double peak =
                1 / (std::numbers::pi * sqr(static_cast<double>(alpha)) * sqr(sqr(cos)));
            EXPECT_NEAR(Microfacet(Type::ggx, alpha, alpha).D(m) / (peak / sqr(1 + e)), 1, 2e-6);
            EXPECT_NEAR(Microfacet(Type::beckmann, alpha, alpha).D(m) / (peak * std::exp(-e)), 1,
                        5e-6);
        }
        // Visible slopes of a nearly smooth surface are those of its facets: tan θ < α with
        // probability 1/2 (Trowbridge-Reitz) or 1 − 1/e (Beckmann).
        for (const Type type : {Type::ggx, Type::beckmann}) {
            if (alpha > 0.1f) continue;
            const Microfacet d(type, alpha, alpha);
            const Vector3 w = from_angles(0.7, 0.3);
            RunningStatistics below;
            Rng rng(1);
            for (int i = 0; i < 100000; ++i) {
                const Vector3 m = d.sample_visible_normal(w, rng.next_float2());
                below.add(sin2_theta(m) < sqr(alpha) * cos2_theta(m) ? 1 : 0);
            }
            EXPECT_TRUE(equivalent(below, type == Type::ggx ? 0.5 : 1 - std::exp(-1.0), 0.02));
        }
    }
    EXPECT_TRUE(Microfacet(Type::ggx, 0, 9e-4f).effectively_smooth());
    EXPECT_FALSE(Microfacet(Type::ggx, 1e-4f, 0.1f).effectively_smooth());
}

/// The pdf of visible normals, and of reflections off them, integrates to one: Heitz's weak white
/// furnace test.
TEST(Microfacet, D2_D16_weak_white_furnace) {
    for (const Microfacet& d : distributions) {
        for (const double degrees : {0.0, 30.0, 60.0, 80.0, 89.0}) {
            const Vector3 wo = from_angles(degrees * std::numbers::pi / 180, 0.4);
            const auto normals = [&](Vector3 m) { return d.visible_normal_pdf(wo, m); };
            EXPECT_NEAR(integrate_sphere(normals, 1e-5), 1, 1e-3) << name_of(d) << " " << degrees;
        }
    }
    for (const Type type : {Type::ggx, Type::beckmann}) {
        const Microfacet d(type, 0.5f, 0.5f);
        const Vector3 wo = from_angles(1, 0.4);
        const auto furnace = [&](Vector3 wi) {
            const Vector3 h = wo + wi;
            if (!(h.z > 0)) return 0.0;
            const Vector3 m = glm::normalize(h);
            return static_cast<double>(d.D(m) * d.G1(wo)) / (4 * wo.z);
        };
        EXPECT_NEAR(integrate_sphere(furnace, 1e-5), 1, 2e-3);
    }
}

TEST(Microfacet, D11_D18_sampling_follows_the_pdf) {
    constexpr double tests = 42;
    std::uint64_t seed = 1;
    std::vector<Microfacet> all(std::begin(distributions), std::end(distributions));
    // One to a thousand: normals on a thread, too thin for the grid but not for the integral.
    all.emplace_back(Type::ggx, 1.0f, 1e-2f);
    all.emplace_back(Type::beckmann, 1.0f, 1e-2f);
    for (const Microfacet& d : all) {
        for (const Vector3 w : {Vector3(0, 0, 1), from_angles(0.8, 0.5), from_angles(1.5, 4),
                                from_angles(std::numbers::pi - 1.2, 2)}) {
            const auto sample = [&](Vector2 u) {
                return std::optional(d.sample_visible_normal(w, u));
            };
            const auto pdf = [&](Vector3 m) { return d.visible_normal_pdf(w, m); };
            SphereTest test;
            test.grid.seed = seed++;
            test.grid.samples = 200000;
            test.tests = tests;
            EXPECT_TRUE(sampling_matches_pdf(sample, pdf, test)) << name_of(d) << " w.z " << w.z;
        }
    }
}

/// Anisotropy 1 : 1000 in slopes, where the distribution is that of the isotropic one.
TEST(Microfacet, D18_extreme_anisotropy) {
    for (const Type type : {Type::ggx, Type::beckmann}) {
        const Microfacet thin(type, 1, 1e-3f), round(type, 1, 1);
        const Vector3 w = from_angles(1, 0);
        Rng rng(9);
        for (int i = 0; i < 10000; ++i) {
            const Vector2 u = rng.next_float2();
            const Vector3 a = thin.sample_visible_normal(w, u),
                          b = round.sample_visible_normal(w, u);
            ASSERT_NEAR(a.x / a.z, b.x / b.z, 1e-4f * (1 + std::abs(b.x / b.z)));
            ASSERT_NEAR(1e3f * a.y / a.z, b.y / b.z, 1e-4f * (1 + std::abs(b.y / b.z)));
            // D = P(slopes) / cos⁴, and slopes along y are a thousandth as wide.
            ASSERT_NEAR(thin.D(a) * sqr(sqr(a.z)) / (1e3f * round.D(b) * sqr(sqr(b.z))), 1, 1e-3);
        }
    }
}

TEST(Microfacet, D2_weights_never_exceed_one) {
    Rng rng(3);
    for (const Microfacet& d : distributions) {
        for (int i = 0; i < 20000; ++i) {
            const Vector3 wo = square_to_uniform_hemisphere(rng.next_float2());
            const Vector3 m = d.sample_visible_normal(wo, rng.next_float2());
            const Vector3 wi = reflect(wo, m);
            if (wi.z <= 0) continue;
            EXPECT_LE(d.G(wo, wi), d.G1(wo) * (1 + 1e-5f));
            EXPECT_EQ(d.G(wo, wi), d.G(wi, wo));
            EXPECT_NEAR(d.G1(wo) * (1 + d.lambda(wo)), 1, 1e-5);
        }
    }
}

TEST(Microfacet, lambda_matches_the_textbook) {
    for (const double degrees : {20.0, 50.0, 85.0}) {
        const double theta = degrees * std::numbers::pi / 180, alpha = 0.4;
        const double a = 1 / (alpha * std::tan(theta));
        const Vector3 w = from_angles(theta, 1);
        const double ggx = 0.5 * (std::sqrt(1 + 1 / (a * a)) - 1);
        const double beckmann =
            0.5 * (std::erf(a) - 1) + std::exp(-a * a) / (2 * a * std::sqrt(std::numbers::pi));
        EXPECT_NEAR(Microfacet(Type::ggx, 0.4f, 0.4f).lambda(w), ggx, 1e-6 * (1 + ggx));
        EXPECT_NEAR(Microfacet(Type::beckmann, 0.4f, 0.4f).lambda(w), beckmann, 1e-6 * (1 + ggx));
    }
}

/// Slopes along the plane of incidence invert their cumulative distribution (Jakob 2014).
TEST(Microfacet, beckmann_slopes_are_exact) {
    const Microfacet d(Type::beckmann, 1, 1);
    for (const double theta : {0.0, 0.01, 0.7, 1.3, 1.57, std::numbers::pi / 2}) {
        const double s = std::sin(theta), c = std::cos(theta);
        const auto cumulative = [s, c](double x) {
            return c * std::sqrt(std::numbers::pi) * (1 + std::erf(x)) + s * std::exp(-x * x);
        };
        for (const float u : {0.001f, 0.1f, 0.5f, 0.9f, 0.999f}) {
            const Vector3d m(d.sample_visible_normal(from_angles(theta, 0), {u, 0.5f}));
            const double total = s > 0 ? cumulative(c / s) : cumulative(40);
            EXPECT_NEAR(cumulative(-m.x / m.z) / total, u, 2e-6) << theta;
        }
    }
}

TEST(Microfacet, D3_in_the_plane_of_the_surface) {
    Rng rng(4);
    std::vector<Microfacet> all(std::begin(distributions), std::end(distributions));
    all.emplace_back(Type::ggx, 1e-4f, 1e-4f);
    all.emplace_back(Type::beckmann, 1e-4f, 1e-4f);
    all.emplace_back(Type::ggx, 1.0f, 1e-4f);
    all.emplace_back(Type::beckmann, 1.0f, 1e-4f);
    for (const Microfacet& d : all) {
        for (int i = 0; i < 10000; ++i) {
            const float heights[] = {0.0f, -0.0f, 1e-30f, 1e-20f, 1e-6f * rng.next_float()};
            const float phi = 2 * pi * rng.next_float();
            const Vector3 wo = at_height(heights[i % 5], phi);
            const Vector3 wi = at_height(heights[i / 5 % 5], 2 * pi * rng.next_float());
            const Vector3 m = d.sample_visible_normal(wo, rng.next_float2());
            ASSERT_NEAR(glm::length(m), 1, 1e-6);
            ASSERT_GT(m.z, 0);
            for (const float x : {d.visible_normal_pdf(wo, m), d.G1(wo), d.G(wo, wi), d.D(wo),
                                  d.visibility(wo, wi), d.visible_normal_pdf(wo, wi)}) {
                ASSERT_TRUE(std::isfinite(x) && x >= 0) << x << " " << name_of(d);
            }
            ASSERT_LE(d.G(wo, wi), 1);
        }
    }
}

TEST(Microfacet, C21_extreme_random_numbers) {
    for (const Microfacet& d : distributions) {
        for (const float x : {0.0f, 0x1p-24f, 0.5f, one_minus_epsilon}) {
            for (const float y : {0.0f, 0x1p-24f, 0.5f, one_minus_epsilon}) {
                for (const Vector3 w : {Vector3(0, 0, 1), Vector3(1, 0, 0), Vector3(0, 0, -1),
                                        from_angles(1.57, 3), from_angles(0.5, 1)}) {
                    const Vector3 m = d.sample_visible_normal(w, {x, y});
                    EXPECT_NEAR(glm::length(m), 1, 1e-6);
                    EXPECT_TRUE(std::isfinite(d.visible_normal_pdf(w, m)));
                }
            }
        }
    }
}

}  // namespace lucerna
