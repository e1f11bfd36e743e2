// SPDX-License-Identifier: Apache-2.0
/// catmullrom: the spline of Catmull and Rom 1974: sharper than `mitchell`, rings more.
#include "plugins/rfilters/cubic.h"

#include "core/interfaces/rfilter.h"

namespace lucerna {

namespace {

class CatmullRomFilter final : public RFilter {
public:
    explicit CatmullRomFilter(const Params&) {}

    float radius() const override { return 2; }
    float evaluate(float x) const override { return cubic_filter(x, 0, 0.5f); }
};

}  // namespace

const PluginInfo plugin = describe<CatmullRomFilter>("Catmull and Rom's piecewise cubic");

}  // namespace lucerna
