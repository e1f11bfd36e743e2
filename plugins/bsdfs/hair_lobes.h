// SPDX-License-Identifier: Apache-2.0
/// The distributions of light around a fibre: along it M (d'Eon et al. 2011, "An Energy-Conserving
/// Hair Reflectance Model"), around it N, a logistic distribution on the circle (Chiang et al.
/// 2016).
#pragma once

#include "core/math/vector.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lucerna {

/// log I₀(x), the modified Bessel function of order zero, for x ≥ 0.
inline double log_bessel_i0(double x) {
    if (x > 12) {
        const double y = 1 / (8 * x);
        const double tail = std::log1p(y * (1 + y * (4.5 + 37.5 * y)));
        return x - 0.5 * std::log(2 * std::numbers::pi * x) + tail;
    }
    double sum = 0, term = 1;
    for (int i = 1; i < 40; ++i) {
        sum += term;
        term *= sqr(0.5 * x / i);
    }
    return std::log(sum);
}

/// Density of the sine of the angle of wi to the plane across the fibre, dω = d sin θ dφ, given the
/// sine for wo and the variance v.
inline double longitudinal(double sin_i, double sin_o, double v) {
    const double cos_i = std::sqrt(std::max(1 - sqr(sin_i), 0.0));
    const double cos_o = std::sqrt(std::max(1 - sqr(sin_o), 0.0));
    // 1 / (2 v sinh(1 / v)) without overflow.
    const double log_norm = -std::log(v) - 1 / v - std::log1p(-std::exp(-2 / v));
    return std::exp(log_bessel_i0(cos_i * cos_o / v) - sin_i * sin_o / v + log_norm);
}

/// The sine of the angle of wi, for u in [0, 1)² (d'Eon et al. 2013, "Importance Sampling for
/// Physically-Based Hair Fiber Models").
inline double sample_longitudinal(Vector2d u, double sin_o, double v) {
    const double cosine = 1 + v * std::log(std::max(u.x + (1 - u.x) * std::exp(-2 / v), 1e-300));
    const double sine = std::sqrt(std::max(1 - sqr(cosine), 0.0));
    const double cos_o = std::sqrt(std::max(1 - sqr(sin_o), 0.0));
    return std::clamp(-cosine * sin_o + sine * std::cos(2 * std::numbers::pi * u.y) * cos_o, -1.0,
                      1.0);
}

/// The cumulative logistic distribution of scale s.
inline double logistic_cdf(double x, double s) { return 1 / (1 + std::exp(-x / s)); }

/// Density of an angle [1/rad], of any turn, around zero; the tails beyond ±π are cut.
inline double azimuthal(double angle, double s) {
    constexpr double pi_d = std::numbers::pi;
    const double x = std::abs(std::remainder(angle, 2 * pi_d));
    const double e = std::exp(-x / s);
    return e / (s * sqr(1 + e)) / (logistic_cdf(pi_d, s) - logistic_cdf(-pi_d, s));
}

/// An angle in [−π, π], for u in [0, 1).
inline double sample_azimuthal(double u, double s) {
    constexpr double pi_d = std::numbers::pi;
    const double low = logistic_cdf(-pi_d, s), high = logistic_cdf(pi_d, s);
    const double k = std::clamp(low + u * (high - low), 1e-300, 1 - 0x1p-53);
    return std::clamp(-s * std::log(1 / k - 1), -pi_d, pi_d);
}

}  // namespace lucerna
