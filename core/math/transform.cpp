// SPDX-License-Identifier: Apache-2.0
/// Composition, inversion and application of transforms.
#include "core/math/transform.h"

#include "core/math/rounding.h"

#include <stdexcept>

namespace lucerna {
namespace {

void require_finite(const Matrix4d& m, const char* what) {
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) {
            if (!std::isfinite(m[c][r])) throw std::invalid_argument(what);
        }
    }
}

/// The power of two nearest above `x`, 1 for zero: scaling by it rounds nothing.
double magnitude(double x) {
    // As a double, since ilogb of infinity is the largest int.
    return x == 0 ? 1.0 : std::exp2(static_cast<double>(std::ilogb(x)) + 1);
}

/// Inverse of a matrix whose rows and columns may differ by many orders of magnitude.
///
/// Rows, then columns, are scaled to about one first, so that neither tiny scales nor far
/// translations look singular. What remains is singular if its computed inverse is none.
Matrix4d inverse_of(const Matrix4d& m) {
    Matrix4d a = m;
    double row_scale[4], column_scale[4];
    for (int r = 0; r < 4; ++r) {
        double largest = 0;
        for (int c = 0; c < 4; ++c) largest = std::max(largest, std::abs(a[c][r]));
        row_scale[r] = 1 / magnitude(largest);
        for (int c = 0; c < 4; ++c) a[c][r] *= row_scale[r];
    }
    for (int c = 0; c < 4; ++c) {
        double largest = 0;
        for (int r = 0; r < 4; ++r) largest = std::max(largest, std::abs(a[c][r]));
        column_scale[c] = 1 / magnitude(largest);
        for (int r = 0; r < 4; ++r) a[c][r] *= column_scale[c];
    }
    const Matrix4d b = glm::inverse(a);
    const Matrix4d residual = a * b - Matrix4d(1.0);
    Matrix4d inverse;
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) {
            if (!(std::abs(residual[c][r]) < 1e-3)) {
                throw std::invalid_argument("the matrix is singular: it flattens space");
            }
            inverse[c][r] = b[c][r] * row_scale[c] * column_scale[r];
        }
    }
    return inverse;
}

/// An axis that is far from parallel to the unit vector `v`.
Vector3d axis_across(Vector3d v) {
    return std::abs(v.y) < 0.9 ? Vector3d(0, 1, 0) : Vector3d(0, 0, 1);
}

}  // namespace

Transform::Transform(const Matrix4d& matrix) : matrix_(matrix) {
    require_finite(matrix, "the matrix has an entry that is not a finite number");
    inverse_ = inverse_of(matrix);
    require_finite(inverse_, "the matrix is singular: its inverse overflows");
}

Transform Transform::translate(Vector3d offset) {
    Matrix4d forward(1.0), backward(1.0);
    forward[3] = glm::dvec4(offset, 1);
    backward[3] = glm::dvec4(-offset, 1);
    require_finite(forward, "the translation is not finite");
    return {forward, backward};
}

Transform Transform::scale(Vector3d factors) {
    Matrix4d forward(1.0), backward(1.0);
    for (int i = 0; i < 3; ++i) {
        forward[i][i] = factors[i];
        backward[i][i] = 1 / factors[i];
    }
    require_finite(forward, "a scale factor is not finite");
    require_finite(backward, "a scale factor is zero: it flattens space");
    return {forward, backward};
}

Transform Transform::rotate(Vector3d axis, double degrees) {
    const double length = glm::length(axis);
    if (!(length > 0) || !std::isfinite(length) || !std::isfinite(degrees)) {
        throw std::invalid_argument("a rotation needs a finite axis, not zero, and a finite angle");
    }
    // Quarter turns come out exact, so that boxes stay aligned with the axes.
    int quarter = 0;
    const double rest = std::remquo(degrees, 90.0, &quarter) * (std::numbers::pi / 180);
    double s = std::sin(rest), c = std::cos(rest);
    if (quarter & 1) {
        const double old_s = s;
        s = c;
        c = -old_s;
    }
    if (quarter & 2) {
        s = -s;
        c = -c;
    }
    // Rodrigues' formula: c·I + s·[k]ₓ + (1 − c)·k kᵀ.
    const Vector3d k = axis / length;
    Matrix3d r = glm::outerProduct(k, k) * (1 - c) + Matrix3d(c);
    r += s * Matrix3d(0, k.z, -k.y, -k.z, 0, k.x, k.y, -k.x, 0);
    return {Matrix4d(r), Matrix4d(glm::transpose(r))};
}

Transform Transform::look_at(Vector3d origin, Vector3d target, Vector3d up) {
    const Vector3d view = target - origin;
    const double distance = glm::length(view);
    if (!(distance > 0) || !std::isfinite(distance)) {
        throw std::invalid_argument("look_at needs a finite origin and target that differ");
    }
    const Vector3d z = view / distance;
    Vector3d x = glm::cross(up, z);
    if (!(glm::dot(x, x) > 1e-20 * glm::dot(up, up))) x = glm::cross(axis_across(z), z);
    x = glm::normalize(x);
    const Matrix3d r(x, glm::cross(z, x), z);
    Matrix4d forward(r), backward(glm::transpose(r));
    forward[3] = glm::dvec4(origin, 1);
    backward[3] = glm::dvec4(-(glm::transpose(r) * origin), 1);
    require_finite(forward, "look_at needs finite vectors");
    return {forward, backward};
}

Transform Transform::operator*(const Transform& other) const {
    return {matrix_ * other.matrix_, other.inverse_ * inverse_};
}

Transform Transform::inverse() const { return {inverse_, matrix_}; }

bool Transform::is_identity() const { return matrix_ == Matrix4d(1.0); }

bool Transform::swaps_handedness() const { return glm::determinant(Matrix3d(matrix_)) < 0; }

Vector3d Transform::point(Vector3d p) const {
    const glm::dvec4 q = matrix_ * glm::dvec4(p, 1);
    return q.w == 1 ? Vector3d(q) : Vector3d(q) / q.w;
}

Vector3d Transform::direction(Vector3d v) const { return Matrix3d(matrix_) * v; }

Vector3d Transform::normal(Vector3d n) const { return n * Matrix3d(inverse_); }

Bounds3 Transform::bounds(const Bounds3& b) const {
    Bounds3 result;
    if (b.empty()) return result;
    for (int corner = 0; corner < 8; ++corner) {
        const Vector3d p =
            point(Vector3d(corner & 1 ? b.max.x : b.min.x, corner & 2 ? b.max.y : b.min.y,
                           corner & 4 ? b.max.z : b.min.z));
        result.include(Vector3(float_below(p.x), float_below(p.y), float_below(p.z)));
        result.include(Vector3(float_above(p.x), float_above(p.y), float_above(p.z)));
    }
    return result;
}

}  // namespace lucerna
