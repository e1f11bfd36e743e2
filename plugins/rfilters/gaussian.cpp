// SPDX-License-Identifier: Apache-2.0
/// gaussian: a bell that ends at four standard deviations; never rings, blurs a little.
///
///   f(x) = max(0, exp(-x² / 2σ²) - exp(-r² / 2σ²)),   r = 4σ
///
/// The value at the end is subtracted, so that the filter has no step there (pbrt 4e, 8.8.1).
#include "core/interfaces/rfilter.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

class GaussianFilter final : public RFilter {
public:
    explicit GaussianFilter(const Params& params)
        : stddev_(params.real("stddev", 0.5, positive, "standard deviation [pixels]")),
          edge_(bell(radius())) {}

    float radius() const override { return 4 * stddev_; }
    float evaluate(float x) const override { return std::max(0.0f, bell(x) - edge_); }

private:
    float bell(float x) const {
        const float t = x / stddev_;
        return std::exp(-0.5f * t * t);
    }

    float stddev_, edge_;
};

}  // namespace

const PluginInfo plugin = describe<GaussianFilter>("a Gaussian bell, cut at four deviations");

}  // namespace lucerna
