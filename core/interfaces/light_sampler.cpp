// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/light_sampler.h"

namespace lucerna {

LightSampler::~LightSampler() = default;

}  // namespace lucerna
