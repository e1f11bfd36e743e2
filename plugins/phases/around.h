// SPDX-License-Identifier: Apache-2.0
/// Directions about the one in which light goes on, for phase functions that depend on the angle
/// alone.
#pragma once

#include "core/interfaces/phase.h"
#include "core/math/frame.h"

namespace lucerna {

/// The direction wi that turns light by an angle of this cosine; `u` in [0, 1) chooses the azimuth.
/// In double: a narrow peak is where 1 − cosine is small.
inline Vector3 turned(Vector3 wo, double cosine, float u) {
    const auto sine = static_cast<float>(safe_sqrt((1 - cosine) * (1 + cosine)));
    const float phi = 2 * pi * u;
    return Frame::from_normal(-wo).to_world(
        {sine * std::cos(phi), sine * std::sin(phi), static_cast<float>(cosine)});
}

}  // namespace lucerna
