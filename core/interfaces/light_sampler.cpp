// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/light_sampler.h"

namespace lucerna {

LightSampler::~LightSampler() = default;

void LightSampler::sample_batch(std::uint32_t draw, std::span<LightQuery> queries) const {
    for (LightQuery& query : queries) query.choice = sample(*query.at, draw, query.u);
}

}  // namespace lucerna
