// SPDX-License-Identifier: Apache-2.0
/// Fresnel reflectance of unpolarised light, and refraction.
///
/// Formulas as in pbrt 4e, 9.3.5 and 9.3.6. Computed in double: in float the reflectance is wrong
/// by 3e-4 near the critical angle and by 5e-2 for nearly equal indices.
/// `eta` is the index of refraction on the inside (the side the normal points away from) over that
/// on the outside. Directions point away from the surface.
#pragma once

#include "core/math/quadrature.h"

#include <optional>

namespace lucerna {

/// Index of refraction behind the surface over that in front, for light on the side given by the
/// sign of `cos_theta`.
inline float relative_eta(float cos_theta, float eta) { return cos_theta < 0 ? 1 / eta : eta; }

/// cos² of the transmitted angle by Snell's law, for `eta` already relative to the incident side.
/// Negative or zero: total internal reflection.
inline double cos2_transmitted(double cos_theta, double eta) {
    return 1 - (1 - cos_theta) * (1 + cos_theta) / (eta * eta);
}

/// Reflectance in [0, 1] of a smooth dielectric. `cos_theta` is signed: negative comes from inside.
/// Exactly 0 for eta = 1, at any angle; exactly 1 under total internal reflection.
inline float fresnel_dielectric(float cos_theta, float eta) {
    if (eta == 1) return 0;
    const double n = cos_theta < 0 ? 1 / static_cast<double>(eta) : static_cast<double>(eta);
    const double ci = std::min(std::abs(static_cast<double>(cos_theta)), 1.0);
    const double ct2 = cos2_transmitted(ci, n);
    if (!(ct2 > 0)) return 1;
    const double ct = std::sqrt(ct2);
    const double parallel = (n * ci - ct) / (n * ci + ct);
    const double perpendicular = (ci - n * ct) / (ci + n * ct);
    return static_cast<float>(0.5 * (sqr(parallel) + sqr(perpendicular)));
}

struct Refraction {
    /// Unit direction on the other side.
    Vector3 direction;
    /// Index of refraction there over that on this side.
    float eta;
};

/// Refraction of `w`, on either side of the unit vector `n`. Empty exactly where
/// fresnel_dielectric(dot(w, n), eta) is 1 by total internal reflection.
inline std::optional<Refraction> refract(Vector3 w, Vector3 n, float eta) {
    const float c = glm::dot(w, n);
    if (eta == 1) return Refraction{-w, 1};
    const double relative = c < 0 ? 1 / static_cast<double>(eta) : static_cast<double>(eta);
    const double ci = std::min(std::abs(static_cast<double>(c)), 1.0);
    const double ct2 = cos2_transmitted(ci, relative);
    if (!(ct2 > 0)) return {};
    const Vector3d facing = c < 0 ? -Vector3d(n) : Vector3d(n);
    const Vector3d t = (ci / relative - std::sqrt(ct2)) * facing - Vector3d(w) / relative;
    return Refraction{Vector3(glm::normalize(t)), relative_eta(c, eta)};
}

/// Reflectance in [0, 1] of a smooth conductor with complex index eta + i k, relative to outside.
inline float fresnel_conductor(float cos_theta, float eta, float k) {
    const double c2 = std::min(sqr(static_cast<double>(cos_theta)), 1.0), s2 = 1 - c2;
    const double c = std::sqrt(c2);
    const double n2 = sqr(static_cast<double>(eta)), k2 = sqr(static_cast<double>(k));
    const double d = (n2 - 1) - k2 + c2;
    const double a2_plus_b2 = std::sqrt(d * d + 4 * n2 * k2);
    // Only a perfect match at grazing incidence.
    if (a2_plus_b2 + c2 == 0) return 0;
    const double a = safe_sqrt(0.5 * (a2_plus_b2 + d));
    const double perpendicular = (a2_plus_b2 + c2 - 2 * a * c) / (a2_plus_b2 + c2 + 2 * a * c);
    const double sum = c2 * a2_plus_b2 + s2 * s2, twice = 2 * a * c * s2;
    const double parallel = perpendicular * (sum - twice) / (sum + twice);
    return static_cast<float>(0.5 * (parallel + perpendicular));
}

/// The same for each channel.
inline Color fresnel_conductor(float cos_theta, Color eta, Color k) {
    return {fresnel_conductor(cos_theta, eta.x, k.x), fresnel_conductor(cos_theta, eta.y, k.y),
            fresnel_conductor(cos_theta, eta.z, k.z)};
}

/// Mean of a reflectance F(cos θ) over a uniformly lit hemisphere, ∫₀¹ F(μ) 2μ dμ.
/// With μ = t⁴ the nodes crowd where F is steep: at grazing angles.
template <typename F>
float average_reflectance(F f) {
    static const GaussLegendre rule(64);
    return static_cast<float>(rule.integrate(0, 1, [&](double t) {
        const double t3 = t * t * t, mu = t3 * t;
        return static_cast<double>(f(static_cast<float>(mu))) * 8 * mu * t3;
    }));
}

/// Reflectance of a smooth dielectric for diffuse light from outside. For diffuse light from
/// inside give 1 / eta, which is answered by 1 − F̄(1/η) = (1 − F̄(η)) / η²: both sides exchange
/// equal power in equilibrium.
inline float average_fresnel_dielectric(float eta) {
    if (eta < 1) return 1 - (1 - average_fresnel_dielectric(1 / eta)) * eta * eta;
    return average_reflectance([eta](float mu) { return fresnel_dielectric(mu, eta); });
}

/// Reflectance of a smooth conductor for diffuse light.
inline Color average_fresnel_conductor(Color eta, Color k) {
    const auto channel = [](float n, float absorption) {
        return average_reflectance(
            [n, absorption](float mu) { return fresnel_conductor(mu, n, absorption); });
    };
    return {channel(eta.x, k.x), channel(eta.y, k.y), channel(eta.z, k.z)};
}

}  // namespace lucerna
