// SPDX-License-Identifier: Apache-2.0
/// Does the mean of all repeats meet the reference?
///
/// Let x₁ … x_R be the repeats and r the reference, both averaged over blocks of pixels, so that
/// noise falls and a bias that has any extent stays.
///
///   whole picture  b = (⟨x̄⟩ − ⟨r⟩) / ⟨r⟩, with Student's interval over the repeats, widened by
///                  the variance of ⟨r⟩
///   blocks         β² = ⟨((x̄ − r)² − s²/R − v) / (r² + ε)⟩, where s² is the variance between
///                  the repeats, v = ((A − B)/2)² that of the reference from its two halves,
///                  ε = 0.01 ⟨r⟩²: an unbiased estimate of the squared relative bias, whose
///                  standard error comes from the blocks, which are independent
///
/// Both intervals have 99 %: a comparison of many variants should not cry wolf.
#pragma once

#include "core/image/image.h"
#include "plugins/commands/compare/statistics.h"

#include <cstddef>
#include <vector>

namespace lucerna {

/// The means of an image over blocks of block_size² pixels, three channels each.
class Blocks {
public:
    Blocks() = default;
    explicit Blocks(const Image& image);

    /// At most 16, and less for small pictures, so that there are some hundred blocks.
    static int block_size(const Image& image);
    const std::vector<double>& means() const { return means_; }
    double mean() const;

private:
    std::vector<double> means_;
};

using BlockRuns = std::vector<Blocks>;

struct BiasTest {
    Interval brightness;  ///< relative difference of the means of the pictures
    /// Root mean square of the relative differences of blocks. low > 0: there is one.
    Interval local;
    bool biased = false;
};

/// The variance of the mean of each block of the reference; zero if it has no halves.
std::vector<double> block_variances(const std::vector<Image>& halves, std::size_t count);

/// Needs two runs at least; `variances` are block_variances() of the reference.
BiasTest test_bias(const BlockRuns& runs, const Blocks& reference,
                   const std::vector<double>& variances);

}  // namespace lucerna
