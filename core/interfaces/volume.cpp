// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/volume.h"

#include "core/description/description.h"
#include "core/plugin/params.h"

#include <fmt/format.h>

namespace lucerna {

Volume::~Volume() = default;

// Here, because only this parameter knows what a volume is.

VolumeInput Params::volume_input(std::string_view name, Color default_value, Range range,
                                 std::string_view doc) const {
    const Color c = default_value;
    const std::string text = c.x == c.y && c.y == c.z
                                 ? fmt::format("{:g}", c.x)
                                 : fmt::format("{:g} {:g} {:g}", c.x, c.y, c.z);
    declare(name, "rgb or volume", text, range, doc);
    if (const Property* property = find(name)) {
        return {Color(color(*property, ColorD(default_value), range)), nullptr};
    }
    return {default_value, static_cast<const Volume*>(named_child(Volume::kind, name, ""))};
}

}  // namespace lucerna
