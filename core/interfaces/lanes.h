// SPDX-License-Identifier: Apache-2.0
/// Sixteen samples that are drawn together, one array to each number: compilers turn loops over
/// them into vector instructions, although each lane reads as if it were alone.
#pragma once

#include "core/interfaces/scattering.h"

/// Before a function with such a loop: it is compiled twice, for eight floats at a time where the
/// processor has them, with the same results. What it calls must be inline. Functions in headers
/// have a macro of their own: Clang 14 would define the choice of a version in each object file,
/// and the thread sanitizer is not ready yet when a program makes its choices.
#if defined(__x86_64__)
#define LUCERNA_VECTORIZED [[gnu::target_clones("avx2", "default")]]
#else
#define LUCERNA_VECTORIZED
#endif
#if defined(__clang__) || defined(__SANITIZE_THREAD__)
#define LUCERNA_VECTORIZED_INLINE
#else
#define LUCERNA_VECTORIZED_INLINE LUCERNA_VECTORIZED
#endif

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

/// Points on a surface (SurfaceSample).
struct SurfaceSampleLanes {
    Vector3Lanes p, n;
    Vector2Lanes uv, hit_uv;
    FloatLanes error, pdf;
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
};

}  // namespace lucerna
