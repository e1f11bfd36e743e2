// SPDX-License-Identifier: Apache-2.0
/// Values from text: numbers, vectors, colours, spectra, matrices. Strict (the whole text counts,
/// every number is finite) and independent of the locale.
///
/// All functions throw Error with a message that quotes the text; the caller adds the place.
#pragma once

#include "core/base/error.h"
#include "core/image/spectrum.h"
#include "core/math/vector.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// "true" or "false", in small letters or capitals.
bool parse_boolean(std::string_view text);
/// Decimal, 64 bit.
std::int64_t parse_integer(std::string_view text);
/// A number that a float can hold: neither overflow nor a vanishing of what is not zero.
double parse_float(std::string_view text);
/// Numbers between spaces or single commas; a comma may stand behind the last. What vanishes in a
/// float is taken as it is: exporters write such entries into matrices.
std::vector<double> parse_numbers(std::string_view text);
/// "x y z" or "x, y, z".
Vector3d parse_triple(std::string_view text);
/// Linear "r g b", one grey value, or "#rrggbb", which is decoded from sRGB.
ColorD parse_rgb(std::string_view text);
/// The same, but "#rrggbb" is linear, too: as in scenes for Mitsuba before version 2.
ColorD parse_linear_rgb(std::string_view text);
/// The same as parse_rgb, but plain numbers are sRGB-encoded, too.
ColorD parse_srgb(std::string_view text);
/// 16 numbers, or 9 for the upper left 3×3 part; row by row.
Matrix4d parse_matrix(std::string_view text);

/// "400:0.1, 500:0.2": values at rising wavelengths [nm].
Spectrum parse_spectrum_list(std::string_view text);

/// Without white space at both ends.
std::string_view trimmed(std::string_view text);

}  // namespace lucerna
