// SPDX-License-Identifier: Apache-2.0
/// The lights of a scene, as light trees and lanes take them.
#pragma once

#include "core/scene/scene.h"
#include "plugins/emitters/scene_sphere.h"
#include "plugins/light_samplers/lights/infinite_lanes.h"

namespace lucerna {

/// The lights of the scene that shine, in the form that samplers need. The unit of intensity is
/// that of the strongest of those that are somewhere.
struct LightList {
    std::vector<TreeLight> finite;  ///< with intensities for powers
    std::vector<float> facing;      ///< of each of `finite`
    std::vector<std::uint32_t> infinite;
    std::vector<double> irradiance;             ///< of each of `infinite`, facing it, in units
    std::vector<InfiniteLanes> infinite_lanes;  ///< of `infinite`, in units
    double unit = 0;                            ///< [W/sr]

    explicit LightList(const Scene& scene);

private:
    void add(const Light& light, std::uint32_t index, const LightBounds& bounds);
};

/// Where the plane of a planar emitter is, seen from the centre of its box along the normal.
inline float plane_of(const Light& light, const LightCluster& cluster) {
    if (!is_flat(cluster)) return infinity;
    if (!light.shape) return 0;
    const Vector3 center = cluster.box.center();
    const SurfaceSample at = light.shape->sample_area(light.primitive, Vector2(0.5f));
    const float rounding =
        4 * at.error + 1e-4f * cluster.box.radius() + 0x1p-21f * max_component(absolute(center));
    return glm::dot(center - at.p, cluster.axis) + rounding;
}

inline void LightList::add(const Light& light, std::uint32_t index, const LightBounds& bounds) {
    const float cos_normals = std::clamp(bounds.cos_normals, -1.0f, 1.0f);
    const float measure = emission_measure(cos_normals, bounds.cos_emission);
    const double sides = bounds.two_sided ? 2 : 1;
    const double intensity = bounds.power / (sides * std::max(static_cast<double>(measure), 1e-9));
    unit = std::max(unit, intensity);
    finite.push_back({.cluster = {.box = bounds.box,
                                  .axis = bounds.axis,
                                  .cos_normals = cos_normals,
                                  .cos_emission = bounds.cos_emission - 1e-5f,
                                  .power = static_cast<float>(std::min(intensity, 1e30)),
                                  .two_sided = bounds.two_sided},
                      .light = index});
    facing.push_back(plane_of(light, finite.back().cluster));
}

inline LightList::LightList(const Scene& scene) {
    const double area = static_cast<double>(SceneSphere(scene).cross_section());
    for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
        const Light& light = scene.lights()[i];
        const LightBounds bounds = light.emitter->bounds(light);
        if (!(bounds.power > 0)) continue;
        if (!light.emitter->infinite()) {
            add(light, i, bounds);
            continue;
        }
        // An environment as if it were the same everywhere; a direction from where it comes.
        const std::size_t lane = infinite.size() % InfiniteLanes::width;
        if (lane == 0) infinite_lanes.emplace_back();
        infinite_lanes.back().set(lane, bounds.directions, static_cast<float>(bounds.power / area));
        infinite.push_back(i);
        irradiance.push_back((light.emitter->delta() ? 1 : 0.25) * bounds.power / area);
    }
    if (!(unit > 0)) unit = 1;
    for (double& e : irradiance) e /= unit;
    for (InfiniteLanes& lanes : infinite_lanes) {
        for (float& e : lanes.irradiance) e = static_cast<float>(static_cast<double>(e) / unit);
    }
    for (TreeLight& light : finite) {
        const double power = static_cast<double>(light.cluster.power) / unit;
        light.cluster.power = static_cast<float>(std::max(power, 1e-25));
    }
}

}  // namespace lucerna
