// SPDX-License-Identifier: Apache-2.0
/// Evaluation and sampling of microfacet distributions.
#include "core/math/microfacet.h"

#include "core/math/warp.h"

namespace lucerna {
namespace {

constexpr double sqrt_pi = 1.7724538509055160;

/// Inverse error function, relative error below 4e-7
/// (Giles 2012, "Approximating the erfinv function", table 5). x in (−1, 1).
double inverse_erf(double x) {
    constexpr double central[] = {2.81022636e-08,  3.43273939e-07, -3.5233877e-06,
                                  -4.39150654e-06, 0.00021858087,  -0.00125372503,
                                  -0.00417768164,  0.246640727,    1.50140941};
    constexpr double tail[] = {-0.000200214257, 0.000100950558, 0.00134934322,
                               -0.00367342844,  0.00573950773,  -0.0076224613,
                               0.00943887047,   1.00167406,     2.83297682};
    double w = -std::log((1 - x) * (1 + x));
    const bool in_center = w < 5;
    w = in_center ? w - 2.5 : std::sqrt(w) - 3;
    double p = 0;
    for (const double c : in_center ? central : tail) p = p * w + c;
    return p * x;
}

/// Slope along the direction of incidence, by the visible part of a Gaussian of unit width.
///
/// With cot θ = a the density of slopes is (a − x) exp(−x²) for x < a. Its cumulative function
/// ∝ cos θ √π (1 + b) + sin θ exp(−x²) in b = erf x is inverted by Newton's method, kept inside a
/// shrinking bracket (Jakob 2014, "An Improved Visible Normal Sampling Routine for the Beckmann
/// Distribution").
double sample_visible_slope(double sin_theta, double cos_theta, double u) {
    const double a = cos_theta / sin_theta;
    double low = -1, high = std::erf(a);
    const double total = cos_theta * sqrt_pi * (1 + high) + sin_theta * std::exp(-a * a);
    // Start at the answer for normal incidence; it only has to be in the bracket.
    double b = low + u * (high - low);
    double x = inverse_erf(b);
    for (int step = 0; step < 40; ++step) {
        const double excess =
            cos_theta * sqrt_pi * (1 + b) + sin_theta * std::exp(-x * x) - u * total;
        const double next = b - excess / (sqrt_pi * (cos_theta - x * sin_theta));
        if (std::abs(excess) < 1e-5 * std::min(u, 1 - u) * total) return inverse_erf(next);
        (excess > 0 ? high : low) = b;
        b = next > low && next < high ? next : 0.5 * (low + high);
        x = inverse_erf(b);
    }
    return x;
}

Vector3 sample_beckmann(Vector3 stretched, Vector2 u, float alpha_x, float alpha_y) {
    const double sin_theta = std::hypot(static_cast<double>(stretched.x), stretched.y);
    const double cos_phi = sin_theta > 0 ? stretched.x / sin_theta : 1.0;
    const double sin_phi = sin_theta > 0 ? stretched.y / sin_theta : 0.0;
    // Cell centres, because the ends map to infinite slopes.
    const double along = sample_visible_slope(sin_theta, stretched.z, u.x + 0x1p-25);
    const double across = inverse_erf(2 * (u.y + 0x1p-25) - 1);
    const Vector3d m((sin_phi * across - cos_phi * along) * alpha_x,
                     -(sin_phi * along + cos_phi * across) * alpha_y, 1);
    return Vector3(glm::normalize(m));
}

/// Spherical caps (Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps").
/// The normal is the half vector of w and of a point of the cap z > −w.z; its z is formed without
/// the point's, because their sum would cancel.
Vector3 sample_ggx(Vector3 stretched, Vector2 u, float alpha_x, float alpha_y) {
    const float above = 1 + stretched.z;
    const float hz = (1 - u.y) * above;
    const float below = sqr(stretched.x) + sqr(stretched.y);
    const float sin_theta = std::sqrt(u.y * above * (hz + below / above));
    const Vector2 side = sin_theta * unit_circle(u.x);
    return glm::normalize(
        Vector3((side.x + stretched.x) * alpha_x, (side.y + stretched.y) * alpha_y, hz));
}

}  // namespace

float Microfacet::D(Vector3 m) const {
    if (!(m.z > 0)) return 0;
    // tan θ from x and y: from 1 − cos² it would be noise for small alpha.
    const float slope2 = sqr(m.x / alpha_x) + sqr(m.y / alpha_y);
    const float cos2 = m.z * m.z, area = pi * alpha_x * alpha_y;
    if (type == Type::ggx) return 1 / (area * sqr(cos2 + slope2));
    if (!(slope2 < 100 * cos2)) return 0;
    return std::exp(-slope2 / cos2) / (area * cos2 * cos2);
}

float Microfacet::visible_area(Vector3 w) const {
    const float z = std::abs(w.z);
    const float side = std::sqrt(sqr(w.x * alpha_x) + sqr(w.y * alpha_y));
    if (type == Type::ggx) return 0.5f * (z + std::sqrt(z * z + side * side));
    const float a = z / side;
    if (!(a < 5)) return z;
    constexpr float inv_sqrt_pi = std::numbers::inv_sqrtpi_v<float>;
    return 0.5f * (z * (1 + std::erf(a)) + side * inv_sqrt_pi * std::exp(-a * a));
}

float Microfacet::visibility(Vector3 wo, Vector3 wi) const {
    const float zo = std::abs(wo.z), zi = std::abs(wi.z);
    const float both = visible_area(wo) * zi + visible_area(wi) * zo - zo * zi;
    return both > 0 ? 1 / both : 0.0f;
}

Vector3 Microfacet::sample_visible_normal(Vector3 w, Vector2 u) const {
    if (w.z < 0) w = -w;
    const Vector3 stretched = glm::normalize(Vector3(w.x * alpha_x, w.y * alpha_y, w.z));
    return type == Type::ggx ? sample_ggx(stretched, u, alpha_x, alpha_y)
                             : sample_beckmann(stretched, u, alpha_x, alpha_y);
}

}  // namespace lucerna
