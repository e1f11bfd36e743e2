// SPDX-License-Identifier: Apache-2.0
/// constvolume: the same value everywhere.
///
///   value      rgb or float   1   a colour, or the density
///   to_world   transform          places the unit cube, beyond which a medium of it ends
#include "core/interfaces/volume.h"
#include "plugins/volumes/volume_space.h"

namespace lucerna {
namespace {

class ConstVolume final : public Volume {
public:
    explicit ConstVolume(const Params& params)
        : value_(params.rgb("value", Color(1), non_negative, "a colour, or the density")),
          bounds_(volume_transform(params, "from the unit cube, where it ends, to the world")
                      .bounds({.min = Vector3(0), .max = Vector3(1)})) {}

    Color color(Vector3) const override { return value_; }
    float real(Vector3) const override { return luminance(value_); }
    Bounds3 bounds() const override { return bounds_; }
    float max(const Bounds3&) const override { return max_component(value_); }

private:
    Color value_;
    Bounds3 bounds_;
};

}  // namespace

const PluginInfo plugin = describe<ConstVolume>("the same value everywhere");

}  // namespace lucerna
