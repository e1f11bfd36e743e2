// SPDX-License-Identifier: Apache-2.0
/// A value over a surface, and the two inputs through which plugins read it.
#pragma once

#include "core/interfaces/interaction.h"
#include "core/plugin/plugin.h"

namespace lucerna {

class Texture : public Object {
public:
    static constexpr const char* kind = "texture";
    ~Texture() override;

    /// Linear Rec.709 (or raw data) at the surface parameters `uv`.
    virtual Color color(Vector2 uv) const = 0;
    /// One number: the luminance of a colour, of raw data, too.
    virtual float real(Vector2 uv) const = 0;
    /// ∂real/∂u and ∂real/∂v. Central differences unless overridden.
    virtual Vector2 gradient(Vector2 uv) const;
    /// Width over height of the picture; 1 if it is none.
    virtual float aspect() const { return 1; }
    /// Average over the unit square, for power and albedo estimates.
    virtual Color mean() const = 0;
    /// Largest value of any channel, for bounds.
    virtual float max() const = 0;
};

/// A colour that is constant or a texture; a constant costs no call.
struct ColorInput {
    Color constant{0};
    const Texture* texture = nullptr;

    Color operator()(Vector2 uv) const { return texture ? texture->color(uv) : constant; }
    Color mean() const { return texture ? texture->mean() : constant; }
    float max() const { return texture ? texture->max() : max_component(constant); }
};

/// A number that is constant or a texture; a constant costs no call.
struct FloatInput {
    float constant = 0;
    const Texture* texture = nullptr;

    float operator()(Vector2 uv) const { return texture ? texture->real(uv) : constant; }
    float mean() const { return texture ? luminance(texture->mean()) : constant; }
};

}  // namespace lucerna
