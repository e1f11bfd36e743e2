// SPDX-License-Identifier: Apache-2.0
/// What lights at infinity contribute to a point where nothing is in between, eight at once.
///
/// A light whose directions lie in a box of half extents e around c, and that causes the irradiance
/// E on a surface that faces it, causes about
///
///   E max(c·ns, (c·n + |n|·e) / 4)
///
/// on a surface of geometric normal n and shading normal ns: zero only if all of the box is below
/// the horizon.
#pragma once

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

}  // namespace lucerna
