// SPDX-License-Identifier: Apache-2.0
/// The small structs that travel between the interfaces.
///
/// All directions are unit length and point away from the surface. World space unless a name says
/// "local": the frame of the shading normal. Densities are per solid angle [1/sr] unless named
/// otherwise.
#pragma once

#include "core/math/frame.h"
#include "core/math/rounding.h"
#include "core/math/vector.h"

#include <cstdint>

namespace lucerna {

class Shape;
class Emitter;

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

/// A point that receives light: all that emitters and light samplers may know of it.
struct Receiver {
    Vector3 p{0};
    Vector3 n{0, 0, 1};   ///< geometric normal, on the side that sees the viewer
    Vector3 ns{0, 0, 1};  ///< shading normal, same side
    float error = 0;      ///< bound of the absolute error of each coordinate of p
    Sides sides = Sides::front;
    PrimitiveId source{};
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

/// What a lobe of a BSDF is. A BSDF's lobes are or-ed together.
enum class Lobe : std::uint8_t {
    none = 0,
    diffuse_reflection = 1,
    diffuse_transmission = 2,
    glossy_reflection = 4,
    glossy_transmission = 8,
    specular_reflection = 16,    ///< a delta distribution
    specular_transmission = 32,  ///< a delta distribution
    null = 64,                   ///< goes straight through, as if there were no surface
};
constexpr Lobe operator|(Lobe a, Lobe b) {
    return static_cast<Lobe>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}
constexpr Lobe operator&(Lobe a, Lobe b) {
    return static_cast<Lobe>(static_cast<unsigned>(a) & static_cast<unsigned>(b));
}
constexpr bool any(Lobe lobes) { return lobes != Lobe::none; }

inline constexpr Lobe smooth_lobes = Lobe::diffuse_reflection | Lobe::diffuse_transmission |
                                     Lobe::glossy_reflection | Lobe::glossy_transmission;
inline constexpr Lobe specular_lobes = Lobe::specular_reflection | Lobe::specular_transmission;
inline constexpr Lobe delta_lobes = specular_lobes | Lobe::null;
inline constexpr Lobe transmission_lobes = Lobe::diffuse_transmission | Lobe::glossy_transmission |
                                           Lobe::specular_transmission | Lobe::null;

/// Sides to which light can go, of front and back: both if something is transmitted.
constexpr Sides sides(Lobe lobes) {
    return any(lobes & transmission_lobes) ? Sides::both : Sides::front;
}

/// Which quantity is scattered; they differ by η² at refraction (Veach 1997, 5.2).
enum class TransportMode : std::uint8_t { radiance, importance };

/// Value and density of a BSDF for a pair of directions; both zero for delta lobes.
struct BSDFValue {
    Color f{0};     ///< [1/sr], without the cosine
    float pdf = 0;  ///< density of `wi` given `wo` [1/sr]
};

struct BSDFSample {
    Vector3 wi{0};    ///< local
    Color weight{0};  ///< f |cos θi| / pdf, or its limit for a delta lobe
    float pdf = 0;    ///< [1/sr]; probability of the lobe if it is a delta
    Lobe lobe = Lobe::none;
    float eta = 1;  ///< relative index of refraction along wi; 1 unless refracted

    bool specular() const { return any(lobe & delta_lobes); }
};

/// A point on a surface, chosen by area or by solid angle.
struct SurfaceSample {
    Vector3 p{0};
    Vector3 n{0, 0, 1};
    Vector2 uv{0};
    float error = 0;
    float pdf = 0;  ///< per area [1/m²] or per solid angle [1/sr]: the function says
};

/// One light of the scene: an emitter on one primitive of a shape, or an emitter without shape.
/// A mesh that emits is as many lights as it has triangles.
struct Light {
    const Emitter* emitter = nullptr;
    const Shape* shape = nullptr;  ///< null for point, spot, directional, environment
    std::uint32_t primitive = 0;   ///< of the shape, or of the emitter if there is none
};

/// Light that arrives at a receiver from one sampled point or direction.
struct LightSample {
    Vector3 wi{0};         ///< from the receiver to the light
    float distance = 0;    ///< infinity for lights at infinity
    Color radiance{0};     ///< [W/(m² sr)]; irradiance if `delta` [W/m²]
    float pdf = 0;         ///< [1/sr]; 1 if `delta`
    bool delta = false;    ///< cannot be hit by chance
    Vector3 p{0};          ///< point on the light, if the distance is finite
    Vector3 n{0};          ///< its normal, zero if it has none
    float error = 0;       ///< of p
    PrimitiveId target{};  ///< what p lies on; does not block the light
};

/// A particle that leaves a light.
struct EmissionSample {
    Ray ray;
    Color power{0};          ///< Le |cos θ| / (pdf_position · pdf_direction): the flux it carries
    float pdf_position = 0;  ///< [1/m²]; 1 for a point
    float pdf_direction = 0;  ///< [1/sr]; 1 for a single direction
};

}  // namespace lucerna
