// SPDX-License-Identifier: Apache-2.0
/// What every sampler promises (core/interfaces/sampler.h).
#pragma once

#include "core/interfaces/sampler.h"
#include "plugins/commands/contracts/finding.h"

namespace lucerna::contracts {

/// χ² of points of [0, 1)² over a grid of cells against a uniform density.
class UnitGrid {
public:
    explicit UnitGrid(int side)
        : side_(side), counts_(static_cast<std::size_t>(side) * static_cast<std::size_t>(side)) {}

    void add(Vector2 p);
    Judgement uniform() const;
    /// Every cell holds the same number of points.
    bool equal() const;

private:
    int side_;
    std::vector<double> counts_;
    double total_ = 0;
};

/// Pearson's, of two lists of one length.
double correlation(const std::vector<double>& a, const std::vector<double>& b);

/// Numbers lie in [0, 1), for all sequences, indices and dimensions.
Evidence sampler_range(const Sampler& sampler);
/// Another index above 2³² is another sample.
Evidence sampler_large_indices(const Sampler& sampler);
/// The same numbers from `again`, a sampler of the same parameters, asked in another order.
Evidence sampler_purity(const Sampler& sampler, const Sampler& again, const Effort& effort);
/// Blocks hold the pairs, and a stream that jumps finds them.
Evidence sampler_blocks(const Sampler& sampler);
/// χ² over sequences: pairs, and neighbouring dimensions.
Evidence sampler_uniformity(const Sampler& sampler, const Effort& effort);
/// Neighbouring sequences are not correlated.
Evidence sampler_sequences(const Sampler& sampler, const Effort& effort);
/// χ² of any two dimensions.
Evidence sampler_dimensions(const Sampler& sampler, const Effort& effort);

/// All of them.
std::vector<Evidence> check(const Sampler& sampler, const Sampler& again, const Effort& effort);

}  // namespace lucerna::contracts
