// SPDX-License-Identifier: Apache-2.0
/// mitchell: a compromise between sharpness, blur and ringing.
///
/// The piecewise cubic of Mitchell and Netravali 1988; B = C = 1/3 is what they recommend, B = 1,
/// C = 0 the cubic B-spline, B = 0, C = 1/2 Catmull and Rom's spline.
#include "plugins/rfilters/cubic.h"

#include "core/interfaces/rfilter.h"

namespace lucerna {

namespace {

class MitchellFilter final : public RFilter {
public:
    explicit MitchellFilter(const Params& params)
        : b_(params.real("B", 1.0 / 3, unit_interval, "blur")),
          c_(params.real("C", 1.0 / 3, unit_interval, "ringing")) {}

    float radius() const override { return 2; }
    float evaluate(float x) const override { return cubic_filter(x, b_, c_); }

private:
    float b_, c_;
};

}  // namespace

const PluginInfo plugin = describe<MitchellFilter>("Mitchell and Netravali's piecewise cubic");

}  // namespace lucerna
