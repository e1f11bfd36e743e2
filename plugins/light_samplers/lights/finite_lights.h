// SPDX-License-Identifier: Apache-2.0
/// The lights of a scene that are somewhere, as light trees and lanes take them.
#pragma once

#include "core/scene/scene.h"
#include "plugins/light_samplers/lights/light_lanes.h"
#include "plugins/light_samplers/lights/light_tree.h"

namespace lucerna {

/// Fills a lane with a cluster whose power is its intensity.
inline void set_lane(LightLanes& lanes, std::size_t i, const LightCluster& c) {
    const Vector3 center = c.box.center();
    // Boxes grow by the rounding of their coordinates.
    const Vector3 half = glm::max(c.box.max - center, center - c.box.min) +
                         Vector3(0x1p-21f * max_component(absolute(center)));
    lanes.cx[i] = center.x, lanes.cy[i] = center.y, lanes.cz[i] = center.z;
    lanes.ex[i] = half.x, lanes.ey[i] = half.y, lanes.ez[i] = half.z;
    lanes.ax[i] = c.axis.x, lanes.ay[i] = c.axis.y, lanes.az[i] = c.axis.z;
    lanes.cos_o[i] = c.cos_normals;
    lanes.sin_o[i] = safe_sqrt(1 - sqr(c.cos_normals));
    lanes.cos_e[i] = c.cos_emission;
    lanes.two_sided[i] = c.two_sided ? 1.0f : 0.0f;
    lanes.intensity[i] = c.power;
    const float plane = c.plane >= 0 ? c.plane : glm::dot(absolute(c.axis), half);
    lanes.facing[i] = c.is_flat() ? plane : infinity;
}

/// Those that shine, with intensities for powers.
struct FiniteLights {
    std::vector<TreeLight> lights;
    /// What intensities are relative to: that of the strongest light [W/sr]. Irradiance that counts
    /// as 1.
    double unit = 1;

    explicit FiniteLights(const Scene& scene);
};

/// Where the plane of a planar emitter is, seen from the centre of its box along the normal.
inline float plane_of(const Light& light, const LightCluster& cluster) {
    if (!cluster.is_flat()) return infinity;
    if (!light.shape) return 0;
    const Vector3 center = cluster.box.center();
    const SurfaceSample at = light.shape->sample_area(light.primitive, Vector2(0.5f));
    const float rounding =
        4 * at.error + 1e-4f * cluster.box.radius() + 0x1p-21f * max_component(absolute(center));
    return glm::dot(center - at.p, cluster.axis) + rounding;
}

inline FiniteLights::FiniteLights(const Scene& scene) {
    double largest = 0;
    for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
        const Light& light = scene.lights()[i];
        if (light.emitter->infinite()) continue;
        const LightBounds bounds = light.emitter->bounds(light);
        if (!(bounds.power > 0)) continue;
        const float cos_normals = std::clamp(bounds.cos_normals, -1.0f, 1.0f);
        const float measure = emission_measure(cos_normals, bounds.cos_emission);
        const double sides = bounds.two_sided ? 2 : 1;
        const double intensity =
            bounds.power / (sides * std::max(static_cast<double>(measure), 1e-9));
        largest = std::max(largest, intensity);
        lights.push_back({.cluster = {.box = bounds.box,
                                      .axis = bounds.axis,
                                      .cos_normals = cos_normals,
                                      .cos_emission = bounds.cos_emission - 1e-5f,
                                      .power = static_cast<float>(std::min(intensity, 1e30)),
                                      .two_sided = bounds.two_sided},
                          .light = i});
        lights.back().cluster.plane = plane_of(light, lights.back().cluster);
    }
    if (largest > 0) unit = largest;
    for (auto& [cluster, light] : lights) {
        const double power = static_cast<double>(cluster.power) / unit;
        cluster.power = cluster.strongest = static_cast<float>(std::max(power, 1e-25));
    }
}

}  // namespace lucerna
