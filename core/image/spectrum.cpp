// SPDX-License-Identifier: Apache-2.0
#include "core/image/spectrum.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "core/base/error.h"
#include "core/base/file_bytes.h"
#include "core/image/cie_tables.h"
#include "core/image/color.h"

namespace lucerna {

namespace {

/// The middles of steps of 0.5 nm: fine enough that the knots of spectra need no care.
constexpr int quadrature_points = 940;
constexpr double quadrature_step = (cie_last - cie_first) / quadrature_points;

CieSample cie_at(double wavelength) {
    const double t = (wavelength - cie_first) / cie_step;
    const std::size_t i = std::min(static_cast<std::size_t>(t), cie_table.size() - 2);
    const double w = t - static_cast<double>(i);
    const CieSample &a = cie_table[i], &b = cie_table[i + 1];
    return {std::lerp(a.x, b.x, w), std::lerp(a.y, b.y, w), std::lerp(a.z, b.z, w),
            std::lerp(a.d65, b.d65, w)};
}

/// ∫ s (x̄, ȳ, z̄) dλ, or under D65.
template <typename F>
Vector3d integrate(const F& spectrum, bool under_d65) {
    Vector3d sum(0);
    for (int i = 0; i < quadrature_points; ++i) {
        const double wavelength = cie_first + (i + 0.5) * quadrature_step;
        const CieSample cie = cie_at(wavelength);
        const double value = spectrum(wavelength) * (under_d65 ? cie.d65 : 1.0);
        sum += value * Vector3d(cie.x, cie.y, cie.z);
    }
    return sum * quadrature_step;
}

constexpr auto constant_one = [](double) { return 1.0; };

/// Rec.709 of the reflectance 1, before it is made white.
const Vector3d& white_of_reflectances() {
    static const Vector3d white = rec709_from_xyz * integrate(constant_one, true);
    return white;
}

template <typename F>
Color convert(const F& spectrum, SpectrumUse use) {
    if (use != SpectrumUse::emission) {
        const Vector3d rgb = rec709_from_xyz * integrate(spectrum, true) / white_of_reflectances();
        const double largest = use == SpectrumUse::reflectance ? 1 : infinity;
        return Color(glm::clamp(rgb, Vector3d(0), Vector3d(largest)));
    }
    static const double luminance_of_one = integrate(constant_one, false).y;
    const Vector3d rgb = rec709_from_xyz * integrate(spectrum, false) / luminance_of_one;
    return Color(glm::max(rgb, Vector3d(0)));
}

/// Index of the first wavelength that is not above the one before, or 0 if there is none.
std::size_t first_not_rising(const std::vector<double>& wavelengths) {
    for (std::size_t i = 1; i < wavelengths.size(); ++i) {
        if (!(wavelengths[i] > wavelengths[i - 1])) return i;
    }
    return 0;
}

/// Takes the next number off the front of `line`; false if there is none.
bool take_number(std::string_view& line, double& value) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t\r"), line.size()));
    const auto [end, code] = std::from_chars(line.data(), line.data() + line.size(), value);
    if (code != std::errc() || !std::isfinite(value)) return false;
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    return line.empty() || std::strchr(" \t\r", line.front());
}

}  // namespace

double Spectrum::at(double wavelength) const {
    if (wavelengths.empty()) return values.empty() ? 0 : values.front();
    if (!(wavelength >= wavelengths.front() && wavelength <= wavelengths.back())) return 0;
    const auto above = std::upper_bound(wavelengths.begin(), wavelengths.end(), wavelength);
    if (above == wavelengths.end()) return values.back();
    const auto i = static_cast<std::size_t>(above - wavelengths.begin());
    const double width = wavelengths[i] - wavelengths[i - 1];
    return std::lerp(values[i - 1], values[i], (wavelength - wavelengths[i - 1]) / width);
}

