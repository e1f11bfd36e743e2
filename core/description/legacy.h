// SPDX-License-Identifier: Apache-2.0
/// Scenes that were written for Mitsuba before version 2: what has been renamed since.
#pragma once

#include "core/description/description.h"

namespace lucerna {

/// "toWorld" becomes "to_world", "intIOR" becomes "int_ior".
std::string legacy_name(std::string_view name);

/// The name of a plugin: capitals become small letters.
std::string legacy_type(std::string_view type);

/// "lookAt" becomes "lookat"; other tags kept their names.
std::string_view legacy_tag(std::string_view tag);

/// Renames parameters that are called differently today, and makes one transform `to_uv` of the
/// scale and offset of texture coordinates: u' = uscale·u + uoffset, as Mitsuba 0.6 had it.
void upgrade_legacy(Element& element, Diagnostics& diagnostics);

}  // namespace lucerna
