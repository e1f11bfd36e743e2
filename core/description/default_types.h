// SPDX-License-Identifier: Apache-2.0
/// The plugins that stand for a kind where one is required and none is given.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace lucerna {

struct DefaultType {
    std::string_view kind, type;
};

inline constexpr std::array default_types{
    DefaultType{"integrator", "path"},    DefaultType{"light_sampler", "cache"},
    DefaultType{"shape", "sphere"},       DefaultType{"bsdf", "diffuse"},
    DefaultType{"emitter", "area"},       DefaultType{"texture", "checkerboard"},
    DefaultType{"medium", "homogeneous"}, DefaultType{"phase", "isotropic"},
    DefaultType{"volume", "constvolume"}, DefaultType{"sensor", "perspective"},
    DefaultType{"sampler", "sobol"},      DefaultType{"film", "hdrfilm"},
    DefaultType{"rfilter", "gaussian"},   DefaultType{"command", "render"},
    DefaultType{"preview", "tev"},
};

/// Empty if there is no such kind.
constexpr std::string_view default_type(std::string_view kind) {
    const auto found = std::ranges::find(default_types, kind, &DefaultType::kind);
    return found == default_types.end() ? std::string_view() : found->type;
}

}  // namespace lucerna
