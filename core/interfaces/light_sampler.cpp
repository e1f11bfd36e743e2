// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/light_sampler.h"

namespace lucerna {

LightSampler::~LightSampler() = default;

LightDistribution LightSampler::at(const Receiver& receiver) const {
    LightDistribution lights;
    const Receiver* const place = &receiver;
    LightDistribution* const result = &lights;
    batch().at(*this, {&place, 1}, {&result, 1});
    return lights;
}

}  // namespace lucerna
