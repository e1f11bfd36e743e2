// SPDX-License-Identifier: Apache-2.0
/// What plugins and parameters that were taken away have been replaced by, for errors.
#pragma once

#include <string>
#include <string_view>

namespace lucerna {

struct FormerName {
    std::string_view kind, name, today;
};

inline constexpr FormerName former_parameters[] = {
    {"light_sampler", "light_samples",
     "the integrator's \"emitter_samples\" says how many lights are sampled at a point"},
    {"light_sampler", "remember_all",
     "a cell remembers \"clusters\", however many lights there are"},
};
inline constexpr FormerName former_plugins[] = {
    {"light_sampler", "all",
     "\"uniform\" visits every light if the integrator's \"emitter_samples\" is their number"},
};

/// "; " and what to write instead, or nothing.
template <typename Names>
std::string advice_for_former(const Names& names, std::string_view kind, std::string_view name) {
    for (const FormerName& former : names) {
        if (former.kind == kind && former.name == name) return "; " + std::string(former.today);
    }
    return {};
}

}  // namespace lucerna
