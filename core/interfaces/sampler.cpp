// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/sampler.h"

namespace lucerna {

Sampler::Sampler(const Params& params)
    : sample_count_(params.int32("sample_count", 16, {.min = 1}, "samples per pixel")) {}

Sampler::~Sampler() = default;

}  // namespace lucerna
