// SPDX-License-Identifier: Apache-2.0
/// Axis-aligned boxes.
#pragma once

#include "core/math/vector.h"

namespace lucerna {

/// Closed axis-aligned box; empty (min > max) when default constructed.
struct Bounds3 {
    Vector3 min{infinity}, max{-infinity};

    bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
    Vector3 center() const { return 0.5f * min + 0.5f * max; }
    Vector3 extent() const { return max - min; }
    /// Radius of the sphere around `center` that holds the box.
    float radius() const { return empty() ? 0.0f : 0.5f * glm::length(extent()); }

    void include(Vector3 p) {
        min = glm::min(min, p);
        max = glm::max(max, p);
    }
    void include(const Bounds3& b) {
        min = glm::min(min, b.min);
        max = glm::max(max, b.max);
    }
    bool contains(Vector3 p) const {
        return glm::all(glm::lessThanEqual(min, p)) && glm::all(glm::lessThanEqual(p, max));
    }
};

}  // namespace lucerna
