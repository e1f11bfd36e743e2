// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/sampler.h"

namespace lucerna {

Sampler::Sampler(const Params& params)
    : sample_count_(params.int32("sample_count", 16, {.min = 1}, "samples per pixel")) {}

Sampler::~Sampler() = default;

std::uint32_t Sampler::sample_block(std::uint64_t sequence, std::uint64_t index,
                                    std::uint32_t dimension, Vector2 (&pairs)[block_pairs]) const {
    pairs[0] = sample_2d(sequence, index, dimension);
    return 1;
}

}  // namespace lucerna
