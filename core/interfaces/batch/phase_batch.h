// SPDX-License-Identifier: Apache-2.0
/// What integrators ask of a phase function at up to sixteen points at once: one call for all
/// lanes, whose loop `describe<T>` makes of T's function for one point (bsdf_batch.h).
#pragma once

#include "core/interfaces/batch/lanes.h"

namespace lucerna {

class Phase;

struct PhaseBatch {
    /// As Phase::evaluate at the points `p`, in the lanes that are `wanted`.
    void (*evaluate)(const Phase& phase, const Vector3Lanes& p, const LaneMask& wanted,
                     const Vector3Lanes& wo, const Vector3Lanes& wi, BSDFValueLanes& out);

    template <typename T>
    static void attach(T& object) {
        static constexpr PhaseBatch loops{.evaluate = evaluate_each<T>};
        object.batch_ = &loops;
    }

private:
    template <typename T>
    static void evaluate_each(const Phase& phase, const Vector3Lanes& p, const LaneMask& wanted,
                              const Vector3Lanes& wo, const Vector3Lanes& wi, BSDFValueLanes& out) {
        const T& it = static_cast<const T&>(phase);
        for (std::size_t i = 0; i < lane_count; ++i) {
            if (!wanted[i]) continue;
            const auto value = it.evaluate(p[i], wo[i], wi[i]);
            out.f.set(i, Color(value.f));
            out.pdf[i] = value.pdf;
        }
    }
};

}  // namespace lucerna
