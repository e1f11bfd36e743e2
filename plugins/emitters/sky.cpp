// SPDX-License-Identifier: Apache-2.0
/// sky: a clear sky without the sun itself (sun_sky.h).
#include "plugins/emitters/sun_sky.h"

namespace lucerna {
namespace {

class ClearSky final : public SunSky {
public:
    explicit ClearSky(const Params& params) : SunSky(params, "scale", nullptr) {}
};

}  // namespace

const PluginInfo plugin = describe<ClearSky>("a clear sky without the sun");

}  // namespace lucerna
