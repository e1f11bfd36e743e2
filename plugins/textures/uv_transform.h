// SPDX-License-Identifier: Apache-2.0
/// The parameter `to_uv` of textures.
#pragma once

#include "core/math/transform.h"

namespace lucerna {

/// An affine map of surface parameters, applied to (u, 1 − v): in Mitsuba v counts downwards on
/// meshes, here upwards. A 3×3 matrix moves by its third column, as in Mitsuba; a `<translate>` by
/// the fourth column of the 4×4 matrix that it makes. Both count.
class UVTransform {
public:
    explicit UVTransform(const Transform& transform) {
        const Matrix4d& m = transform.matrix();
        along_u_ = Vector2(m[0]);
        along_v_ = -Vector2(m[1]);
        offset_ = Vector2(Vector2d(m[1]) + Vector2d(m[2]) + Vector2d(m[3]));
    }

    Vector2 operator()(Vector2 uv) const { return uv.x * along_u_ + uv.y * along_v_ + offset_; }
    /// The derivatives by u and v of a function of the mapped point that has this gradient there.
    Vector2 pull_back(Vector2 gradient) const {
        return {glm::dot(along_u_, gradient), glm::dot(along_v_, gradient)};
    }

private:
    Vector2 along_u_, along_v_, offset_;
};

}  // namespace lucerna
