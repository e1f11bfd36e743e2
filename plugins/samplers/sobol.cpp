// SPDX-License-Identifier: Apache-2.0
/// sobol: Owen-scrambled, shuffled Sobol' points, independently for every pair of dimensions.
///
/// Each aligned block of 2ᵏ samples has one point in every elementary interval of area 2⁻ᵏ, so
/// powers of two are the best sample counts; any other is sound, too (Burley 2020, "Practical
/// Hash-based Owen Scrambling"). Pairs are padded, not dimensions of one sequence: none is bad.
#include "plugins/samplers/seeded.h"

namespace lucerna {

namespace {

/// Point `index` of patterns whose keys lie `step` apart. Compiled twice, for eight lanes where the
/// processor has them: half of the work are products of integers, which SSE2 does not have.
[[gnu::target_clones("avx2", "default")]] void points_of_patterns(
    std::uint64_t index, std::uint64_t key, std::uint64_t step,
    Vector2 (&points)[Sampler::block_pairs]) {
    for (std::uint32_t i = 0; i < Sampler::block_pairs; ++i) {
        points[i] = sobol_owen_2d(index, key + i * step);
    }
}

class SobolSampler final : public SeededSampler {
public:
    explicit SobolSampler(const Params& params) : SeededSampler(params) {}

    float sample_1d(std::uint64_t sequence, std::uint64_t index,
                    std::uint32_t dimension) const override {
        return sobol_owen_1d(index, raw_key(sequence, dimension));
    }

    Vector2 sample_2d(std::uint64_t sequence, std::uint64_t index,
                      std::uint32_t dimension) const override {
        return sobol_owen_2d(index, raw_key(sequence, dimension));
    }

    std::uint32_t sample_block(std::uint64_t sequence, std::uint64_t index, std::uint32_t dimension,
                               Vector2 (&pairs)[block_pairs]) const override {
        const std::uint64_t key = raw_key(sequence, dimension);
        points_of_patterns(index, key, raw_key(sequence, dimension + 2) - key, pairs);
        return block_pairs;
    }
};

}  // namespace

const PluginInfo plugin = describe<SobolSampler>("Owen-scrambled Sobol' points");

}  // namespace lucerna
