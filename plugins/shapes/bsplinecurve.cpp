// SPDX-License-Identifier: Apache-2.0
/// bsplinecurve: round curves (curves.h) along uniform cubic B-splines.
///
///   filename   string      required   lines of x y z radius
///   to_world   transform              of control points; radii stay
#include "plugins/shapes/curves.h"

namespace lucerna {
namespace {

class BSplineCurve final : public CurveShape {
public:
    explicit BSplineCurve(const Params& params)
        : CurveShape(params, CurveGeometry::Basis::bspline) {}
};

}  // namespace

const PluginInfo plugin = describe<BSplineCurve>("round curves along uniform cubic B-splines");

}  // namespace lucerna
