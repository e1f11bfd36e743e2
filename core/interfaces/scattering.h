// SPDX-License-Identifier: Apache-2.0
/// What a BSDF is made of, and what it answers. Directions are local: in the frame of the shading
/// normal.
#pragma once

#include "core/interfaces/interaction.h"

namespace lucerna {

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

/// Mirrors and clear glass: there is nothing for light sampling.
constexpr bool only_specular(Lobe lobes) { return any(lobes) && (lobes & specular_lobes) == lobes; }

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

}  // namespace lucerna
