// SPDX-License-Identifier: Apache-2.0
/// linearcurve: round curves (curves.h), straight pieces between control points, joined by spheres.
///
///   filename   string      required   lines of x y z radius
///   to_world   transform              of control points; radii stay
///
/// Embree meets joints with an absolute tolerance: pieces shorter than 1/1000 of a unit seem
/// thicker there.
#include "plugins/shapes/curves.h"

namespace lucerna {
namespace {

class LinearCurve final : public CurveShape {
public:
    explicit LinearCurve(const Params& params) : CurveShape(params, CurveGeometry::Basis::linear) {}
};

}  // namespace

const PluginInfo plugin = describe<LinearCurve>(
    "round curves: straight pieces between control points, joined by spheres");

}  // namespace lucerna
