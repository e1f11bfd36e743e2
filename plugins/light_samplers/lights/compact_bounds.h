// SPDX-License-Identifier: Apache-2.0
/// Bounds of lights, rounded as pbrt stores them in 24 bytes (pbrt 4e, 12.6.3, CompactLightBounds):
/// boxes outwards to a grid of 2¹⁶ steps over all lights, axes to 16 bits per coordinate of an
/// octahedron (Meyer et al. 2010), cosines down to multiples of 2 / 32767.
#pragma once

#include "plugins/light_samplers/lights/light_tree.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

inline float compact_cosine(float c) {
    return 2 * (std::floor(32767.0f * std::max((c + 1) / 2, 0.0f)) / 32767.0f) - 1;
}

inline Vector3 compact_axis(Vector3 w) {
    const auto fold = [](Vector2 v) {
        return Vector2(std::copysign(1 - std::abs(v.y), v.x),
                       std::copysign(1 - std::abs(v.x), v.y));
    };
    const auto coordinate = [](float x) {
        return 2 * (std::round(65535.0f * std::clamp((x + 1) / 2, 0.0f, 1.0f)) / 65535.0f) - 1;
    };
    w /= std::abs(w.x) + std::abs(w.y) + std::abs(w.z);
    Vector2 v = w.z >= 0 ? Vector2(w.x, w.y) : fold({w.x, w.y});
    v = Vector2(coordinate(v.x), coordinate(v.y));
    const float z = 1 - std::abs(v.x) - std::abs(v.y);
    if (z < 0) v = fold(v);
    return glm::normalize(Vector3(v.x, v.y, z));
}

/// Nearest steps of the grid around a box in `all`.
inline Bounds3 compact_box(const Bounds3& box, const Bounds3& all) {
    Bounds3 result = box;
    for (int axis = 0; axis < 3; ++axis) {
        const float low = all.min[axis], high = all.max[axis];
        if (!(high > low)) continue;
        const auto step = [&](float x) {
            return std::clamp(65535.0f * ((x - low) / (high - low)), 0.0f, 65535.0f);
        };
        const auto place = [&](float x) {
            const float t = x / 65535.0f;
            return (1 - t) * low + t * high;
        };
        result.min[axis] = place(std::floor(step(box.min[axis])));
        result.max[axis] = place(std::ceil(step(box.max[axis])));
    }
    return result;
}

/// A cluster as it is stored in a tree over lights in the box `all`.
inline LightCluster compact(const LightCluster& cluster, const Bounds3& all) {
    LightCluster result = cluster;
    result.box = compact_box(cluster.box, all);
    result.axis = compact_axis(cluster.axis);
    result.cos_normals = compact_cosine(cluster.cos_normals);
    result.cos_emission = compact_cosine(cluster.cos_emission);
    return result;
}

}  // namespace lucerna
