// SPDX-License-Identifier: Apache-2.0
/// Warps of uniform random numbers to points and directions, each with its density.
///
/// `u` is uniform in [0, 1)². `square_to_x(u)` draws; `square_to_x_pdf` is the density it draws
/// with, per unit area of the target, or per solid angle [1/sr] for directions. Directions are
/// unit vectors around +z.
#pragma once

#include "core/math/select.h"
#include "core/math/vector.h"

namespace lucerna {

/// sin φ and cos φ for |φ| ≤ π/4: the series to x⁹, exact to 3·10⁻⁸, in half the time of the
/// library's.
struct SineCosine {
    float sine, cosine;

    explicit SineCosine(float phi) {
        const float x2 = phi * phi;
        cosine = 1 - x2 * (1 / 2.0f - x2 * (1 / 24.0f - x2 * (1 / 720.0f - x2 / 40320.0f)));
        sine =
            phi * (1 - x2 * (1 / 6.0f - x2 * (1 / 120.0f - x2 * (1 / 5040.0f - x2 / 362880.0f))));
    }
};

/// Point (cos φ, sin φ) of the unit circle for φ = 2π u, u in [0, 1].
inline Vector2 unit_circle(float u) {
    const auto quarter = static_cast<int>(4 * u + 0.5f);  // the axis that is nearest
    const SineCosine at(2 * pi * (u - 0.25f * static_cast<float>(quarter)));
    const bool along_y = (quarter & 1) != 0;
    const float x = select(along_y, at.sine, at.cosine), y = select(along_y, at.cosine, at.sine);
    return {select(((quarter + 1) & 2) != 0, -x, x), select((quarter & 2) != 0, -y, y)};
}

/// A disk point together with √(1 − r²), which the disk point alone gives only roughly.
struct DiskPoint {
    Vector2 p;
    float height;
};

/// Concentric map (Shirley and Chiu 1997): keeps neighbours together and areas equal.
/// The square is sampled at cell centres, so the rim and the middle are never hit exactly.
inline DiskPoint square_to_disk_point(Vector2 u) {
    const float a = (2 * u.x - 1) + 0x1p-24f;
    const float b = (2 * u.y - 1) + 0x1p-24f;
    const bool along_y = !less_magnitude(b, a);
    const float r = select(along_y, b, a);
    const float across = select(along_y, a, b);
    const float phi = (pi / 4) * (across / r);  // from the axis along which r lies
    const SineCosine at(phi);
    const float rim = std::abs(r);
    return {r * Vector2(select(along_y, at.sine, at.cosine), select(along_y, at.cosine, at.sine)),
            std::sqrt((1 - rim) * (1 + rim))};
}

/// The unit disk.
inline Vector2 square_to_uniform_disk(Vector2 u) { return square_to_disk_point(u).p; }
inline float square_to_uniform_disk_pdf(Vector2 p) { return glm::dot(p, p) <= 1 ? inv_pi : 0.0f; }

/// The upper hemisphere by cos θ / π (Malley's method). The density of a sample is never zero.
inline Vector3 square_to_cosine_hemisphere(Vector2 u) {
    const DiskPoint d = square_to_disk_point(u);
    return {d.p.x, d.p.y, d.height};
}
inline float square_to_cosine_hemisphere_pdf(Vector3 w) { return std::max(w.z, 0.0f) * inv_pi; }

/// The spherical cap with 1 − cos θ < `one_minus_cos`. The cap's height is the parameter, not
/// its cosine, because a distant light subtends less than one rounding error of the cosine.
inline Vector3 square_to_uniform_cone(Vector2 u, float one_minus_cos) {
    const float t = u.x * one_minus_cos;
    const Vector2 circle = safe_sqrt(t * (2 - t)) * unit_circle(u.y);
    return {circle.x, circle.y, 1 - t};
}
/// Inside the cone; outside it is zero, which only the caller can tell without rounding error.
inline float square_to_uniform_cone_pdf(float one_minus_cos) {
    return 1 / (2 * pi * one_minus_cos);
}

/// The upper hemisphere, uniformly; cos θ is never zero.
inline Vector3 square_to_uniform_hemisphere(Vector2 u) { return square_to_uniform_cone(u, 1); }
inline float square_to_uniform_hemisphere_pdf(Vector3 w) { return w.z >= 0 ? inv_pi / 2 : 0.0f; }

/// The whole sphere, uniformly.
inline Vector3 square_to_uniform_sphere(Vector2 u) { return square_to_uniform_cone(u, 2); }
inline float square_to_uniform_sphere_pdf(Vector3) { return inv_pi / 4; }

/// Barycentric coordinates (b0, b1) of a triangle; the third is 1 − b0 − b1
/// (Heitz 2019, "A Low-Distortion Map Between Triangle and Square").
inline Vector2 square_to_uniform_triangle(Vector2 u) {
    if (u.y > u.x) return {0.5f * u.x, u.y - 0.5f * u.x};
    return {u.x - 0.5f * u.y, 0.5f * u.y};
}
/// Density over (b0, b1); divide by twice the triangle's area for a density per area.
inline float square_to_uniform_triangle_pdf(Vector2 b) {
    return b.x >= 0 && b.y >= 0 && b.x + b.y <= 1 ? 2.0f : 0.0f;
}

/// The tent 1 − |x| on (−1, 1).
inline float interval_to_tent(float u) {
    return u < 0.5f ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 * (1 - u));
}
inline float interval_to_tent_pdf(float x) { return std::max(1 - std::abs(x), 0.0f); }

}  // namespace lucerna
