// SPDX-License-Identifier: Apache-2.0
/// sunsky: a clear sky and the sun in it (sun_sky.h).
#include "plugins/emitters/sun_sky.h"

namespace lucerna {
namespace {

class ClearDay final : public SunSky {
public:
    explicit ClearDay(const Params& params) : SunSky(params, "sky_scale", "sun_scale") {}
};

}  // namespace

const PluginInfo plugin = describe<ClearDay>("a clear sky with the sun");

}  // namespace lucerna
