// SPDX-License-Identifier: Apache-2.0
/// sun: the sun as it is seen through clear air, without the sky (sun_sky.h).
#include "plugins/emitters/sun_sky.h"

namespace lucerna {
namespace {

class Sun final : public SunSky {
public:
    explicit Sun(const Params& params) : SunSky(params, nullptr, "scale") {}
};

}  // namespace

const PluginInfo plugin = describe<Sun>("the sun as it is seen through clear air");

}  // namespace lucerna
