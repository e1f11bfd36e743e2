// SPDX-License-Identifier: Apache-2.0
/// Photons that one material scatters together.
#pragma once

#include "core/base/vectorized.h"
#include "core/interfaces/batch/lanes.h"
#include "core/math/select.h"

namespace lucerna {

/// What becomes of photons where they have met a surface, but for what only the material knows.
struct ScatteringLanes {
    // What arrives with the photons. Lanes without one keep what others have left there.
    Vector3Lanes d{}, power{};
    Vector3Lanes s{}, t{}, ns{};  ///< frame of the shading normal
    Vector3Lanes n{}, p{};
    FloatLanes error{};
    FloatLanes u_lobe{}, u_survival{}, most_survival{};
    Vector2Lanes u_direction{};

    Vector3Lanes wo{};       ///< back to where they came from, local: set by `look_back`
    BSDFSampleLanes next{};  ///< where they go, local: what the material says

    // Set by `scatter`, for photons that leave.
    Vector3Lanes o{}, wi{}, left{};    ///< ray in the world, and power
    FloatLanes arriving{}, leaving{};  ///< luminance of the power; zero if a photon ends here
    FloatLanes through{};              ///< 1: nothing was here
    FloatLanes broken{};               ///< 1: its power is not finite

    void set(std::size_t i, const Interaction& at, Vector3 direction, Color arriving_power) {
        d.set(i, direction);
        power.set(i, arriving_power);
        s.set(i, at.shading.s);
        t.set(i, at.shading.t);
        ns.set(i, at.shading.n);
        n.set(i, at.n);
        p.set(i, at.p);
        error[i] = at.error;
    }

    /// For the first `count` lanes.
    LUCERNA_VECTORIZED_INLINE void look_back(std::size_t count) {
        for (std::size_t begin = 0; begin < count; begin += step) {
            for (std::size_t k = 0; k < step; ++k) {
                const std::size_t i = begin + k;
                wo.set(i, Frame{s[i], t[i], ns[i]}.to_local(-d[i]));
            }
        }
    }

    /// For the first `count` lanes. Flux is scattered by the adjoint BSDF, which shading normals
    /// make differ from f by the ratio of the cosines (Veach 1997, 5.3.2). Roulette lets photons
    /// survive in proportion to what is left, which keeps the power of all alike, unless
    /// `most_survival` is more than one.
    LUCERNA_VECTORIZED_INLINE void scatter(std::size_t count) {
        for (std::size_t i = 0; i < lane_count; ++i) {
            through[i] = next.lobe[i] == Lobe::null ? 1.0f : 0.0f;
            lit[i] = next.lobe[i] == Lobe::none ? 0.0f : 1.0f;
        }
        for (std::size_t begin = 0; begin < count; begin += step) {
            for (std::size_t k = 0; k < step; ++k) {
                const std::size_t i = begin + k;
                const Vector3 from = d[i], normal = n[i], shading = ns[i];
                const bool straight = through[i] > 0, scattered = lit[i] > 0;
                const Vector3 turned = Frame{s[i], t[i], shading}.to_world(next.wi[i]);
                const Vector3 w(select(straight, from.x, turned.x),
                                select(straight, from.y, turned.y),
                                select(straight, from.z, turned.z));
                const float wo_z = wo.z[i], wi_z = next.wi.z[i];
                const float wo_n = -glm::dot(from, normal), wi_n = glm::dot(w, normal);
                const bool comes_above = wo_n * wo_z > 0, leaves_above = wi_n * wi_z > 0;
                const bool possible = scattered & (straight | (comes_above & leaves_above));
                const Vector3 bend = absolute(shading - normal);
                const bool adjoint_differs = !straight & (bend.x + bend.y + bend.z > 0);
                const float adjoint = select(adjoint_differs, (wo_z * wi_n) / (wo_n * wi_z), 1.0f);
                const Color before = power[i], after = before * next.weight[i] * adjoint;
                // A power that is not finite makes a difference that is none.
                const Vector3 nothing = after - after;
                const bool finite = nothing.x + nothing.y + nothing.z == 0;
                const float most = most_survival[i], u = u_survival[i];
                const bool roulette = most <= 1;
                const float survival = std::min(max_component(after) / max_component(before), most);
                const bool survives = possible & (!roulette | (u < survival));
                const Color rest = after * select(roulette, 1 / survival, 1.0f);
                left.set(i, rest);
                wi.set(i, w);
                o.set(i, offset_ray_origin(p[i], error[i], normal, w));
                arriving[i] = luminance(before);
                leaving[i] = select(survives, luminance(rest), 0.0f);
                broken[i] = select(possible & !finite, 1.0f, 0.0f);
            }
        }
    }

private:
    static constexpr std::size_t step = 8;

    FloatLanes lit{};  ///< 1: something is scattered
};

}  // namespace lucerna
