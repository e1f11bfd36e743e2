// SPDX-License-Identifier: Apache-2.0
#include "core/math/fresnel.h"

#include "core/math/rounding.h"
#include "core/math/warp.h"
#include "tests/statistics.h"

namespace lucerna {
namespace {

/// The textbook formula in extended precision, `eta` relative to the incident side.
double reference(float cos_theta, long double eta) {
    const long double ci = cos_theta, ct2 = 1 - (1 - ci * ci) / (eta * eta);
    if (ct2 <= 0) return 1;
    const long double ct = std::sqrt(ct2);
    const long double p = (eta * ci - ct) / (eta * ci + ct), s = (ci - eta * ct) / (ci + eta * ct);
    return static_cast<double>((p * p + s * s) / 2);
}

float cos_of(double degrees) {
    return static_cast<float>(std::cos(degrees * std::numbers::pi / 180));
}

}  // namespace

TEST(Fresnel, D5_D8_agrees_with_extended_precision) {
    Rng rng(1);
    for (const float eta : {1.5f, 1.33f, 1.0001f, 2.4f}) {
        const long double inverse = 1 / static_cast<long double>(eta);
        const auto critical = static_cast<float>(std::sqrt(1 - 1 / sqr(static_cast<double>(eta))));
        for (int i = 0; i < 100000; ++i) {
            const float c = rng.next_float();
            EXPECT_NEAR(fresnel_dielectric(c, eta), reference(c, eta), 1e-6);
            EXPECT_NEAR(fresnel_dielectric(-c, eta), reference(c, inverse), 1e-6);
            // Within a few roundings of the critical angle.
            const float near = critical * (1 + (c - 0.5f) * 1e-5f);
            EXPECT_NEAR(fresnel_dielectric(-near, eta), reference(near, inverse), 1e-6);
            const float grazing = 1e-4f * c;
            EXPECT_NEAR(fresnel_dielectric(grazing, eta), reference(grazing, eta), 1e-6);
        }
    }
    EXPECT_NEAR(fresnel_dielectric(1, 1.5f), 0.04f, 1e-8);
    EXPECT_EQ(fresnel_dielectric(0, 1.5f), 1);
}

TEST(Fresnel, D6_total_internal_reflection) {
    for (const double degrees : {41.9, 45.0, 60.0, 89.9}) {
        EXPECT_EQ(fresnel_dielectric(-cos_of(degrees), 1.5f), 1);
        EXPECT_EQ(fresnel_dielectric(cos_of(degrees), 1 / 1.5f), 1);
    }
    EXPECT_LT(fresnel_dielectric(-cos_of(41.7), 1.5f), 1);
    const Vector3 n(0, 0, 1), w(std::sqrt(0.75f), 0, -0.5f);
    EXPECT_FALSE(refract(w, n, 1.5f));
    EXPECT_TRUE(refract(-w, n, 1.5f));
}

TEST(Fresnel, D7_equal_indices_are_invisible) {
    for (const float c : {0.0f, 1e-20f, 1e-8f, 1e-4f, 0.5f, 1.0f}) {
        EXPECT_EQ(fresnel_dielectric(c, 1), 0);
        EXPECT_EQ(fresnel_dielectric(-c, 1), 0);
        EXPECT_LT(fresnel_conductor(c, 1, 0), 1e-6f);
    }
    const Vector3 w = glm::normalize(Vector3(1, 2, 1e-9f));
    EXPECT_EQ(refract(w, {0, 0, 1}, 1)->direction, -w);
}

TEST(Fresnel, refraction_obeys_snell_and_agrees_with_the_reflectance) {
    Rng rng(2);
    int refracted = 0;
    for (int i = 0; i < 300000; ++i) {
        const Vector3 n = square_to_uniform_sphere(rng.next_float2());
        const Vector3 w = square_to_uniform_sphere(rng.next_float2());
        const float eta = 0.4f + 2 * rng.next_float();
        const float c = glm::dot(w, n);
        const std::optional<Refraction> r = refract(w, n, eta);
        ASSERT_EQ(!r.has_value(), fresnel_dielectric(c, eta) == 1) << c << " " << eta;
        if (!r) continue;
        ++refracted;
        EXPECT_EQ(r->eta, relative_eta(c, eta));
        EXPECT_NEAR(glm::length(r->direction), 1, 1e-6);
        EXPECT_LE(glm::dot(r->direction, n) * (c < 0 ? -1.0f : 1.0f), 1e-7f);
        EXPECT_LT(glm::length(glm::cross(w, n) + r->eta * glm::cross(r->direction, n)), 3e-6);
    }
    EXPECT_GT(refracted, 100000);
}

TEST(Fresnel, O11_glass_slab) {
    const struct {
        double degrees, transmittance;
    } cases[] = {{0, 0.923077}, {30, 0.920266}, {60, 0.836232}, {80, 0.441229}};
    for (const auto& [degrees, transmittance] : cases) {
        const double f = fresnel_dielectric(cos_of(degrees), 1.5f);
        EXPECT_NEAR((1 - f) / (1 + f), transmittance, 1e-6);
    }
}

TEST(Fresnel, O11_average_reflectance) {
    EXPECT_NEAR(average_fresnel_dielectric(1.5f), 0.0917780, 2e-7);
    EXPECT_NEAR(average_fresnel_dielectric(1 / 1.5f), 0.5963458, 3e-7);
    EXPECT_EQ(average_fresnel_dielectric(1), 0);
    const GaussLegendre fine(2000);
    for (const float eta : {1.0001f, 1.01f, 1.33f, 2.4f, 4.0f}) {
        const double expected = fine.integrate(0, 1, [eta](double t) {
            const double mu = t * t;
            return reference(static_cast<float>(mu), eta) * 4 * mu * t;
        });
        EXPECT_NEAR(average_fresnel_dielectric(eta), expected, 1e-6) << eta;
    }
}

TEST(Fresnel, conductor) {
    const float eta = 0.2f, k = 3.9f;
    const double normal = (sqr(eta - 1.0) + sqr(static_cast<double>(k))) /
                          (sqr(eta + 1.0) + sqr(static_cast<double>(k)));
    EXPECT_NEAR(fresnel_conductor(1, eta, k), normal, 1e-7);
    EXPECT_NEAR(fresnel_conductor(0, eta, k), 1, 1e-7);
    for (int i = 0; i <= 100; ++i) {
        const float c = static_cast<float>(i) / 100;
        EXPECT_NEAR(fresnel_conductor(c, 1.5f, 0), fresnel_dielectric(c, 1.5f), 1e-6);
        const Color f = fresnel_conductor(c, Color(0.2f, 0.9f, 1.5f), Color(3.9f, 2.4f, 1.9f));
        EXPECT_TRUE(min_component(f) >= 0 && max_component(f) <= 1);
    }
    const Color average = average_fresnel_conductor(Color(1.5f, eta, 1), Color(0, k, 0));
    EXPECT_NEAR(average.x, average_fresnel_dielectric(1.5f), 1e-6);
    const double fine = GaussLegendre(2000).integrate(0, 1, [&](double mu) {
        return 2 * mu * fresnel_conductor(static_cast<float>(mu), eta, k);
    });
    EXPECT_NEAR(average.y, fine, 1e-6);
    EXPECT_NEAR(average.z, 0, 1e-5);
}

}  // namespace lucerna
