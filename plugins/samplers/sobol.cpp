// SPDX-License-Identifier: Apache-2.0
/// sobol: Owen-scrambled, shuffled Sobol' points, independently for every pair of dimensions.
///
/// Each aligned block of 2ᵏ samples has one point in every elementary interval of area 2⁻ᵏ, so
/// powers of two are the best sample counts; any other is sound, too (Burley 2020, "Practical
/// Hash-based Owen Scrambling"). Pairs are padded, not dimensions of one sequence: none is bad.
#include "plugins/samplers/seeded.h"

#include <cstring>

namespace lucerna {

namespace {

static_assert(sizeof(FourUints) == Sampler::block_pairs * sizeof(std::uint32_t));

struct FourSeeds {
    FourUints order{}, first{}, second{};
};

/// Four times sobol_owen_2d, with both coordinates of all points side by side. Compiled twice: half
/// of the work are products of integers, which SSE2 does not have.
[[gnu::target_clones("avx2", "default")]] void four_points(std::uint32_t index,
                                                           const FourSeeds& seeds,
                                                           Vector2 (&pairs)[Sampler::block_pairs]) {
    using EightUints = std::uint32_t __attribute__((vector_size(32)));
    using EightInts = std::int32_t __attribute__((vector_size(32)));
    using EightFloats = float __attribute__((vector_size(32)));
    const FourUints reversed = FourUints{} + reverse_bits(index);
    const FourUints i = reverse_bits(laine_karras_permutation(reversed, seeds.order));
    const FourUints second = multiply_by_pascal(i);
    // x0, y0, x1, y1, …
    EightUints bits = __builtin_shufflevector(i, second, 0, 4, 1, 5, 2, 6, 3, 7);
    permute_bits_of(bits, EightUints{__builtin_shufflevector(seeds.first, seeds.second, 0, 4, 1, 5,
                                                             2, 6, 3, 7)});
    reverse_bits_of(bits);
    // Of 24 bits; signed, which processors convert in one step.
    const auto fractions =
        __builtin_convertvector(reinterpret_cast<EightInts>(bits >> 8), EightFloats) * 0x1p-24f;
    static_assert(sizeof fractions == sizeof pairs);
    std::memcpy(pairs, &fractions, sizeof pairs);
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
