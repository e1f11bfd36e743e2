// SPDX-License-Identifier: Apache-2.0
/// What lights contribute to a point where nothing is in between, eight at once.
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

#include "core/interfaces/interaction.h"

#include <span>

namespace lucerna {

/// A spread with which every cosine at the receiver is 1.
inline constexpr float facing_spread = 4;

/// A receiver, as lights see it; one in a medium faces all of them. With `slack` it stands for all
/// points and with `spread` for all normals of a region: its radius, and the sine of the largest
/// angle to the normal.
struct ReceiverRegion {
    Vector3 p{0}, n{0}, ns{0};
    float two_sided = 0;  ///< 1: light arrives at both sides
    float slack = 0;
    float spread = 0;

    ReceiverRegion() = default;
    explicit ReceiverRegion(const Receiver& at) : p(at.p), n(at.n), ns(at.ns), slack(4 * at.error) {
        if (at.sides == Sides::both) two_sided = 1;
        if (at.sides == Sides::back) n = -n, ns = -ns;
        if (!at.has_normal()) spread = facing_spread;
    }
};

/// Eight planar lights that shine to one side, as most do, one array for each number.
struct alignas(32) FlatLanes {
    static constexpr std::size_t width = 8;
    using Lanes = float[width];
    Lanes cx{}, cy{}, cz{}, ex{}, ey{}, ez{}, ax{}, ay{}, az{};
    Lanes facing{};     ///< how far the emitters' plane is in front of c; infinite if there is none
    Lanes intensity{};  ///< zero: an empty lane

    void copy(std::size_t lane, const FlatLanes& from, std::size_t from_lane);
};

/// Eight lights or clusters of any kind.
struct alignas(32) LightLanes : FlatLanes {
    Lanes cos_o{}, sin_o{}, cos_e{};
    Lanes two_sided{};  ///< 1: they shine to both sides

