// SPDX-License-Identifier: Apache-2.0
/// A pass of photons: what is asked of it, and what it tells.
#pragma once

#include "core/interfaces/bsdf.h"
#include "core/interfaces/medium.h"
#include "core/interfaces/shape.h"

#include <algorithm>
#include <span>
#include <variant>

namespace lucerna {

/// How light came to a point.
enum class PhotonKind : unsigned {
    direct = 1,    ///< from the light itself: L D, or L M in a medium
    caustic = 2,   ///< by specular or glossy surfaces only: L S+ D, or L S+ M
    indirect = 4,  ///< all else
};
using PhotonKinds = unsigned;
inline constexpr PhotonKinds all_kinds = 7;

inline PhotonKinds operator|(PhotonKind a, PhotonKind b) {
    return static_cast<unsigned>(a) | static_cast<unsigned>(b);
}
inline bool includes(PhotonKinds kinds, PhotonKind kind) {
    return (kinds & static_cast<unsigned>(kind)) != 0;
}

/// Photons are stored on surfaces that have a diffuse lobe. All others, mirrors or glossy, are
/// followed: density there would have to be enormous.
inline bool stores_photons(const BSDF& bsdf) {
    return any(bsdf.lobes() & (Lobe::diffuse_reflection | Lobe::diffuse_transmission));
}

/// True if some surface can make caustics: then they are worth a map of their own.
inline bool has_caustics(std::span<const Shape* const> shapes) {
    return std::any_of(shapes.begin(), shapes.end(), [](const Shape* shape) {
        if (const BSDF* bsdf = shape->bsdf()) {
            const Lobe lobes = bsdf->lobes();
            return any(lobes & specular_lobes) ||
                   (any(lobes & smooth_lobes) && !stores_photons(*bsdf));
        }
        const Geometry geometry = shape->geometry();
        const auto* instance = std::get_if<InstanceGeometry>(&geometry);
        if (!instance) return false;
        return has_caustics(std::get<GroupGeometry>(instance->group->geometry()).shapes);
    });
}

/// Where all power went, in luminance [W], times the number of photons emitted. Roulette makes
/// `absorbed` a difference of estimates: single terms may be negative.
struct PhotonEnergy {
    double emitted = 0;
    double escaped = 0;   ///< left the scene
    double absorbed = 0;  ///< by surfaces and media
    double cut = 0;       ///< on paths that reached max_depth
    double stored = 0;    ///< power of all photons that were stored; may well travel on

    PhotonEnergy& operator+=(const PhotonEnergy& o) {
        emitted += o.emitted;
        escaped += o.escaped;
        absorbed += o.absorbed;
        cut += o.cut;
        stored += o.stored;
        return *this;
    }
};

/// What a pass of photons is.
struct PhotonPass {
    std::uint64_t key = 0;        ///< of its random numbers
    std::uint64_t count = 0;      ///< of photons that are emitted, at least 1
    int max_depth = 0;            ///< edges of the longest path
    int rr_depth = 1;             ///< edges before roulette may end a path
    PhotonKinds kinds = 0;        ///< that are visited
    bool on_surfaces = true;      ///< whether photons are stored there
    bool in_media = false;        ///< whether photons are stored there
    bool caustics_apart = false;  ///< those of surfaces are stored in a list of their own
};

/// A photon that arrives at a surface.
struct PhotonHit {
    const Interaction& at;
    Vector3 w;             ///< unit, back to where it came from
    Color power;           ///< [W], to be divided by PhotonPass::count
    std::uint64_t photon;  ///< of the pass
    int depth;             ///< edges of its path
    PhotonKind kind;
    bool stored;  ///< the surface is one that keeps photons
};

/// A photon that a medium scatters.
struct MediumHit {
    Vector3 p;
    const Medium& medium;
    Vector3 w;    ///< unit, back to where it came from
    Color power;  ///< [W] that is scattered, to be divided by PhotonPass::count
    int depth;    ///< edges of its path
    PhotonKind kind;
};

}  // namespace lucerna
