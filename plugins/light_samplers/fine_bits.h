// SPDX-License-Identifier: Apache-2.0
/// Random numbers that follow from a point: more bits than a float has, and jitter.
#pragma once

#include "core/interfaces/interaction.h"
#include "core/math/sequences.h"

#include <bit>

namespace lucerna {

/// A hash of the point and of `salt`.
inline std::uint64_t hash_of(Vector3 p, std::uint64_t salt) {
    const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x)}; };
    const std::uint64_t key =
        (bits(p.x) + salt) * 0x9e3779b97f4a7c15u + bits(p.y) * 0xbf58476d1ce4e5b9u + bits(p.z);
    return mix64(key);
}

/// `p`, moved along the surface, or anywhere in a medium, by up to `reach` / 2 in each direction.
/// Where to follows from a hash of `place`: `p` in a unit of length of the scene, so that units do
/// not matter.
inline Vector3 jittered(const Receiver& at, Vector3 place, float reach) {
    const std::uint64_t bits = hash_of(place, 0x6a09e667);
    const float u = static_cast<float>(bits >> 40) * 0x1p-24f - 0.5f;
    const float v = static_cast<float>(bits >> 8 & 0xffffff) * 0x1p-24f - 0.5f;
    if (!at.has_normal()) {
        const float w = static_cast<float>(mix64(bits) >> 40) * 0x1p-24f - 0.5f;
        return at.p + reach * Vector3(u, v, w);
    }
    const Frame frame = Frame::from_normal(at.n);
    return at.p + reach * (u * frame.s + v * frame.t);
}

/// Whether a light sampler sees the same point: what it has computed there, it can use again.
inline bool is_same_place(const Receiver& a, const Receiver& b) {
    return a.p == b.p && a.n == b.n && a.ns == b.ns && a.error == b.error && a.sides == b.sides;
}

/// Number `draw` of `draws` of the point, in [0, 1): strata of equal size, and 29 bits of a hash
/// behind the 24 bits of `u`, so that a million lights can be told apart.
inline double fine_number(const Receiver& at, std::uint32_t draw, std::uint32_t draws, float u) {
    const double fine = static_cast<double>(u) + uint64_to_double(hash_of(at.p, draw)) * 0x1p-24;
    return std::min((draw + fine) / draws, 1 - 0x1p-53);
}

}  // namespace lucerna
