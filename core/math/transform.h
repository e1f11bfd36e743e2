// SPDX-License-Identifier: Apache-2.0
/// Affine and projective transforms, composed in double precision.
///
/// Named destination from source: `world_from_object * object_from_mesh` is right when the inner
/// names meet.
#pragma once

#include "core/math/bounds.h"

namespace lucerna {

/// An invertible transform with its inverse. Double, so that long chains and far translations
/// lose nothing; results are rounded to float once, at the end.
class Transform {
public:
    Transform() = default;
    /// Throws std::invalid_argument when the matrix is singular or not finite.
    explicit Transform(const Matrix4d& matrix);

    static Transform translate(Vector3d offset);
    /// Throws std::invalid_argument for a zero factor.
    static Transform scale(Vector3d factors);
    /// Right-handed rotation by `degrees` around `axis` (any length but zero).
    static Transform rotate(Vector3d axis, double degrees);
    /// world_from_camera for a camera at `origin` that looks along +z at `target`, y near `up`,
    /// x to the left (Mitsuba's convention). Any `up` works: one that is parallel to the view is
    /// replaced. Throws std::invalid_argument if origin and target coincide.
    static Transform look_at(Vector3d origin, Vector3d target, Vector3d up);

    Transform operator*(const Transform& other) const;
    Transform inverse() const;

    const Matrix4d& matrix() const { return matrix_; }
    const Matrix4d& inverse_matrix() const { return inverse_; }
    bool is_identity() const;
    /// True if the transform mirrors (negative determinant), so that winding order flips.
    bool swaps_handedness() const;

    Vector3d point(Vector3d p) const;
    Vector3d direction(Vector3d v) const;
    /// By the inverse transpose; not normalised.
    Vector3d normal(Vector3d n) const;
    Vector3 point(Vector3 p) const { return Vector3(point(Vector3d(p))); }
    Vector3 direction(Vector3 v) const { return Vector3(direction(Vector3d(v))); }
    Vector3 normal(Vector3 n) const { return Vector3(normal(Vector3d(n))); }
    Bounds3 bounds(const Bounds3& b) const;

private:
    Transform(const Matrix4d& matrix, const Matrix4d& inverse)
        : matrix_(matrix), inverse_(inverse) {}
    Matrix4d matrix_{1.0}, inverse_{1.0};
};

}  // namespace lucerna
