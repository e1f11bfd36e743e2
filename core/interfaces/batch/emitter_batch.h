// SPDX-License-Identifier: Apache-2.0
/// Sixteen particles that leave a light at once: see bsdf_batch.h. T may have a function
/// `sample_emission_lanes`.
#pragma once

#include "core/interfaces/batch/lanes.h"
#include "core/interfaces/light.h"

#include <optional>

namespace lucerna {

struct EmitterBatch {
    /// As Emitter::sample_emission, in the first `count` lanes. All lanes of `u_position` and
    /// `u_direction` hold numbers of [0, 1)².
    void (*sample_emission)(const Emitter& emitter, const Light& light,
                            const Vector2Lanes& u_position, const Vector2Lanes& u_direction,
                            std::size_t count, EmissionLanes& out);

    template <typename T>
    static void attach(T& object) {
        static constexpr EmitterBatch loops{.sample_emission = sample_emission_each<T>};
        object.batch_ = &loops;
    }

private:
    template <typename T>
    static void sample_emission_each(const Emitter& emitter, const Light& light,
                                     const Vector2Lanes& u_position,
                                     const Vector2Lanes& u_direction, std::size_t count,
                                     EmissionLanes& out) {
        const T& it = static_cast<const T&>(emitter);
        if constexpr (requires {
                          it.sample_emission_lanes(light, u_position, u_direction, count, out);
                      }) {
            it.sample_emission_lanes(light, u_position, u_direction, count, out);
        } else {
            for (std::size_t i = 0; i < count; ++i) {
                out.set(i, it.sample_emission(light, u_position[i], u_direction[i]));
            }
        }
    }
};

}  // namespace lucerna
