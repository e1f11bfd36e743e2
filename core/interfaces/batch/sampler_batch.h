// SPDX-License-Identifier: Apache-2.0
/// Several numbers of one sample at once: see bsdf_batch.h. T may have a function `sample_pairs`.
#pragma once

#include "core/math/vector.h"

#include <cstdint>

namespace lucerna {

class Sampler;

struct SamplerBatch {
    static constexpr std::uint32_t most_pairs = 8;
    using Pairs = Vector2[most_pairs];

    /// The pairs at `dimension`, `dimension` + 2, …: what Sampler::sample_2d returns for each.
    /// Returns how many: as many as cost hardly more than one, for they may not all be asked for.
    std::uint32_t (*sample_pairs)(const Sampler& sampler, std::uint64_t sequence,
                                  std::uint64_t index, std::uint32_t dimension, Pairs& pairs);

    template <typename T>
    static void attach(T& object) {
        static constexpr SamplerBatch loops{.sample_pairs = sample_each<T>};
        object.batch_ = &loops;
    }

private:
    template <typename T>
    static std::uint32_t sample_each(const Sampler& sampler, std::uint64_t sequence,
                                     std::uint64_t index, std::uint32_t dimension, Pairs& pairs) {
        const T& it = static_cast<const T&>(sampler);
        if constexpr (requires { it.sample_pairs(sequence, index, dimension, pairs); }) {
            return it.sample_pairs(sequence, index, dimension, pairs);
        } else {
            pairs[0] = it.sample_2d(sequence, index, dimension);
            return 1;
        }
    }
};

}  // namespace lucerna