    /// Sum of the numbers of eight lanes.
    static float sum(const float* w) {
        return ((w[0] + w[1]) + (w[2] + w[3])) + ((w[4] + w[5]) + (w[6] + w[7]));
    }
    void copy(std::size_t lane, const LightLanes& from, std::size_t from_lane);
    /// Whether FlatLanes can hold it: planar, and shining to the whole of one side.
    bool is_planar(std::size_t lane) const {
        return facing[lane] < infinity && cos_e[lane] <= 1e-3f;
    }
};

inline void FlatLanes::copy(std::size_t i, const FlatLanes& o, std::size_t k) {
    cx[i] = o.cx[k], cy[i] = o.cy[k], cz[i] = o.cz[k];
    ex[i] = o.ex[k], ey[i] = o.ey[k], ez[i] = o.ez[k];
    ax[i] = o.ax[k], ay[i] = o.ay[k], az[i] = o.az[k];
    facing[i] = o.facing[k], intensity[i] = o.intensity[k];
}

inline void LightLanes::copy(std::size_t i, const LightLanes& o, std::size_t k) {
    FlatLanes::copy(i, o, k);
    cos_o[i] = o.cos_o[k], sin_o[i] = o.sin_o[k], cos_e[i] = o.cos_e[k];
    two_sided[i] = o.two_sided[k];
}

namespace light_lanes {

/// x, or |x| if both sides count.
[[gnu::always_inline]] inline float sided(float x, float both) {
    return std::max(x, (1 - 2 * both) * x);
}

/// The contribution of one lane. Always inline: the loops around it are compiled for more than one
/// instruction set.
template <typename Lights>
[[gnu::always_inline]] inline float contribution(const Lights& l, std::size_t i,
                                                 const ReceiverRegion& at, Vector3 abs_n) {
    constexpr bool flat = std::is_same_v<Lights, FlatLanes>;
    const float dx = l.cx[i] - at.p.x, dy = l.cy[i] - at.p.y, dz = l.cz[i] - at.p.z;
    const float ex = l.ex[i] + at.slack, ey = l.ey[i] + at.slack, ez = l.ez[i] + at.slack;
    const float d2 = std::max(dx * dx + dy * dy + dz * dz, 1e-30f);
    const float r2 = ex * ex + ey * ey + ez * ez;
    const float inverse = 1 / std::sqrt(d2);
    const float distance = d2 * inverse;
    const float inverse_near = 1 / std::sqrt(std::max(d2, 0.5f * r2));

    const float dn = sided(dx * at.n.x + dy * at.n.y + dz * at.n.z, at.two_sided);
    const float extent = abs_n.x * ex + abs_n.y * ey + abs_n.z * ez;
    const float above = dn + extent + (at.spread + 1e-5f) * distance;
    const float dns =
        sided(dx * at.ns.x + dy * at.ns.y + dz * at.ns.z, at.two_sided) + at.spread * distance;
    const float cos_i = std::min(std::max(dns, 0.25f * above) * inverse_near, 1.0f);

    const float toward = -(dx * l.ax[i] + dy * l.ay[i] + dz * l.az[i]);
    bool possible = above > 0;
    float emitted;
    if constexpr (flat) {
        const float in_front = toward + l.facing[i] + at.slack + 1e-6f * distance;
        emitted = std::min(std::max(in_front * inverse, 1e-5f), 1.0f);
        possible = possible & (in_front > 0);
    } else {
        const float height = sided(toward, l.two_sided[i]);
        const float in_front = height + l.facing[i] + at.slack + 1e-6f * distance;
        const float cos_w = std::min(height * inverse, 1.0f);
        const float sin_w = std::sqrt(std::max(1 - cos_w * cos_w, 0.0f));
        const float cos_o = l.cos_o[i], sin_o = l.sin_o[i];
        const bool in_cone = cos_w > cos_o;
        const float cos_x = in_cone ? 1.0f : cos_w * cos_o + sin_w * sin_o;
        const float sin_x = in_cone ? 0.0f : sin_w * cos_o - cos_w * sin_o;
        const float sin_b = std::min(std::sqrt(r2) * inverse, 1.0f);
        const float cos_b = r2 >= d2 ? -1.0f : std::sqrt(std::max(1 - sin_b * sin_b, 0.0f));
        const float cos_emitted = cos_x > cos_b ? 1.0f : cos_x * cos_b + sin_x * sin_b;
        emitted = std::max(std::min(cos_emitted, in_front * inverse), 1e-5f);
        possible = possible & (in_front > 0) & (cos_emitted > l.cos_e[i]);
    }
    const float value = l.intensity[i] * emitted * cos_i * (inverse_near * inverse_near);
    return possible ? value : 0.0f;
}

template <typename Lights>
[[gnu::always_inline]] inline void contributions(const Lights* lights, std::size_t blocks,
                                                 const ReceiverRegion& at,
                                                 float* __restrict result) {
    const ReceiverRegion local = at;  // which `result` cannot overlap
    const Vector3 abs_n = absolute(local.n);
    for (std::size_t b = 0; b < blocks; ++b) {
        for (std::size_t i = 0; i < LightLanes::width; ++i) {
            result[LightLanes::width * b + i] = contribution(lights[b], i, local, abs_n);
        }
    }
}

#if defined(__x86_64__)
/// The same operations on the same numbers, in registers of eight: the same bits.
template <typename Lights>
[[gnu::target("avx2")]] void contributions_avx2(const Lights* lights, std::size_t blocks,
                                                const ReceiverRegion& at,
                                                float* __restrict result) {
    contributions(lights, blocks, at, result);
}
inline const bool has_avx2 = __builtin_cpu_supports("avx2");
#endif

}  // namespace light_lanes

/// The contributions of all lanes of some blocks of lights, to `result` in their order.
template <typename Lights>
void contributions(std::span<const Lights> lights, const ReceiverRegion& at,
                   float* __restrict result) {
#if defined(__x86_64__)
    if (light_lanes::has_avx2) {
        light_lanes::contributions_avx2(lights.data(), lights.size(), at, result);
        return;
    }
#endif
    light_lanes::contributions(lights.data(), lights.size(), at, result);
}
inline void contributions(const LightLanes& lights, const ReceiverRegion& at,
                          float* __restrict result) {
    contributions(std::span(&lights, 1), at, result);
}

}  // namespace lucerna
