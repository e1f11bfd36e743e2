// SPDX-License-Identifier: Apache-2.0
/// Pictures of the sphere of directions by longitude and latitude: +y is the upper edge, −z the
/// left and right edges, +x lies a quarter of the width from the left (Mitsuba's convention).
///
///   d(u, v) = (sin φ sin θ, cos θ, −cos φ sin θ),   φ = 2π u,   θ = π v
///   pdf(d)  = p(u, v) / (2π² sin θ)                             (pbrt 4e, 12.5.2)
#pragma once

#include "plugins/emitters/map_patches.h"

#include "core/math/angle.h"
#include "core/math/bounds.h"
#include "core/math/frame.h"
#include "core/math/sequences.h"
#include "core/math/warp.h"

#include <bit>

namespace lucerna {

/// A direction in the space of the map, with the place where it lies in the picture.
struct MapPoint {
    Vector2 uv;
    float sin_theta;
};

inline MapPoint map_point(Vector3 d) {
    const float sin_theta = std::sqrt(d.x * d.x + d.z * d.z);
    const FourFloats angles = angles_of(FourFloats{-d.z, d.y}, FourFloats{d.x, sin_theta});
    const float u = angles[0] * (0.5f * inv_pi);
    return {{u < 0 ? std::min(u + 1, one_minus_epsilon) : u, angles[1] * inv_pi}, sin_theta};
}

inline Vector3 map_direction(Vector2 uv, float& sin_theta) {
    const Vector2 phi = unit_circle(uv.x);
    const Vector2 theta = unit_circle(0.5f * std::min(uv.y, 1 - uv.y));
    sin_theta = theta.y;
    return {phi.y * sin_theta, uv.y <= 0.5f ? theta.x : -theta.x, -phi.x * sin_theta};
}

/// A float has 24 random bits: too few where a sun leaves 10⁻⁶ of [0, 1) for the sky. Further bits
/// are a hash of both numbers, so each still has its place.
inline Vector2d with_more_bits(Vector2 u) {
    const std::uint64_t h =
        hash64({std::bit_cast<std::uint32_t>(u.x), std::bit_cast<std::uint32_t>(u.y)});
    const Vector2d rest(uint_to_double(static_cast<std::uint32_t>(h)),
                        uint_to_double(static_cast<std::uint32_t>(h >> 32)));
    return Vector2d(u) + 0x1p-24 * rest;
}

/// Bounds of the directions of a patch. Between neighbours of a grid no coordinate differs from its
/// linear interpolation by more than an eighth of the squared steps, in radians.
inline Bounds3 map_directions(const MapPatches& patches, std::uint32_t patch,
                              const Frame& world_from_map) {
    Bounds3 box;
    patches.for_each_corner(patch, [&](Vector2 uv) {
        float sin_theta = 0;
        box.include(world_from_map.to_world(map_direction(uv, sin_theta)));
    });
    const Vector2 step = Vector2(2 * pi, pi) * patches.step();
    const Vector3 margin(glm::dot(step, step) / 8);
    return {.min = box.min - margin, .max = box.max + margin};
}

/// A direction of a patch.
struct MapSample {
    Vector2 uv{0};
    Vector3 d{0};   ///< in the world
    float pdf = 0;  ///< [1/sr]; 0: none
};

inline MapSample sample_map(const MapPatches& patches, std::uint32_t patch,
                            const Frame& world_from_map, Vector2 u) {
    const PiecewiseConstant2D::Sample at = patches.sample(patch, with_more_bits(u));
    float sin_theta = 0;
    const Vector3 d = map_direction(at.p, sin_theta);
    if (!(at.pdf > 0 && sin_theta > 0)) return {};
    return {at.p, world_from_map.to_world(d), at.pdf / (2 * pi * pi * sin_theta)};
}

/// The density of `sample_map` [1/sr].
inline float map_pdf(const MapPatches& patches, std::uint32_t patch, const Frame& world_from_map,
                     Vector3 d) {
    const MapPoint at = map_point(world_from_map.to_local(d));
    if (!(at.sin_theta > 0)) return 0;
    return patches.pdf(patch, at.uv) / (2 * pi * pi * at.sin_theta);
}

}  // namespace lucerna
