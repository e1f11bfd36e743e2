// SPDX-License-Identifier: Apache-2.0
/// The kinds of objects that there are plugins for.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace lucerna {

struct Kind {
    std::string_view name, folder;
    std::string_view default_type;  ///< where one is required and none is given
};

inline constexpr std::array kinds{
    Kind{"integrator", "integrators", "path"}, Kind{"light_sampler", "light_samplers", "cache"},
    Kind{"shape", "shapes", "sphere"},         Kind{"bsdf", "bsdfs", "diffuse"},
    Kind{"emitter", "emitters", "area"},       Kind{"texture", "textures", "checkerboard"},
    Kind{"medium", "media", "homogeneous"},    Kind{"phase", "phases", "isotropic"},
    Kind{"volume", "volumes", "constvolume"},  Kind{"sensor", "sensors", "perspective"},
    Kind{"sampler", "samplers", "sobol"},      Kind{"film", "films", "hdrfilm"},
    Kind{"rfilter", "rfilters", "gaussian"},   Kind{"command", "commands", "render"},
    Kind{"preview", "previews", "tev"},
};

/// Null if there is no such kind.
constexpr const Kind* find_kind(std::string_view name) {
    const auto found = std::ranges::find(kinds, name, &Kind::name);
    return found == kinds.end() ? nullptr : &*found;
}

/// Empty if there is no such kind.
constexpr std::string_view default_type(std::string_view kind) {
    const Kind* const found = find_kind(kind);
    return found ? found->default_type : std::string_view();
}

}  // namespace lucerna
