// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/texture.h"

#include "core/description/description.h"
#include "core/plugin/params.h"

#include <fmt/format.h>

namespace lucerna {

Texture::~Texture() = default;

Vector2 Texture::gradient(Vector2 uv) const {
    constexpr float step = 0x1p-10f;  // a power of two: uv ± step are exact in the unit square
    const float along_u = real(uv + Vector2(step, 0)) - real(uv - Vector2(step, 0));
    const float along_v = real(uv + Vector2(0, step)) - real(uv - Vector2(0, step));
    return Vector2(along_u, along_v) / (2 * step);
}

// Here, because only these parameters know what a texture is.

ColorInput Params::color_input(std::string_view name, Color default_value, Range range,
                               std::string_view doc) const {
    const auto [constant, child] = color_or_child(Texture::kind, name, default_value, range, doc);
    return {constant, static_cast<const Texture*>(child)};
}

FloatInput Params::float_input(std::string_view name, float default_value, Range range,
                               std::string_view doc) const {
    declare(name, "float or texture", fmt::format("{:g}", default_value), range, doc);
    if (const Property* property = find(name)) {
        if (std::holds_alternative<Rgb>(property->value)) {
            return {luminance(Color(color(*property, ColorD(default_value), range))), nullptr};
        }
        return {static_cast<float>(number(*property, default_value, range)), nullptr};
    }
    return {default_value, static_cast<const Texture*>(named_child(Texture::kind, name, ""))};
}

}  // namespace lucerna
