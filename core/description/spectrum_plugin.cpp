// SPDX-License-Identifier: Apache-2.0
#include "core/description/spectrum_plugin.h"

#include "core/description/values.h"

#include <fmt/format.h>

#include <array>

namespace lucerna {

namespace {

/// The properties of a spectrum, of which each must be asked for. What is wrong is thrown as an
/// Error; `place` is then where it belongs.
class Parts {
public:
    Parts(std::string_view type, Location type_place, const std::vector<Property>& properties)
        : place(type_place), type_(type), type_place_(type_place), properties_(properties) {}

    double number(std::string_view name, std::optional<double> absent = {}) {
        const Property* const p = find(name, !absent);
        if (!p) return absent.value();
        if (const auto* real = std::get_if<double>(&p->value)) return *real;
        if (const auto* whole = std::get_if<std::int64_t>(&p->value)) {
            return static_cast<double>(*whole);
        }
        throw wrong(*p, "a float");
    }

    ColorD color(std::string_view name, std::optional<ColorD> absent = {}) {
        const Property* const p = find(name, !absent);
        if (!p) return absent.value();
        if (const auto* rgb = std::get_if<Rgb>(&p->value)) return rgb->value;
        throw wrong(*p, "an rgb");
    }

    /// One number that stands for three, or three.
    Vector3d numbers(std::string_view name) {
        const Property* const p = find(name, true);
        if (const auto* triple = std::get_if<Triple>(&p->value)) return triple->value;
        if (const auto* rgb = std::get_if<Rgb>(&p->value)) return rgb->value;
        return Vector3d(number(name));
    }

    std::vector<double> list(std::string_view name) {
        const Property* const p = find(name, true);
        const auto* text = std::get_if<std::string>(&p->value);
        if (!text) throw wrong(*p, "a string of numbers");
        return parse_numbers(*text);
    }

    void require_all_known() {
        for (const Property& p : properties_) {
            if (std::find(asked_.begin(), asked_.end(), p.name) != asked_.end()) continue;
            place = p.where;
            throw Error(fmt::format("spectrum \"{}\" has no parameter \"{}\"; it has {}{}", type_,
                                    p.name, join(asked_), did_you_mean(p.name, asked_)));
        }
        place = type_place_;
    }

    Location place;

private:
    const Property* find(std::string_view name, bool required) {
        asked_.emplace_back(name);
        const auto p =
            std::find_if(properties_.begin(), properties_.end(),
                         [&](const Property& property) { return property.name == name; });
        place = p == properties_.end() ? type_place_ : p->where;
        if (p != properties_.end()) return &*p;
        if (!required) return nullptr;
        throw Error(fmt::format("spectrum \"{}\" needs \"{}\"", type_, name));
    }

    Error wrong(const Property& p, std::string_view expected) const {
        return Error(fmt::format("\"{}\" of spectrum \"{}\" must be {}, not {}", p.name, type_,
                                 expected, type_name(p.value)));
    }

    std::string_view type_;
    Location type_place_;
    const std::vector<Property>& properties_;
    std::vector<std::string> asked_;
};

Spectrum regular(Parts& parts) {
    const double first = parts.number("wavelength_min"), last = parts.number("wavelength_max");
    Spectrum spectrum{{}, parts.list("values")};
    const std::size_t count = spectrum.values.size();
    if (count < 2) throw Error("a regular spectrum has two values or more");
    for (std::size_t i = 0; i < count; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(count - 1);
        spectrum.wavelengths.push_back(first + t * (last - first));
    }
    return spectrum;
}

Spectrum irregular(Parts& parts) {
    std::vector<double> wavelengths = parts.list("wavelengths");
    return {std::move(wavelengths), parts.list("values")};
}

constexpr std::array<std::string_view, 7> types = {"blackbody", "d65",  "irregular", "rawconstant",
                                                   "regular",   "srgb", "uniform"};

PropertyValue value_of(std::string_view type, Parts& parts, SpectrumUse use) {
    if (type == "uniform") return Rgb{ColorD(parts.number("value"))};
    if (type == "srgb") return Rgb{parts.color("color")};
    if (type == "rawconstant") return Rgb{parts.numbers("value")};
    if (type == "regular") return Rgb{ColorD(rgb_from_spectrum(regular(parts), use))};
    if (type == "irregular") return Rgb{ColorD(rgb_from_spectrum(irregular(parts), use))};
    const double scale = parts.number("scale", 1.0);
    if (type == "d65") return Rgb{scale * parts.color("color", ColorD(1))};
    return Rgb{scale * ColorD(blackbody(parts.number("temperature")))};
}

}  // namespace

bool is_spectrum_plugin(std::string_view type) {
    return std::find(types.begin(), types.end(), type) != types.end();
}

std::optional<PropertyValue> read_spectrum_plugin(std::string_view type, Location type_place,
                                                  const std::vector<Property>& properties,
                                                  SpectrumUse use, Diagnostics& diagnostics) {
    if (!is_spectrum_plugin(type)) {
        const std::vector<std::string> known(types.begin(), types.end());
        diagnostics.error(type_place,
                          fmt::format("there is no spectrum {}; there are {}{}", quote(type),
                                      join(known), did_you_mean(type, known)));
        return {};
    }
    Parts parts(type, type_place, properties);
    try {
        PropertyValue value = value_of(type, parts, use);
        parts.require_all_known();
        return value;
    } catch (const TransientFileError&) {
        throw;  // no fault of the scene
    } catch (const Error& error) {
        diagnostics.error(parts.place, error.what());
    }
    return {};
}

}  // namespace lucerna
