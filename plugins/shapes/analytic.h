// SPDX-License-Identifier: Apache-2.0
/// What the analytic shapes share: they stay round under `to_world`, and are met in double.
#pragma once

#include "core/interfaces/shape.h"
#include "core/math/angle.h"
#include "core/math/rounding.h"
#include "core/math/select.h"

#include <fmt/format.h>

namespace lucerna {

/// The factor by which `m` scales all directions alike. If it does not, an error is recorded at
/// `to_world`, with `remedy`.
inline double uniform_scale(const Params& params, const Transform& world_from_object,
                            const Matrix3d& m, std::string_view remedy) {
    const double scale = std::cbrt(std::abs(glm::determinant(m)));
    const Matrix3d gram = glm::transpose(m) * m / (scale * scale);
    double deviation = 0;
    for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) {
            deviation = std::max(deviation, std::abs(gram[c][r] - (c == r ? 1 : 0)));
        }
    }
    if (deviation > 1e-4) {  // matrices are written with six digits
        const Matrix3d w(world_from_object.matrix());
        params.error(
            "to_world",
            fmt::format("\"to_world\" stretches x, y and z by {:.4g}, {:.4g} and {:.4g}{}, "
                        "but a {} must stay round: {}, or use a mesh",
                        glm::length(w[0]), glm::length(w[1]), glm::length(w[2]),
                        glm::length(w[0]) == glm::length(w[1]) ? " or shears" : "", params.type(),
                        remedy));
    }
    return scale;
}

/// The box from `min` to `max`, rounded outwards and a few roundings larger, so that boxes without
/// thickness are not missed.
inline Bounds3 bounds_around(Vector3d min, Vector3d max) {
    Bounds3 bounds;
    for (int i = 0; i < 3; ++i) {
        const double margin = 0x1p-22 * std::max(std::abs(min[i]), std::abs(max[i]));
        bounds.min[i] = float_below(min[i] - margin);
        bounds.max[i] = float_above(max[i] + margin);
    }
    return bounds;
}

/// Distance from the surface of a point that was computed in double from coordinates up to
/// `magnitude` and rounded to the float `p`.
inline float rounding_error(Vector3 p, double magnitude) {
    return gamma(2) * max_component(absolute(p)) + static_cast<float>(0x1p-46 * magnitude);
}

/// Parameters t, in order, at which a line meets a sphere or a circle.
struct Roots {
    double near, far;

    /// The one that the float `t` was.
    double nearest(float t) const {
        return std::abs(near - static_cast<double>(t)) <= std::abs(far - static_cast<double>(t))
                   ? near
                   : far;
    }
};

/// Where o + t d meets the sphere (Vector3d) or the circle (Vector2d) of this radius around zero.
/// By the distance of the line from the centre: b² − 4ac loses the radius of a far sphere
/// (Haines, Günther and Akenine-Möller 2019, "Precision Improvements for Ray/Sphere Intersection").
template <typename Vector>
std::optional<Roots> meet_round(Vector o, Vector d, double radius) {
    const double a = glm::dot(d, d);
    if (!(a > 0)) return {};
    const double middle = -glm::dot(o, d) / a;
    const Vector closest = o + middle * d;
    const double half2 = (radius * radius - glm::dot(closest, closest)) / a;
    if (!(half2 >= 0)) return {};
    // The root of larger magnitude first; the other from their product, which cannot cancel.
    const double larger = middle + std::copysign(std::sqrt(half2), middle);
    if (larger == 0) return Roots{0, 0};
    const double distance = glm::length(o);
    const double smaller = (distance - radius) * (distance + radius) / a / larger;
    return Roots{std::min(smaller, larger), std::max(smaller, larger)};
}

/// An angle in [−π, π] as a fraction of a turn, in [0, 1].
inline float turn_of(float angle) {
    const float turn = angle * (0.5f * inv_pi);
    return turn + select(turn < 0, 1, 0);
}
/// The same for the angle of `p`.
inline float turn_of(Vector2 p) { return turn_of(angle_of(p.x, p.y)); }

}  // namespace lucerna
