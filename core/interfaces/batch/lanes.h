// SPDX-License-Identifier: Apache-2.0
/// Sixteen samples that are drawn together, one array to each number: compilers turn loops over
/// them into vector instructions, although each lane reads as if it were alone.
#pragma once

#include "core/interfaces/geometry.h"
#include "core/interfaces/light.h"
#include "core/interfaces/scattering.h"

#include <array>
#include <optional>

namespace lucerna {

inline constexpr std::size_t lane_count = 16;

/// The numbers of all lanes fill whole lines of the cache.
struct alignas(64) FloatLanes {
    float of[lane_count];

    float operator[](std::size_t i) const { return of[i]; }
    float& operator[](std::size_t i) { return of[i]; }
};

struct Vector2Lanes {
    FloatLanes x, y;

    Vector2 operator[](std::size_t i) const { return {x[i], y[i]}; }
    void set(std::size_t i, Vector2 v) { x[i] = v.x, y[i] = v.y; }
};

struct Vector3Lanes {
    FloatLanes x, y, z;

    Vector3 operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
    void set(std::size_t i, Vector3 v) { x[i] = v.x, y[i] = v.y, z[i] = v.z; }
};

/// Which lanes are asked for.
using LaneMask = std::array<bool, lane_count>;

/// Points on a surface (SurfaceSample).
struct SurfaceSampleLanes {
    Vector3Lanes p, n;
    Vector2Lanes hit_uv;
    FloatLanes error, pdf;

    SurfaceSample operator[](std::size_t i) const {
        return {.p = p[i], .n = n[i], .hit_uv = hit_uv[i], .error = error[i], .pdf = pdf[i]};
    }
    void set(std::size_t i, const SurfaceSample& sample) {
        p.set(i, sample.p);
        n.set(i, sample.n);
        hit_uv.set(i, sample.hit_uv);
        error[i] = sample.error;
        pdf[i] = sample.pdf;
    }
};

/// Values and densities of BSDFs (BSDFValue), or of phase functions, which have no colour.
struct BSDFValueLanes {
    Vector3Lanes f;
    FloatLanes pdf;

    void set(std::size_t i, const BSDFValue& value) {
        f.set(i, value.f);
        pdf[i] = value.pdf;
    }
};

/// Directions into which surfaces scatter (BSDFSample), without densities. No lobe: nothing is
/// scattered, and the lane's other numbers mean nothing.
struct BSDFSampleLanes {
    Vector3Lanes wi, weight;
    Lobe lobe[lane_count];
};

/// Particles that leave a light (EmissionSample), without their densities. No power: none leaves.
struct EmissionLanes {
    Vector3Lanes o, d, power;

    void set(std::size_t i, const std::optional<EmissionSample>& sample) {
        o.set(i, sample ? sample->ray.o : Vector3(0));
        d.set(i, sample ? sample->ray.d : Vector3(0, 0, 1));
        power.set(i, sample ? sample->power : Color(0));
    }
};

}  // namespace lucerna
