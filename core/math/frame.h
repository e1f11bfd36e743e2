// SPDX-License-Identifier: Apache-2.0
/// Orthonormal frames, and trigonometry of directions in a frame whose z axis is the normal.
#pragma once

#include "core/math/vector.h"

namespace lucerna {

/// Right-handed orthonormal basis: s, t, n are the world-space images of x, y, z.
struct Frame {
    Vector3 s{1, 0, 0}, t{0, 1, 0}, n{0, 0, 1};

    /// Any frame around the unit vector `n`, continuous but for one direction
    /// (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
    static Frame from_normal(Vector3 n) {
        const float sign = std::copysign(1.0f, n.z);
        const float a = -1 / (sign + n.z);
        const float b = n.x * n.y * a;
        return {
            {1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
    }

    /// The frame around unit `n` whose s axis follows `tangent` as closely as it can.
    static Frame from_normal_tangent(Vector3 n, Vector3 tangent) {
        const Vector3 s = tangent - n * glm::dot(n, tangent);
        const float length2 = glm::dot(s, s);
        if (!(length2 > 1e-12f * glm::dot(tangent, tangent))) return from_normal(n);
        const Vector3 unit = s / std::sqrt(length2);
        return {unit, glm::cross(n, unit), n};
    }

    Vector3 to_local(Vector3 v) const { return {glm::dot(v, s), glm::dot(v, t), glm::dot(v, n)}; }
    Vector3 to_world(Vector3 v) const { return s * v.x + t * v.y + n * v.z; }
};

inline float cos_theta(Vector3 w) { return w.z; }
inline float abs_cos_theta(Vector3 w) { return std::abs(w.z); }
inline float cos2_theta(Vector3 w) { return w.z * w.z; }
/// From x and y, not 1 − cos²: exact where θ is small.
inline float sin2_theta(Vector3 w) { return w.x * w.x + w.y * w.y; }
inline bool same_hemisphere(Vector3 a, Vector3 b) { return a.z * b.z > 0; }
/// Mirror reflection about the normal.
inline Vector3 reflect(Vector3 w) { return {-w.x, -w.y, w.z}; }
/// Mirror reflection of `w` about the unit vector `m`.
inline Vector3 reflect(Vector3 w, Vector3 m) { return 2 * glm::dot(w, m) * m - w; }

}  // namespace lucerna
