// SPDX-License-Identifier: Apache-2.0
/// Mitsuba's spectrum plugins, `<spectrum type="uniform">` and its kin, as the colours that its RGB
/// variants make of them. `regular`, `irregular` and `blackbody`, which those refuse, become what
/// <spectrum value="400:0.1, …"/> and <blackbody> would.
#pragma once

#include "core/description/description.h"
#include "core/image/spectrum.h"

#include <optional>

namespace lucerna {

/// uniform (value), d65 (color, scale), srgb (color), rawconstant (value), regular
/// (wavelength_min, wavelength_max, values), irregular (wavelengths, values), blackbody
/// (temperature, scale).
bool is_spectrum_plugin(std::string_view type);

/// The colour, or numbers, of one with these properties. Empty if something is wrong, which is
/// reported.
std::optional<PropertyValue> read_spectrum_plugin(std::string_view type, Location type_place,
                                                  const std::vector<Property>& properties,
                                                  SpectrumUse use, Diagnostics& diagnostics);

}  // namespace lucerna
