// SPDX-License-Identifier: Apache-2.0
/// sobol: Owen-scrambled, shuffled Sobol' points, independently for every pair of dimensions.
///
/// Each aligned block of 2ᵏ samples has one point in every elementary interval of area 2⁻ᵏ, so
/// powers of two are the best sample counts; any other is sound, too (Burley 2020, "Practical
/// Hash-based Owen Scrambling"). Pairs are padded, not dimensions of one sequence: none is bad.
#include "plugins/samplers/seeded.h"

namespace lucerna {

namespace {

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
        FourUints order{}, first{}, second{};
        static_assert(sizeof order == block_pairs * sizeof(std::uint32_t));
        for (std::uint32_t i = 0; i < block_pairs; ++i) {
            const SequenceSeeds seeds(index, raw_key(sequence, dimension + 2 * i));
            order[i] = seeds.order(), first[i] = seeds.first(), second[i] = seeds.second();
        }
        const FourUints indices = FourUints{} + static_cast<std::uint32_t>(index);
        const auto points = sobol_owen_2d_bits(indices, order, first, second);
        for (std::uint32_t i = 0; i < block_pairs; ++i) {
            pairs[i] = {uint_to_float(points.x[i]), uint_to_float(points.y[i])};
        }
    }
};

}  // namespace

const PluginInfo plugin = describe<SobolSampler>("Owen-scrambled Sobol' points");

}  // namespace lucerna