Color rgb_from_spectrum(const Spectrum& spectrum, SpectrumUse use) {
    const std::size_t knots = spectrum.wavelengths.size(), values = spectrum.values.size();
    const bool constant = knots == 0 && values == 1;
    if (!constant && (knots < 2 || knots != values)) {
        throw Error(
            fmt::format("a spectrum needs one value, or at least two wavelengths with one value "
                        "each; it has {} "
                        "wavelengths and {} values",
                        knots, values));
    }
    if (const std::size_t i = first_not_rising(spectrum.wavelengths)) {
        throw Error(fmt::format("the wavelengths of a spectrum must rise, but {} nm follows {} nm",
                                spectrum.wavelengths[i], spectrum.wavelengths[i - 1]));
    }
    // Not left to the quadrature, so that it is exact.
    if (constant && use != SpectrumUse::emission) {
        const double largest = use == SpectrumUse::reflectance ? 1 : infinity;
        return Color(static_cast<float>(std::clamp(spectrum.values[0], 0.0, largest)));
    }
    return convert([&](double wavelength) { return spectrum.at(wavelength); }, use);
}

std::vector<ColorD> rgb_of_reflectances(const std::vector<double>& wavelengths) {
    std::vector<ColorD> result(wavelengths.size(), ColorD(0));
    for (int i = 0; i < quadrature_points; ++i) {
        const double wavelength = cie_first + (i + 0.5) * quadrature_step;
        const auto above = std::upper_bound(wavelengths.begin(), wavelengths.end(), wavelength);
        if (above == wavelengths.begin() || above == wavelengths.end()) continue;
        const auto k = static_cast<std::size_t>(above - wavelengths.begin());
        const double t = (wavelength - wavelengths[k - 1]) / (wavelengths[k] - wavelengths[k - 1]);
        const CieSample cie = cie_at(wavelength);
        const ColorD light = rec709_from_xyz * (cie.d65 * Vector3d(cie.x, cie.y, cie.z)) *
                             quadrature_step / white_of_reflectances();
        result[k - 1] += (1 - t) * light;
        result[k] += t * light;
    }
    return result;
}

Color blackbody(double kelvin) {
    if (!(kelvin > 0) || !std::isfinite(kelvin)) {
        throw Error(fmt::format("a temperature of {} K; it must be above 0 and finite", kelvin));
    }
    constexpr double h = 6.62607015e-34, c = 299792458, k = 1.380649e-23;
    const auto planck = [kelvin](double nanometres) {
        const double lambda = nanometres * 1e-9;
        const double exponent = h * c / (lambda * k * kelvin);
        return 1e-9 * 2 * h * c * c / (std::pow(lambda, 5) * std::expm1(exponent));
    };
    return convert(planck, SpectrumUse::emission);
}

Spectrum parse_spectrum(std::string_view text, const std::string& name) {
    Spectrum spectrum;
    int number = 0;
    text = without_byte_order_mark(text);
    while (!text.empty()) {
        ++number;
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        line = line.substr(0, line.find('#'));
        if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
        double wavelength = 0, value = 0;
        if (!take_number(line, wavelength) || !take_number(line, value) ||
            line.find_first_not_of(" \t\r") != std::string_view::npos) {
            // The line is not shown: the file may be none that the author of the scene could read.
            throw FileError(
                fmt::format("{}:{}: this is not a wavelength and a value: two finite "
                            "numbers with a space between them are expected",
                            name, number));
        }
        if (!spectrum.wavelengths.empty() && wavelength <= spectrum.wavelengths.back()) {
            throw FileError(fmt::format("{}:{}: wavelengths must rise, but {} nm follows {} nm",
                                        name, number, wavelength, spectrum.wavelengths.back()));
        }
        spectrum.wavelengths.push_back(wavelength);
        spectrum.values.push_back(value);
    }
    if (spectrum.values.size() < 2) {
        throw FileError(
            fmt::format("{}: has {} lines with a wavelength and a value; at least two "
                        "are needed",
                        name, spectrum.values.size()));
    }
    return spectrum;
}

Spectrum read_spectrum(const std::filesystem::path& path) {
    const std::vector<std::uint8_t> bytes = read_file_bytes(path);
    return parse_spectrum({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                          path.string());
}

}  // namespace lucerna
