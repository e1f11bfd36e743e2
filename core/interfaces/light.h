// SPDX-License-Identifier: Apache-2.0
/// Lights, and the light that leaves or arrives from them. World space; densities are per solid
/// angle [1/sr] unless named otherwise.
#pragma once

#include "core/interfaces/interaction.h"

#include <cmath>

namespace lucerna {

class Emitter;

/// One light of the scene: an emitter on one primitive of a shape, or an emitter without shape.
/// A mesh that emits is as many lights as it has triangles.
struct Light {
    const Emitter* emitter = nullptr;
    const Shape* shape = nullptr;  ///< null for point, spot, directional, environment
    std::uint32_t primitive = 0;   ///< of the shape, or of the emitter if there is none
};

/// What a light sampler chose.
struct LightChoice {
    std::uint32_t light = 0;  ///< index into Scene::lights()
    /// Its probability at this point, for the weights of multiple importance sampling; where that
    /// is not known exactly, a function of light and point in its place.
    float pmf = 0;
    /// What the contribution of the light is multiplied by: an unbiased estimate of one over the
    /// probability.
    float weight = 1 / pmf;

    /// Whether the weight is 1 / pmf, so that pmf is the probability.
    bool is_exact() const { return std::abs(weight * pmf - 1) < 1e-5f; }
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
