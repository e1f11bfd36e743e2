// SPDX-License-Identifier: Apache-2.0
/// How a sample is shared among the pixels around it.
///
/// Samples are uniform in their pixels, and the value of pixel p is the weighted mean of all
/// samples near it (pbrt 4e, 5.4.3):
///
///   I(p) = Σ f(p − xᵢ) L(xᵢ) / Σ f(p − xᵢ)
///
/// Where f has negative lobes, weights could add up to nothing. Then the means I⁺ and I⁻ over the
/// samples of positive and of negative weight are formed each by itself (post-stratification), and
/// I = (1 + ν) I⁺ − ν I⁻: a constant stays exactly constant.
///
/// A filter wider than its pixel so averages more samples than the pixel has: the variance is
/// ∫f² / (∫f)² of that of a box, 4/9 for a tent of radius 1, 0.31 for the default Gaussian.
#pragma once

#include "core/interfaces/rfilter.h"
#include "core/math/vector.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lucerna {

/// The filter as a table. Weights are integers, so that their sums are exact, and their products
/// with floats, too.
class ReconstructionFilter {
public:
    /// Throws Error if the integral of the filter is not positive.
    explicit ReconstructionFilter(const RFilter& filter);

    /// How many pixels beside its own a sample reaches, on each side.
    int reach() const { return reach_; }

    /// Weights along one axis of the pixels −reach … reach from a sample's own, at `x` in [0, 1) of
    /// that pixel. The weight in two dimensions is the product.
    std::span<const std::int32_t> weights(float x) const {
        const auto step = static_cast<std::size_t>(x * static_cast<float>(steps));
        const auto count = static_cast<std::size_t>(2 * reach_ + 1);
        return std::span(table_).subspan(std::min(step, steps - 1) * count, count);
    }

    /// Where in its pixel a sample is placed, for u in [0, 1)²: anywhere, unless the filter is
    /// narrower than a pixel.
    Vector2 place(Vector2 u) const { return 0.5f + (u - 0.5f) * extent_; }

    /// ν = ∫f⁻ / ∫f, where f⁻ is the negative part in two dimensions. Zero for filters without
    /// negative lobes.
    double negative_weight() const { return negative_weight_; }

    /// Σ ρ(q)² over all pixels q, where ρ is the correlation of the noise of two pixels q apart: 1
    /// if pixels share no samples.
    double noise_correlation() const { return noise_correlation_; }

private:
    static constexpr std::size_t steps = 256;  ///< to a pixel
    static constexpr double largest = 0x1p14;  ///< of the weights

    int reach_;
    float extent_;
    std::vector<std::int32_t> table_;
    double negative_weight_ = 0;
    double noise_correlation_ = 1;
};

}  // namespace lucerna
