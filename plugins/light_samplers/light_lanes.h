// SPDX-License-Identifier: Apache-2.0
/// What lights contribute to a point where nothing is in between: eight at once.
///
/// A light or cluster of intensity I and normal cone θo in a box of half extents e around c, seen
/// from x along d = c − x, causes about
///
///   I cos θ' cos θi / max(|d|², |e|²/2),   cos θi = max(d·ns / |d|, (d·n + |n|·e) / 4 |d|),
///   θ' = max(0, angle(axis, −d) − θo − θb),   θb: subtended by the sphere around the box
///
/// and where all normals are one, cos θ' is also at most the cosine to the plane of the emitters.
/// It is zero only where nothing can arrive: all of the box is below the horizon of the receiver,
/// the receiver is behind the plane, or beyond the cone of emission. I is the flux divided by
/// M_Ω (light_tree.h), for a planar emitter Φ / π, so that a single light's figure is its
/// irradiance; no figure knows of shadows.
#pragma once

#include "core/scene/scene.h"
#include "plugins/emitters/scene_sphere.h"
#include "plugins/light_samplers/light_tree.h"

namespace lucerna {

/// A receiver, as lights see it. With `slack` it stands for all points and with `spread` for all
/// normals of a region: its radius, and the sine of the largest angle to the normal.
struct LitPoint {
    Vector3 p{0}, n{0}, ns{0};
    float two_sided = 0;  ///< 1: light arrives at both sides
    float slack = 0;
    float spread = 0;

    LitPoint() = default;
    explicit LitPoint(const Receiver& at) : p(at.p), n(at.n), ns(at.ns), slack(4 * at.error) {
        if (at.sides == Sides::both) two_sided = 1;
        if (at.sides == Sides::back) n = -n, ns = -ns;
    }
};

/// Eight lights or clusters, one array for each number.
struct alignas(32) LightLanes {
    static constexpr std::size_t width = 8;
    using Lanes = float[width];
    Lanes cx{}, cy{}, cz{}, ex{}, ey{}, ez{}, ax{}, ay{}, az{};
    Lanes cos_o{}, sin_o{}, cos_e{};
    Lanes facing{};  ///< how far the emitters' plane is in front of c; infinite if they have none
    Lanes two_sided{};  ///< 1: they shine to both sides
    Lanes intensity{};  ///< zero: an empty lane

