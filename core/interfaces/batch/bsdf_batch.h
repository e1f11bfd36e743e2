// SPDX-License-Identifier: Apache-2.0
/// What integrators ask of a BSDF at up to sixteen points at once.
///
/// One call through a pointer serves all lanes: `describe<T>` makes the loops of the functions that
/// T has for one point, in T's own library, where compilers inline them. If T has functions of the
/// same parameters with the names `evaluate_lanes` and `sample_lanes`, these are called instead.
///
/// Lanes after the last point hold numbers that are allowed, and their results mean nothing.
#pragma once

#include "core/interfaces/batch/lanes.h"

#include <optional>
#include <span>

namespace lucerna {

class BSDF;

struct BSDFBatch {
    /// The point of each lane, at most `lane_count`.
    using Points = std::span<const Interaction* const>;

    /// As BSDF::evaluate, in the lanes that are `wanted`.
    void (*evaluate)(const BSDF& bsdf, Points at, const LaneMask& wanted, const Vector3Lanes& wo,
                     const Vector3Lanes& wi, TransportMode mode, BSDFValueLanes& out);
    /// As BSDF::sample.
    void (*sample)(const BSDF& bsdf, Points at, const Vector3Lanes& wo, const FloatLanes& u_lobe,
                   const Vector2Lanes& u, TransportMode mode, BSDFSampleLanes& out);

    /// Called once for each object of a plugin's class T, by `describe<T>`.
    template <typename T>
    static void attach(T& object) {
        static constexpr BSDFBatch loops{.evaluate = evaluate_each<T>, .sample = sample_each<T>};
        object.batch_ = &loops;
    }

    /// BSDF::evaluate point by point.
    template <typename T>
    static void evaluate_one_by_one(const T& bsdf, Points at, const LaneMask& wanted,
                                    const Vector3Lanes& wo, const Vector3Lanes& wi,
                                    TransportMode mode, BSDFValueLanes& out) {
        for (std::size_t i = 0; i < at.size(); ++i) {
            if (wanted[i]) out.set(i, bsdf.evaluate(*at[i], wo[i], wi[i], mode));
        }
    }
    /// BSDF::sample point by point.
    template <typename T>
    static void sample_one_by_one(const T& bsdf, Points at, const Vector3Lanes& wo,
                                  const FloatLanes& u_lobe, const Vector2Lanes& u,
                                  TransportMode mode, BSDFSampleLanes& out) {
        for (std::size_t i = 0; i < at.size(); ++i) {
            const std::optional<BSDFSample> one = bsdf.sample(*at[i], wo[i], u_lobe[i], u[i], mode);
            out.lobe[i] = one ? one->lobe : Lobe::none;
            if (!one) continue;
            out.wi.set(i, one->wi);
            out.weight.set(i, one->weight);
        }
    }

private:
    template <typename T>
    static void evaluate_each(const BSDF& bsdf, Points at, const LaneMask& wanted,
                              const Vector3Lanes& wo, const Vector3Lanes& wi, TransportMode mode,
                              BSDFValueLanes& out) {
        const T& it = static_cast<const T&>(bsdf);
        if constexpr (requires { it.evaluate_lanes(at, wanted, wo, wi, mode, out); }) {
            it.evaluate_lanes(at, wanted, wo, wi, mode, out);
        } else {
            evaluate_one_by_one(it, at, wanted, wo, wi, mode, out);
        }
    }

    template <typename T>
    static void sample_each(const BSDF& bsdf, Points at, const Vector3Lanes& wo,
                            const FloatLanes& u_lobe, const Vector2Lanes& u, TransportMode mode,
                            BSDFSampleLanes& out) {
        const T& it = static_cast<const T&>(bsdf);
        if constexpr (requires { it.sample_lanes(at, wo, u_lobe, u, mode, out); }) {
            it.sample_lanes(at, wo, u_lobe, u, mode, out);
        } else {
            sample_one_by_one(it, at, wo, u_lobe, u, mode, out);
        }
    }
};

}  // namespace lucerna
