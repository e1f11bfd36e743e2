// SPDX-License-Identifier: Apache-2.0
/// Materials by name: metals with their complex index of refraction, and transparent substances.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/math/vector.h"

namespace lucerna {

/// The complex index of refraction η + i k for red, green and blue.
struct ConductorData {
    Color eta;
    Color k;
};

/// The data of a conductor by Mitsuba's name ("Cu", "Au_palik", …). "none" reflects everything.
/// Empty if there is none of that name.
std::optional<ConductorData> conductor(std::string_view name);
std::vector<std::string> conductor_names();

/// Index of refraction at 589 nm by Mitsuba's name ("bk7", "water", "fused quartz", …), whatever
/// the case of the letters. Empty if there is none of that name.
std::optional<double> dielectric_ior(std::string_view name);
std::vector<std::string> dielectric_names();

}  // namespace lucerna
