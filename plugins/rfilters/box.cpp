// SPDX-License-Identifier: Apache-2.0
/// box: all samples within the radius count the same.
///
///   f(x) = 1 for |x| <= radius
///
/// With the default radius no sample belongs to two pixels: the fastest filter, and the one that
/// aliases most.
#include "core/interfaces/rfilter.h"

#include <cmath>

namespace lucerna {

namespace {

class BoxFilter final : public RFilter {
public:
    explicit BoxFilter(const Params& params)
        : radius_(params.real("radius", 0.5, positive, "half the width [pixels]")) {}

    float radius() const override { return radius_; }
    float evaluate(float x) const override { return std::abs(x) <= radius_ ? 1.0f : 0.0f; }

private:
    float radius_;
};

}  // namespace

const PluginInfo plugin = describe<BoxFilter>("the mean over the area of the pixel");

}  // namespace lucerna