    /// Fills a lane. `facing` as above, or -1 to bound it by the box.
    void set(std::size_t lane, const LightCluster& cluster, float facing);
    void copy(std::size_t lane, const LightLanes& from, std::size_t from_lane);
};

/// All eight contributions.
void contributions(const LightLanes& lights, const LitPoint& at, float* result);

inline bool is_flat(const LightCluster& c) {
    return c.cos_normals >= 1 - 1e-6f && c.cos_emission >= -1e-4f && !c.two_sided;
}

inline void LightLanes::set(std::size_t i, const LightCluster& c, float plane) {
    const Vector3 center = c.box.center();
    // Boxes grow by the rounding of their coordinates.
    const Vector3 half = glm::max(c.box.max - center, center - c.box.min) +
                         Vector3(0x1p-21f * max_component(glm::abs(center)));
    cx[i] = center.x, cy[i] = center.y, cz[i] = center.z;
    ex[i] = half.x, ey[i] = half.y, ez[i] = half.z;
    ax[i] = c.axis.x, ay[i] = c.axis.y, az[i] = c.axis.z;
    cos_o[i] = c.cos_normals;
    sin_o[i] = safe_sqrt(1 - sqr(c.cos_normals));
    cos_e[i] = c.cos_emission;
    two_sided[i] = c.two_sided ? 1.0f : 0.0f;
    intensity[i] = c.power;
    facing[i] = !is_flat(c) ? infinity : plane >= 0 ? plane : glm::dot(glm::abs(c.axis), half);
}

inline void LightLanes::copy(std::size_t i, const LightLanes& o, std::size_t k) {
    cx[i] = o.cx[k], cy[i] = o.cy[k], cz[i] = o.cz[k];
    ex[i] = o.ex[k], ey[i] = o.ey[k], ez[i] = o.ez[k];
    ax[i] = o.ax[k], ay[i] = o.ay[k], az[i] = o.az[k];
    cos_o[i] = o.cos_o[k], sin_o[i] = o.sin_o[k], cos_e[i] = o.cos_e[k];
    facing[i] = o.facing[k], two_sided[i] = o.two_sided[k], intensity[i] = o.intensity[k];
}

inline void contributions(const LightLanes& l, const LitPoint& at, float* __restrict result) {
    const Vector3 p = at.p, n = at.n, ns = at.ns, abs_n = glm::abs(n);
    const float two_sided = at.two_sided, slack = at.slack, spread = at.spread;
    // The largest of the second and the first, or minus the first if both sides count.
    const auto sided = [](float x, float both) { return std::max(x, both * -x); };
    for (std::size_t i = 0; i < LightLanes::width; ++i) {
        const float dx = l.cx[i] - p.x, dy = l.cy[i] - p.y, dz = l.cz[i] - p.z;
        const float ex = l.ex[i] + slack, ey = l.ey[i] + slack, ez = l.ez[i] + slack;
        const float d2 = std::max(dx * dx + dy * dy + dz * dz, 1e-30f);
        const float r2 = ex * ex + ey * ey + ez * ez;
        const float inverse = 1 / std::sqrt(d2);
        const float distance = d2 * inverse;
        const float near2 = std::max(d2, 0.5f * r2);

        const float dn = sided(dx * n.x + dy * n.y + dz * n.z, two_sided);
        const float extent = abs_n.x * ex + abs_n.y * ey + abs_n.z * ez;
        const float above = dn + extent + (spread + 1e-5f) * distance;
        const float dns = sided(dx * ns.x + dy * ns.y + dz * ns.z, two_sided) + spread * distance;
        const float cos_i = std::min(std::max(dns, 0.25f * above) / std::sqrt(near2), 1.0f);

        const float height = sided(-(dx * l.ax[i] + dy * l.ay[i] + dz * l.az[i]), l.two_sided[i]);
        const float in_front = height + l.facing[i] + slack + 1e-6f * distance;
        const float cos_w = std::min(height * inverse, 1.0f);
        const float sin_w = std::sqrt(std::max(1 - cos_w * cos_w, 0.0f));
        const float cos_o = l.cos_o[i], sin_o = l.sin_o[i];
        const bool in_cone = cos_w > cos_o;
        const float cos_x = in_cone ? 1.0f : cos_w * cos_o + sin_w * sin_o;
        const float sin_x = in_cone ? 0.0f : sin_w * cos_o - cos_w * sin_o;
        const float sin_b = std::min(std::sqrt(r2) * inverse, 1.0f);
        const float cos_b = r2 >= d2 ? -1.0f : std::sqrt(std::max(1 - sin_b * sin_b, 0.0f));
        const float cos_emitted = cos_x > cos_b ? 1.0f : cos_x * cos_b + sin_x * sin_b;
        const float emitted = std::max(std::min(cos_emitted, in_front * inverse), 1e-5f);

        const float value = l.intensity[i] * emitted * cos_i / near2;
        const bool possible = (above > 0) & (in_front > 0) & (cos_emitted > l.cos_e[i]);
        result[i] = possible ? value : 0.0f;
    }
}

/// The lights of the scene that shine, in the form that samplers need. The unit of intensity is
/// that of the strongest of those that are somewhere.
struct LightList {
    std::vector<TreeLight> finite;  ///< with intensities for powers
    std::vector<float> facing;      ///< of each of `finite`
    std::vector<std::uint32_t> infinite;
    std::vector<double> irradiance;  ///< of each of `infinite`, facing it, in units
    double unit = 0;                 ///< [W/sr]

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
        4 * at.error + 1e-4f * cluster.box.radius() + 0x1p-21f * max_component(glm::abs(center));
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
        infinite.push_back(i);
        irradiance.push_back((light.emitter->delta() ? 1 : 0.25) * bounds.power / area);
    }
    if (!(unit > 0)) unit = 1;
    for (double& e : irradiance) e /= unit;
    for (TreeLight& light : finite) {
        const double power = static_cast<double>(light.cluster.power) / unit;
        light.cluster.power = static_cast<float>(std::max(power, 1e-25));
    }
}

}  // namespace lucerna
