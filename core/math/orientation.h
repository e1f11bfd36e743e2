// SPDX-License-Identifier: Apache-2.0
/// The axes of a transform that turns, mirrors, moves and scales, but does not stretch.
#pragma once

#include "core/math/frame.h"
#include "core/math/transform.h"

#include <optional>

namespace lucerna {

/// The images of the x, y and z axes as unit vectors. Left-handed if the transform mirrors. Empty
/// if they are not perpendicular or not equally long: angles would change.
inline std::optional<Frame> orientation(const Transform& transform) {
    constexpr double tolerance = 1e-3;  // of matrices that were written with few digits
    const Matrix3d m(transform.matrix());
    const double scale = glm::length(m[0]);
    for (int i = 0; i < 3; ++i) {
        const double along = glm::length(m[i]) / scale - 1;
        const double across = glm::dot(m[i], m[(i + 1) % 3]) / sqr(scale);
        if (!(std::abs(along) < tolerance && std::abs(across) < tolerance)) return {};
    }
    // Gram and Schmidt, keeping the z axis, which is where things look.
    const Vector3d z = glm::normalize(m[2]);
    const Vector3d y = glm::normalize(m[1] - z * glm::dot(z, m[1]));
    const Vector3d x = glm::cross(y, z) * (glm::determinant(m) < 0 ? -1.0 : 1.0);
    return Frame{Vector3(x), Vector3(y), Vector3(z)};
}

}  // namespace lucerna
