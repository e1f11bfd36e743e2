// SPDX-License-Identifier: Apache-2.0
/// Lights at infinity: environments, of which each patch is a light, and directions.
///
/// A light whose directions lie in a box of half extents e around c, and that causes the irradiance
/// E on a surface that faces it, causes about
///
///   E max(c·ns, (c·n + |n|·e) / 4)
///
/// on a surface of geometric normal n and shading normal ns: zero only if all of the box is below
/// the horizon.
#pragma once

#include "core/math/distribution.h"
#include "core/scene/scene.h"
#include "plugins/emitters/scene_sphere.h"
#include "plugins/light_samplers/lights/light_lanes.h"

namespace lucerna {

/// Eight lights at infinity, one array for each number.
struct alignas(32) InfiniteLanes {
    static constexpr std::size_t width = LightLanes::width;
    using Lanes = LightLanes::Lanes;
    Lanes cx{}, cy{}, cz{}, ex{}, ey{}, ez{};
    Lanes irradiance{};  ///< zero: an empty lane

    void set(std::size_t i, const Bounds3& directions, float facing) {
        const Vector3 c = directions.center(), e = directions.max - c;
        cx[i] = c.x, cy[i] = c.y, cz[i] = c.z;
        ex[i] = e.x, ey[i] = e.y, ez[i] = e.z;
        irradiance[i] = facing;
    }
};

/// The contribution of one lane, for `contributions`.
[[gnu::always_inline]] inline float contribution(const InfiniteLanes& l, std::size_t i,
                                                 const ReceiverRegion& at, Vector3 abs_n) {
    using light_lanes::sided;
    const float x = l.cx[i], y = l.cy[i], z = l.cz[i];
    const float extent = abs_n.x * l.ex[i] + abs_n.y * l.ey[i] + abs_n.z * l.ez[i];
    const float dn = sided(x * at.n.x + y * at.n.y + z * at.n.z, at.two_sided);
    const float dns = sided(x * at.ns.x + y * at.ns.y + z * at.ns.z, at.two_sided);
    const float spread = std::min(at.spread, 1.0f);
    const float above = dn + extent + spread + 1e-5f;
    const float value = l.irradiance[i] * std::max(dns + spread, 0.25f * above);
    return above > 0 ? value : 0.0f;
}

/// Those of a scene that shine. Irradiance is in units of FiniteLights::unit.
struct InfiniteLights {
    std::vector<std::uint32_t> lights;  ///< of the scene, in ascending order
    std::vector<InfiniteLanes> lanes;   ///< the same, in their order
    std::size_t emitters = 0;           ///< whose lights they are
    /// Of each, what it causes on a surface that faces it, and in proportion to that a choice.
    std::vector<double> irradiance;
    DiscreteDistribution by_irradiance;

    InfiniteLights() = default;
    InfiniteLights(const Scene& scene, double unit);

    std::size_t size() const { return lights.size(); }
    /// Of the light at a place of the list, the irradiance if it came from one direction.
    float facing_irradiance(std::size_t i) const {
        constexpr std::size_t width = InfiniteLanes::width;
        return lanes[i / width].irradiance[i % width];
    }
    /// The place of a light of the scene in the list, if it is there.
    std::optional<std::uint32_t> place_of(std::uint32_t light) const {
        const auto found = std::lower_bound(lights.begin(), lights.end(), light);
        if (found == lights.end() || *found != light) return {};
        return static_cast<std::uint32_t>(found - lights.begin());
    }
};

inline InfiniteLights::InfiniteLights(const Scene& scene, double unit) {
    const double area = static_cast<double>(SceneSphere(scene).cross_section());
    const Emitter* last = nullptr;
    for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
        const Light& light = scene.lights()[i];
        if (!light.emitter->infinite()) continue;
        const LightBounds bounds = light.emitter->bounds(light);
        if (!(bounds.power > 0)) continue;
        const std::size_t lane = lights.size() % InfiniteLanes::width;
        if (lane == 0) lanes.emplace_back();
        const auto facing = static_cast<float>(bounds.power / area);
        lanes.back().set(lane, bounds.directions,
                         static_cast<float>(static_cast<double>(facing) / unit));
        lights.push_back(i);
        // An environment as if it were the same everywhere; a direction from where it comes.
        irradiance.push_back((light.emitter->delta() ? 1 : 0.25) * bounds.power / area / unit);
        emitters += light.emitter != last;
        last = light.emitter;
    }
    by_irradiance = DiscreteDistribution(irradiance);
}

}  // namespace lucerna
