// SPDX-License-Identifier: Apache-2.0
/// What samplers share: a seed of their own, a key for each pattern, and random permutations.
#pragma once

#include "core/interfaces/sampler.h"
#include "core/math/sequences.h"

#include <bit>

namespace lucerna {

class SeededSampler : public Sampler {
protected:
    explicit SeededSampler(const Params& params)
        : Sampler(params),
          seed_(hash64({static_cast<std::uint64_t>(
              params.integer("seed", 0, any_value, "another seed: other noise"))})) {
        params.no_effect("dimension", "there is no limit to the number of dimensions");
        params.no_effect("scramble", "sequences are always scrambled");
    }

    /// Another number for every sequence and dimension, not mixed; sequences are hashes already.
    std::uint64_t raw_key(std::uint64_t sequence, std::uint32_t dimension) const {
        return sequence + seed_ + dimension * 0xbf58476d1ce4e5b9u;
    }
    /// Well mixed, and another one for every sequence and dimension.
    std::uint64_t key(std::uint64_t sequence, std::uint32_t dimension) const {
        return mix64(mix64(sequence + seed_) + dimension * 0x9e3779b97f4a7c15u);
    }

private:
    std::uint64_t seed_;
};

/// Image of `i` < n under a random permutation of 0 … n − 1, one for each key; n <= 2³¹.
///
/// Steps that permute all numbers of as many bits as n − 1 has, repeated until the result is
/// below n ("cycle walking": Black and Rogaway 2002), which takes less than two rounds on average.
/// The rotation at the end makes every image of every i exactly equally likely.
inline std::uint32_t permute(std::uint32_t i, std::uint32_t n, std::uint64_t key) {
    const auto bits = static_cast<int>(std::bit_width(n - 1));
    const auto mask = static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
    const int shift = (bits + 1) / 2;
    do {
        std::uint64_t k = key;
        for (int step = 0; step < 5; ++step) {
            // Odd factors carry upwards, the shift brings high bits down: both are invertible.
            k = mix64(k + 0x9e3779b97f4a7c15u);
            i = (i + static_cast<std::uint32_t>(k)) * (static_cast<std::uint32_t>(k >> 32) | 1);
            i &= mask;
            i ^= i >> shift;
        }
    } while (i >= n);
    return (i + static_cast<std::uint32_t>(mix64(~key) % n)) % n;
}

/// Where sample `i` < `cells` lies in a grid of `cells` cells with rows of `columns`: a random
/// order, in which even and odd samples take one colour of a chessboard each. An odd number of
/// cells has no two colours of equal size; all cells are then equally likely for every sample.
inline std::uint32_t shuffled_cell(std::uint32_t i, std::uint32_t cells, std::uint32_t columns,
                                   std::uint64_t key) {
    if (cells % 2 == 1) return permute(i, cells, key);
    const std::uint32_t color = (i ^ static_cast<std::uint32_t>(key)) & 1;
    const std::uint32_t cell = 2 * permute(i / 2, cells / 2, mix64(key + color));
    // Colours alternate along a row; rows of even length begin with either colour in turn.
    const std::uint32_t row = cell / columns;
    return cell + (columns % 2 == 0 ? (color + row) % 2 : color);
}

}  // namespace lucerna
