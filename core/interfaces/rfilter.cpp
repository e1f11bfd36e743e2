// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/rfilter.h"

namespace lucerna {

RFilter::~RFilter() = default;

}  // namespace lucerna
