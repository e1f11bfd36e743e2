// SPDX-License-Identifier: Apache-2.0
/// Places beside a point, so that the borders of cells do not show.
#pragma once

#include "core/interfaces/interaction.h"
#include "core/math/sequences.h"

namespace lucerna {

/// `p`, moved along the surface, or anywhere in a medium, by up to `reach` / 2 in each direction.
/// Where to follows from a hash of `place`: `p` in a unit of length of the scene, so that units do
/// not matter.
inline Vector3 jittered(const Receiver& at, Vector3 place, float reach) {
    const std::uint64_t bits = hash_of_point(place, 0x6a09e667);
    const float u = static_cast<float>(bits >> 40) * 0x1p-24f - 0.5f;
    const float v = static_cast<float>(bits >> 8 & 0xffffff) * 0x1p-24f - 0.5f;
    if (!at.has_normal()) {
        const float w = static_cast<float>(mix64(bits) >> 40) * 0x1p-24f - 0.5f;
        return at.p + reach * Vector3(u, v, w);
    }
    const Frame frame = Frame::from_normal(at.n);
    return at.p + reach * (u * frame.s + v * frame.t);
}

}  // namespace lucerna
