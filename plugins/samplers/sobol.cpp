// SPDX-License-Identifier: Apache-2.0
/// sobol: Owen-scrambled, shuffled Sobol' points, independently for every pair of dimensions.
///
/// Each aligned block of 2ᵏ samples has one point in every elementary interval of area 2⁻ᵏ, so
/// powers of two are the best sample counts; any other is sound, too (Burley 2020, "Practical
/// Hash-based Owen Scrambling"). Pairs are padded, not dimensions of one sequence: none is bad.
#include "plugins/samplers/seeded.h"

namespace lucerna {

namespace {

static_assert(sizeof(FourUints) == Sampler::block_pairs * sizeof(std::uint32_t));

struct FourSeeds {
    FourUints order{}, first{}, second{};
};

/// Compiled twice: half of the work are products of integers, which SSE2 does not have.
[[gnu::target_clones("avx2", "default")]] void four_points(std::uint32_t index,
                                                           const FourSeeds& seeds,
                                                           Vector2 (&pairs)[Sampler::block_pairs]) {
    const auto points =
        sobol_owen_2d_bits(FourUints{} + index, seeds.order, seeds.first, seeds.second);
    for (std::uint32_t i = 0; i < Sampler::block_pairs; ++i) {
        pairs[i] = {uint_to_float(points.x[i]), uint_to_float(points.y[i])};
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

    void sample_block(std::uint64_t sequence, std::uint64_t index, std::uint32_t dimension,
                      Vector2 (&pairs)[block_pairs]) const override {
        FourSeeds seeds;
        for (std::uint32_t i = 0; i < block_pairs; ++i) {
            const SequenceSeeds s(index, raw_key(sequence, dimension + 2 * i));
            seeds.order[i] = s.order(), seeds.first[i] = s.first(), seeds.second[i] = s.second();
        }
        four_points(static_cast<std::uint32_t>(index), seeds, pairs);
    }
};

}  // namespace

const PluginInfo plugin = describe<SobolSampler>("Owen-scrambled Sobol' points");

}  // namespace lucerna
