// SPDX-License-Identifier: Apache-2.0
/// The sphere around the scene, through which lights at infinity shine.
#pragma once

#include "core/math/warp.h"
#include "core/scene/scene.h"

namespace lucerna {

struct SceneSphere {
    Vector3 center{0};
    float radius = 1;

    SceneSphere() = default;
    /// A little larger than the scene, so that rays start outside in spite of rounding.
    explicit SceneSphere(const Scene& scene) : center(scene.bounds().center()) {
        const float exact = scene.bounds().radius();
        if (exact > 0) radius = 1.0001f * exact;
    }

    /// Area of the disk through the center [m²].
    float cross_section() const { return pi * radius * radius; }

    /// Where a ray of direction `d` starts: uniform by area on the disk that touches the sphere
    /// and is perpendicular to d.
    Vector3 ray_origin(Vector3 d, Vector2 u) const {
        const Vector2 p = square_to_uniform_disk(u);
        return center + radius * Frame::from_normal(d).to_world({p.x, p.y, -1});
    }
};

}  // namespace lucerna
