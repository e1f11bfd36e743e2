// SPDX-License-Identifier: Apache-2.0
/// volume: a surface shows the volume that it lies in, whatever its texture coordinates are.
///
/// The volume is placed in the world by its own `to_world`; beyond its bounds, a grid goes on as
/// its `wrap_mode` says.
#include "core/interfaces/volume.h"
#include "core/interfaces/texture.h"

namespace lucerna {
namespace {

class VolumeTexture final : public Texture {
public:
    explicit VolumeTexture(const Params& params)
        : volume_(
              params.volume_input("volume", Color(0.75f), any_value, "what the surface shows")) {}

    Color color_at(const Interaction& at) const override { return volume_.color(at.p); }
    float real_at(const Interaction& at) const override { return volume_.real(at.p); }
    std::string_view attribute() const override { return volume_.volume ? "position" : ""; }

    // Without a place, only bounds are known.
    Color color(Vector2) const override { return mean(); }
    float real(Vector2) const override { return luminance(mean()); }
    Vector2 gradient(Vector2) const override { return Vector2(0); }
    Color mean() const override { return volume_.volume ? Color(0.5f * max()) : volume_.constant; }
    float max() const override { return volume_.max(volume_.bounds()); }

private:
    VolumeInput volume_;
};

}  // namespace

const PluginInfo plugin = describe<VolumeTexture>("the values of a volume where the surface lies");

}  // namespace lucerna
