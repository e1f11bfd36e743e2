// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/medium.h"

namespace lucerna {

Phase::~Phase() = default;

Medium::Medium(const Params& params)
    : phase_(&params.nested_or<Phase>("isotropic", "into which directions light is scattered")),
      oriented_(phase_->oriented()) {}

Medium::~Medium() = default;

MediumPoint Medium::turned(Vector3 p, Vector3 w) const {
    MediumPoint point = coefficients(p);
    const float area = phase_->projected_area(p, w);
    point.sigma_s *= area;
    point.sigma_t *= area;
    return point;
}

}  // namespace lucerna
