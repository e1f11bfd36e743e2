// SPDX-License-Identifier: Apache-2.0
/// Rays together with the answers to what is asked about them, so that many are traced at once.
#pragma once

#include "core/interfaces/batch/lanes.h"
#include "core/interfaces/interaction.h"

#include <optional>

namespace lucerna {

/// A ray, and what it meets.
struct TracedRay {
    Ray ray;
    std::optional<Interaction> hit{};
};

/// Sixteen rays that run close together and only ask whether something lies on them.
struct ShadowPacket {
    Vector3Lanes o;  ///< origins
    Vector3Lanes d;  ///< directions, of any length but zero
    FloatLanes tmax;
    PrimitiveId source[lane_count];  ///< does not block the ray, nor does `target`
    PrimitiveId target[lane_count];
    LaneMask open;  ///< in: the ray is to be traced; out: and nothing blocks it
};

}  // namespace lucerna
