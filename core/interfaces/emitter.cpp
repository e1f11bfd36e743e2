// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/emitter.h"

namespace lucerna {

Emitter::~Emitter() = default;

Color Emitter::radiance(const Interaction&, Vector3) const { return Color(0); }

Color Emitter::environment(Vector3) const { return Color(0); }

void Emitter::sample_emission_lanes(const Light& light, const Vector2Lanes& u_position,
                                    const Vector2Lanes& u_direction, std::size_t count,
                                    EmissionLanes& out) const {
    for (std::size_t i = 0; i < count; ++i) {
        const auto sample = sample_emission(light, u_position[i], u_direction[i]);
        out.o.set(i, sample ? sample->ray.o : Vector3(0));
        out.d.set(i, sample ? sample->ray.d : Vector3(0, 0, 1));
        out.power.set(i, sample ? sample->power : Color(0));
    }
}

}  // namespace lucerna
