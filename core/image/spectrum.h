// SPDX-License-Identifier: Apache-2.0
/// From spectra to linear Rec.709, which is what the renderer calculates with.
///
/// The conventions are those of Mitsuba 3's RGB mode, so that scenes keep their look. With the CIE
/// 1931 colour matching functions x̄, ȳ, z̄ and the spectrum s, zero outside its range:
///
///   emission      XYZ = ∫ s (x̄, ȳ, z̄) dλ / ∫ ȳ dλ. A constant spectrum is the equal-energy
///                 white, RGB (1.205, 0.948, 0.909), which has luminance 1.
///   reflectance   as seen under D65: RGB of ∫ s D65 (x̄, ȳ, z̄) dλ, each channel divided by what
///                 s = 1 gives. A constant spectrum c gives (c, c, c) exactly.
///   quantity      as a reflectance, but without a bound: an index of refraction, an extinction.
///
/// The tables of metals follow `emission`, as Mitsuba's do.
/// Colours outside the gamut are clamped at 0, reflectances also at 1.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "core/math/vector.h"

namespace lucerna {

/// Values at wavelengths; linear in between, zero outside. A single value holds everywhere, and
/// then has no wavelength.
struct Spectrum {
    std::vector<double> wavelengths;  ///< nm, rising
    std::vector<double> values;

    double at(double wavelength) const;
};

enum class SpectrumUse { emission, reflectance, quantity };

/// Linear Rec.709 of a spectrum. Throws Error if its wavelengths do not rise, or the numbers of
/// wavelengths and values do not fit.
Color rgb_from_spectrum(const Spectrum& spectrum, SpectrumUse use);

/// What each value of a reflectance contributes: its linear Rec.709 is the sum of values[i] times
/// the i-th result, without clamping. For many spectra at the same wavelengths [nm], which rise.
std::vector<ColorD> rgb_of_reflectances(const std::vector<double>& wavelengths);

/// Radiance of a black body [W/(m² sr nm), as `emission`] by Planck's law with the constants of
/// CODATA 2018: luminance in cd/m² is 683 · 106.86 times that of the result.
/// Throws Error unless 0 < kelvin < ∞.
Color blackbody(double kelvin);

/// Reads "wavelength value" lines of a text file (.spd); # begins a comment. Throws FileError with
/// the number of the line for anything else, for values that are not finite and for wavelengths
/// that do not rise.
Spectrum read_spectrum(const std::filesystem::path& path);

/// The same from memory; `name` is what errors call it.
Spectrum parse_spectrum(std::string_view text, const std::string& name);

}  // namespace lucerna
