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

    /// Well mixed, and another one for every sequence and dimension.
    std::uint64_t key(std::uint64_t sequence, std::uint32_t dimension) const {
        return mix64(mix64(sequence + seed_) + dimension * 0x9e3779b97f4a7c15u);
    }

private:
    std::uint64_t seed_;
};

/// Image of `i` < n under a random permutation of 0 … n − 1, one for each key.
///
/// Steps that permute all numbers of as many bits as n − 1 has, repeated until the result is
/// below n ("cycle walking": Black and Rogaway 2002). On average that takes less than two rounds.
inline std::uint32_t permute(std::uint32_t i, std::uint32_t n, std::uint64_t key) {
    const auto bits = static_cast<int>(std::bit_width(n - 1));
    const auto mask = static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
    const int shift = (bits + 1) / 2;
    const auto low = static_cast<std::uint32_t>(key), high = static_cast<std::uint32_t>(key >> 32);
    do {
        // Odd factors and additions carry upwards, shifts bring high bits down: each is invertible.
        i = (i + low) * ((high << 1) | 1) & mask;
        i ^= i >> shift;
        i = (i + high) * ((low << 1) | 1) & mask;
        i ^= i >> shift;
        i = (i ^ (low >> 7)) * 0x9e3779b1u & mask;
        i ^= i >> shift;
        i = (i + (high >> 11)) * 0x85ebca6bu & mask;
    } while (i >= n);
    return i;
}

}  // namespace lucerna
