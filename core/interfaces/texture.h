// SPDX-License-Identifier: Apache-2.0
/// A value over a surface, and the two inputs through which plugins read it.
#pragma once

#include "core/interfaces/interaction.h"
#include "core/plugin/plugin.h"

#include <string_view>

namespace lucerna {

class Texture : public Object {
public:
    static constexpr const char* kind = "texture";
    ~Texture() override;

    /// Linear Rec.709 (or raw data) at the surface parameters `uv`.
    virtual Color color(Vector2 uv) const = 0;
    /// One number: the luminance of a colour, of raw data, too.
    virtual float real(Vector2 uv) const = 0;
    /// The same at a point of a surface, which differ for textures that read more than `uv` of it.
    virtual Color color_at(const Interaction& at) const { return color(at.uv); }
    virtual float real_at(const Interaction& at) const { return real(at.uv); }
    /// What it reads of the surface: "position", a Shape::attribute, or, if it is empty, only uv.
    virtual std::string_view attribute() const { return {}; }
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

    Color operator()(const Interaction& at) const {
        return texture ? texture->color_at(at) : constant;
    }
    Color mean() const { return texture ? texture->mean() : constant; }
    float max() const { return texture ? texture->max() : max_component(constant); }
};

/// A number that is constant or a texture; a constant costs no call.
struct FloatInput {
    float constant = 0;
    const Texture* texture = nullptr;

    float operator()(const Interaction& at) const {
        return texture ? texture->real_at(at) : constant;
    }
    float mean() const { return texture ? luminance(texture->mean()) : constant; }
};

}  // namespace lucerna
