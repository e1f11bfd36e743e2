// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/volume.h"

#include "core/plugin/params.h"

namespace lucerna {

Volume::~Volume() = default;

// Here, because only this parameter knows what a volume is.

VolumeInput Params::volume_input(std::string_view name, Color default_value, Range range,
                                 std::string_view doc) const {
    const auto [constant, child] = color_or_child(Volume::kind, name, default_value, range, doc);
    const auto* const volume = static_cast<const Volume*>(child);
    if (volume && volume->has_matrices()) {
        error(name, "the volume has six channels, matrices of oriented particles; \"" +
                        std::string(name) + "\" takes one channel, or three");
        return {constant, nullptr};
    }
    return {constant, volume};
}

}  // namespace lucerna
