// SPDX-License-Identifier: Apache-2.0
/// Rays, where they meet surfaces, and how such points look to lights.
///
/// All directions are unit length and point away from the surface. World space.
#pragma once

#include "core/math/frame.h"
#include "core/math/rounding.h"
#include "core/math/vector.h"

#include <cstdint>

namespace lucerna {

class Medium;
class Shape;

/// Names one flat primitive of the scene, so that a ray that starts on it cannot hit it again.
struct PrimitiveId {
    static constexpr std::uint32_t none = 0xffffffff;
    std::uint32_t geometry = none;
    std::uint32_t primitive = none;
    std::uint32_t instance = none;

    bool operator==(const PrimitiveId&) const = default;
};

/// Half-line from `o` along the unit vector `d`, for 0 <= t <= tmax.
struct Ray {
    Vector3 o{0};
    Vector3 d{0, 0, 1};
    float tmax = infinity;
    PrimitiveId source{};  ///< what the origin lies on; never hit by this ray
};

/// Sides of a surface to which light can go from a receiver.
enum class Sides : std::uint8_t { front = 1, back = 2, both = 3 };

/// A point that receives light: all that emitters and light samplers may know of it. In a medium it
/// has no normal: n and ns are zero, and light arrives at both sides.
struct Receiver {
    Vector3 p{0};
    Vector3 n{0, 0, 1};   ///< geometric normal, on the side that sees the viewer
    Vector3 ns{0, 0, 1};  ///< shading normal, same side
    float error = 0;      ///< bound of the absolute error of each coordinate of p
    Sides sides = Sides::front;
    PrimitiveId source{};
    const Medium* medium = nullptr;  ///< through which light arrives, if the integrator knows media

    /// A point in a medium, on a ray from `o` along `d` (unit) at distance t.
    static Receiver in_medium(const Medium& medium, Vector3 o, Vector3 d, float t) {
        return {.p = o + t * d,
                .n = Vector3(0),
                .ns = Vector3(0),
                .error = gamma(3) * (max_component(absolute(o)) + t),
                .sides = Sides::both,
                .medium = &medium};
    }
    bool has_normal() const { return n != Vector3(0); }
};

/// A point where a ray met a surface.
struct Interaction {
    Interaction() {}  // not an aggregate, all of whose bytes would be cleared first

    Vector3 p{0};
    float error = 0;     ///< bound of the absolute error of each coordinate of p
    Vector3 n{0, 0, 1};  ///< geometric normal, towards the outside of the shape
    Vector2 uv{0};       ///< surface parameters
    Frame shading;       ///< shading.n: shading normal, same side as n
    Vector3 dpdu{1, 0, 0};
    Vector3 dpdv{0, 1, 0};
    float t = 0;  ///< distance along the ray
    const Shape* shape = nullptr;
    std::uint32_t primitive = 0;  ///< of the shape
    Vector2 hit_uv{0};            ///< place on the primitive: Hit::uv
    PrimitiveId source{};

    Vector3 to_local(Vector3 world) const { return shading.to_local(world); }
    Vector3 to_world(Vector3 local) const { return shading.to_world(local); }

    /// A ray that leaves along `d` and does not hit the surface it starts on.
    Ray spawn_ray(Vector3 d) const {
        return {.o = offset_ray_origin(p, error, n, d), .d = d, .tmax = infinity, .source = source};
    }
    /// The point as seen from direction `wo` (world); light can go to `sides`, where front is
    /// the side of `wo`.
    Receiver receiver(Vector3 wo, Sides sides) const {
        const float side = std::copysign(1.0f, glm::dot(wo, n));
        return {.p = p,
                .n = side * n,
                .ns = side * shading.n,
                .error = error,
                .sides = sides,
                .source = source};
    }
};

}  // namespace lucerna
