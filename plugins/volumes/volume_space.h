// SPDX-License-Identifier: Apache-2.0
/// The space of a volume's voxels, and where points and boxes of the world lie in it.
#pragma once

#include "core/math/bounds.h"
#include "core/math/transform.h"
#include "core/plugin/params.h"

namespace lucerna {

/// The parameter `to_world`, which must be affine.
inline Transform volume_transform(const Params& params, std::string_view doc) {
    const Transform transform = params.transform("to_world", doc);
    const Matrix4d& m = transform.matrix();
    if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1) {
        params.error("to_world",
                     "\"to_world\" of a volume must be affine: the last row of its matrix must be "
                     "0 0 0 1");
        return {};
    }
    return transform;
}

/// A box in double.
struct Bounds3d {
    Vector3d min, max;
};

/// In double: what a point of a box finds is then bounded by what the box finds.
class VolumeSpace {
public:
    VolumeSpace() = default;
    /// `world_from_voxels` is affine.
    explicit VolumeSpace(const Transform& world_from_voxels)
        : world_from_voxels_(world_from_voxels), matrix_(world_from_voxels.inverse_matrix()) {}

    Vector3d point(Vector3 p) const {
        const Vector3d q(p);
        return {matrix_[0].x * q.x + matrix_[1].x * q.y + matrix_[2].x * q.z + matrix_[3].x,
                matrix_[0].y * q.x + matrix_[1].y * q.y + matrix_[2].y * q.z + matrix_[3].y,
                matrix_[0].z * q.x + matrix_[1].z * q.y + matrix_[2].z * q.z + matrix_[3].z};
    }

    /// Holds `point(p)`, as it is rounded, of every p of a finite box.
    Bounds3d box(const Bounds3& world) const {
        // Four products and sums, each rounded once in `point` and once here.
        constexpr double rounding = 16 * std::numeric_limits<double>::epsilon();
        Bounds3d result;
        for (int i = 0; i < 3; ++i) {
            double min = matrix_[3][i], max = min, size = std::abs(min);
            for (int k = 0; k < 3; ++k) {
                const double a = matrix_[k][i] * static_cast<double>(world.min[k]);
                const double b = matrix_[k][i] * static_cast<double>(world.max[k]);
                min += std::min(a, b);
                max += std::max(a, b);
                size += std::max(std::abs(a), std::abs(b));
            }
            result.min[i] = min - rounding * size;
            result.max[i] = max + rounding * size;
        }
        return result;
    }

    /// The box of the world that holds a box of voxels.
    Bounds3 world_bounds(const Bounds3& voxels) const { return world_from_voxels_.bounds(voxels); }

    /// Voxels that are crossed along each axis of the world by a box of this extent.
    Vector3 voxels_along(Vector3 extent) const {
        Vector3 count;
        for (int k = 0; k < 3; ++k) {
            const Vector3d step = absolute(Vector3d(matrix_[k]));
            const double per_length = std::max(step.x, std::max(step.y, step.z));
            count[k] = static_cast<float>(per_length * static_cast<double>(extent[k]));
        }
        return count;
    }

private:
    Transform world_from_voxels_;
    Matrix4d matrix_{1.0};  ///< voxels from world
};

/// At least one, and no more than an integer holds.
inline glm::ivec3 rounded_resolution(Vector3 voxels) {
    glm::ivec3 result;
    for (int k = 0; k < 3; ++k) {
        result[k] = static_cast<int>(std::lround(std::clamp(voxels[k], 1.0f, 0x1p30f)));
    }
    return result;
}

/// What two boxes share; empty if that is nothing.
inline Bounds3 intersection(const Bounds3& a, const Bounds3& b) {
    return {.min = glm::max(a.min, b.min), .max = glm::min(a.max, b.max)};
}

}  // namespace lucerna
