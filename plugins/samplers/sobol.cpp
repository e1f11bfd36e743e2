// SPDX-License-Identifier: Apache-2.0
/// sobol: Owen-scrambled Sobol' points.
///
/// Each aligned block of 2ᵏ samples has one point in every elementary interval of area 2⁻ᵏ, so
/// powers of two are the best sample counts; any other is sound, too (Burley 2020, "Practical
/// Hash-based Owen Scrambling"). Groups of eight pairs of dimensions are well distributed together;
/// beyond them, dimensions are padded: groups are scrambled and shuffled independently, so that no
/// dimension is bad.
#include "plugins/samplers/seeded.h"
#include "plugins/samplers/sobol_orders.h"

#include <bit>

namespace lucerna {

namespace {

/// Index of the Sobol' sequence for a sample: a random order of the aligned blocks in which even
/// and odd samples are the two halves.
std::uint32_t shuffled_index(std::uint32_t sample, std::uint32_t seed) {
    const std::uint32_t i = owen_scramble(sample, seed) & ~1u;
    const auto parity = static_cast<std::uint32_t>(std::popcount(i & half_of_index));
    return i | ((sample ^ parity) & 1);
}

/// The same columns side by side for all pairs, as vectors of eight.
struct ColumnsOfPairs {
    std::uint32_t of[sobol_order_columns][sobol_pairs] = {};

    constexpr ColumnsOfPairs() {
        for (std::uint32_t bit = 0; bit < sobol_order_columns; ++bit) {
            for (std::uint32_t k = 0; k < sobol_pairs; ++k) of[bit][k] = sobol_orders[k][bit];
        }
    }
};
alignas(32) constexpr ColumnsOfPairs columns;

/// Mixes 32 bits, a bijection (Wellons 2018, "Prospecting for Hash Functions": lowbias32).
[[gnu::always_inline]] inline std::uint32_t mix32(std::uint32_t x) {
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

/// All pairs of a group, scrambled by hashes of the group's and the pair's number. Compiled twice,
/// for eight lanes where the processor has them: half of the work are products of integers, which
/// SSE2 does not have.
[[gnu::target_clones("avx2", "default")]] void points_of_group(std::uint32_t index,
                                                               std::uint64_t group,
                                                               Vector2 (&points)[sobol_pairs]) {
    const std::uint64_t h = mix64(group);
    const auto first = static_cast<std::uint32_t>(h), second = static_cast<std::uint32_t>(h >> 32);
    std::uint32_t order[sobol_pairs], x[sobol_pairs], y[sobol_pairs];
    for (std::uint32_t& o : order) o = index >> sobol_order_columns << sobol_order_columns;
    for (std::uint32_t bit = 0; bit < sobol_order_columns; ++bit) {
        const std::uint32_t mask = 0u - ((index >> bit) & 1);
        for (std::uint32_t k = 0; k < sobol_pairs; ++k) order[k] ^= columns.of[bit][k] & mask;
    }
    for (std::uint32_t k = 0; k < sobol_pairs; ++k) {
        const std::uint32_t step = k * 0x9e3779b9u;
        x[k] = reverse_bits(laine_karras_permutation(order[k], mix32(first + step)));
        y[k] = reverse_bits(
            laine_karras_permutation(multiply_by_pascal(order[k]), mix32(second + step)));
    }
    for (std::uint32_t k = 0; k < sobol_pairs; ++k) {
        points[k] = {uint_to_float(x[k]), uint_to_float(y[k])};
    }
}

class SobolSampler final : public SeededSampler {
public:
    explicit SobolSampler(const Params& params) : SeededSampler(params) {
        static_assert(sobol_pairs == Batch::most_pairs);
    }

    float sample_1d(std::uint64_t sequence, std::uint64_t index,
                    std::uint32_t dimension) const override {
        return sample_2d(sequence, index, dimension).x;
    }

    Vector2 sample_2d(std::uint64_t sequence, std::uint64_t index,
                      std::uint32_t dimension) const override {
        Batch::Pairs points;
        group_points(sequence, index, dimension, points);
        return points[pair_of(dimension)];
    }

    std::uint32_t sample_pairs(std::uint64_t sequence, std::uint64_t index, std::uint32_t dimension,
                               Batch::Pairs& pairs) const {
        Batch::Pairs points;
        group_points(sequence, index, dimension, points);
        const std::uint32_t first = pair_of(dimension);
        std::copy(points + first, points + Batch::most_pairs, pairs);
        return Batch::most_pairs - first;
    }

private:
    static std::uint32_t pair_of(std::uint32_t dimension) { return dimension / 2 % sobol_pairs; }

    /// The group that holds a pair. Pairs that begin at odd dimensions have groups of their own.
    void group_points(std::uint64_t sequence, std::uint64_t index, std::uint32_t dimension,
                      Batch::Pairs& points) const {
        const std::uint32_t first = dimension - 2 * pair_of(dimension);
        const SequenceSeeds seeds(index, raw_key(sequence, first));
        const std::uint32_t i = shuffled_index(static_cast<std::uint32_t>(index), seeds.order());
        points_of_group(i, seeds.h, points);
    }
};

}  // namespace

const PluginInfo plugin = describe<SobolSampler>("Owen-scrambled Sobol' points");

}  // namespace lucerna
