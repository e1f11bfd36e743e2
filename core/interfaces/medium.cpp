// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/medium.h"

namespace lucerna {

Phase::~Phase() = default;

Medium::Medium(const Params& params)
    : phase_(&params.nested_or<Phase>("isotropic", "into which directions light is scattered")),
      oriented_(phase_->oriented()) {}

Medium::~Medium() = default;

void Medium::turn(MediumPoint& point, Vector3 p, Vector3 w) const {
    const float area = phase_->projected_area(p, w);
    point.sigma_s *= area;
    point.sigma_t *= area;
}

}  // namespace lucerna
