// SPDX-License-Identifier: Apache-2.0
/// tent: weights that fall linearly; never rings.
///
///   f(x) = max(0, 1 - |x| / radius)
#include "core/interfaces/rfilter.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

class TentFilter final : public RFilter {
public:
    explicit TentFilter(const Params& params)
        : radius_(params.real("radius", 1, positive, "where the filter ends [pixels]")) {}

    float radius() const override { return radius_; }
    float evaluate(float x) const override { return std::max(0.0f, 1 - std::abs(x) / radius_); }

private:
    float radius_;
};

}  // namespace

const PluginInfo plugin = describe<TentFilter>("a triangle: weights that fall linearly");

}  // namespace lucerna
