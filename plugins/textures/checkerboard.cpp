// SPDX-License-Identifier: Apache-2.0
/// checkerboard: squares of two colours, two by two of them in the unit square.
///
/// color0 lies where the fractions of u and 1 − v, mapped by to_uv, are both above 1/2 or both not.
#include "plugins/textures/uv_transform.h"

#include "core/interfaces/texture.h"

namespace lucerna {

namespace {

class Checkerboard final : public Texture {
public:
    explicit Checkerboard(const Params& params)
        : color0_(params.color_input("color0", Color(0.4f), any_value, "of the first square")),
          color1_(params.color_input("color1", Color(0.2f), any_value, "of its neighbours")),
          to_uv_(params.transform("to_uv", "maps u and v")) {}

    Color color(Vector2 uv) const override {
        const ColorInput& at = input(uv);
        return at.texture ? at.texture->color(uv) : at.constant;
    }
    Color color_at(const Interaction& at) const override { return input(at.uv)(at); }
    float real_at(const Interaction& at) const override {
        const ColorInput& here = input(at.uv);
        return here.texture ? here.texture->real_at(at) : luminance(here.constant);
    }
    float real(Vector2 uv) const override {
        const ColorInput& at = input(uv);
        return at.texture ? at.texture->real(uv) : luminance(at.constant);
    }
    /// Gradient of the colours; the edges between them have none.
    Vector2 gradient(Vector2 uv) const override {
        const ColorInput& at = input(uv);
        return at.texture ? at.texture->gradient(uv) : Vector2(0);
    }
    Color mean() const override { return 0.5f * (color0_.mean() + color1_.mean()); }
    float max() const override { return std::max(color0_.max(), color1_.max()); }

private:
    const ColorInput& input(Vector2 uv) const {
        const Vector2 p = to_uv_(uv);
        const bool x_high = p.x - std::floor(p.x) > 0.5f, y_high = p.y - std::floor(p.y) > 0.5f;
        return x_high == y_high ? color0_ : color1_;
    }

    ColorInput color0_, color1_;
    UVTransform to_uv_;
};

}  // namespace

const PluginInfo plugin = describe<Checkerboard>("squares of two colours");

}  // namespace lucerna
