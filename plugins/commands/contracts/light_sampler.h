// SPDX-License-Identifier: Apache-2.0
/// What every light sampler promises (core/interfaces/light_sampler.h), at given points of a scene.
#pragma once

#include "core/interfaces/light_sampler.h"
#include "core/scene/scene.h"
#include "plugins/commands/contracts/finding.h"

#include <span>

namespace lucerna::contracts {

/// A sampler that is prepared for a scene, and points that receive light.
struct LightSamplerTrial {
    const LightSampler& sampler;
    const Scene& scene;
    std::span<const Receiver> points;
    bool blocked = false;  ///< what hides lights counts
};

/// True if some of 16 samples of the light reach the point on a side that receives; if `blocked`,
/// what hides lights counts.
bool contributes(const Scene& scene, const Light& light, const Receiver& at, bool blocked);

/// Probabilities are finite, add up to the draws that choose a light, and to no more.
Evidence pmf_sums(const LightSamplerTrial& trial);
/// The probability of a draw is the one that is evaluated.
Evidence pmf_of_draws(const LightSamplerTrial& trial);
/// Lights are drawn as often as their probability says (χ²).
Evidence draw_frequencies(const LightSamplerTrial& trial, const Effort& effort);
/// The probability is positive wherever a light contributes.
Evidence pmf_support(const LightSamplerTrial& trial);
/// Drawing at many points is drawing at each.
Evidence draws_in_batches(const LightSamplerTrial& trial, const Effort& effort);
/// The light that arrives is on average that of all lights.
Evidence light_is_unbiased(const LightSamplerTrial& trial, const Effort& effort);

}  // namespace lucerna::contracts
