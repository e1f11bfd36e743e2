// SPDX-License-Identifier: Apache-2.0
#include "core/description/property_reader.h"

#include "core/base/find_file.h"
#include "core/description/legacy.h"
#include "core/description/spectrum_plugin.h"
#include "core/description/values.h"
#include "core/image/spectrum.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>

namespace lucerna {

namespace {

using AttributeTable = std::map<std::string_view, AcceptedAttributes>;

const AttributeTable& property_tags() {
    static const AttributeTable table = {
        {"boolean", {{"name", "value"}, {}}},
        {"integer", {{"name", "value"}, {}}},
        {"float", {{"name", "value"}, {}}},
        {"string", {{"name", "value"}, {}}},
        {"point", {{"name"}, {"value", "x", "y", "z"}}},
        {"vector", {{"name"}, {"value", "x", "y", "z"}}},
        {"rgb", {{"name", "value"}, {}}},
        {"srgb", {{"name", "value"}, {}}},
        {"spectrum", {{"name"}, {"value", "filename"}}},
        {"blackbody", {{"name", "temperature"}, {"scale"}}},
        {"transform", {{"name"}, {}}},
    };
    return table;
}

const AttributeTable& step_tags() {
    static const AttributeTable table = {
        {"translate", {{}, {"value", "x", "y", "z"}}},
        {"scale", {{}, {"value", "x", "y", "z"}}},
        {"rotate", {{"angle"}, {"value", "x", "y", "z"}}},
        {"lookat", {{"origin", "target"}, {"up"}}},
        {"matrix", {{"value"}, {}}},
    };
    return table;
}

std::vector<std::string> keys(const AttributeTable& table) {
    std::vector<std::string> names;
    for (const auto& [tag, attributes] : table) names.emplace_back(tag);
    return names;
}

/// A vector across `view`: the first axis of the frame around it (Duff et al. 2017, "Building an
/// Orthonormal Basis, Revisited").
Vector3d axis_beside(Vector3d view) {
    const Vector3d n = view / glm::length(view);
    const double sign = std::copysign(1.0, n.z);
    const double a = -1 / (sign + n.z);
    return {1 + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x};
}

bool is_finite(const Matrix4d& matrix) {
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            if (!std::isfinite(matrix[column][row])) return false;
        }
    }
    return true;
}

/// What the values of a spectrum are, by the name of the parameter, or if that is "value", by that
/// of the object.
SpectrumUse spectrum_use(const Tag& tag, const ReadContext& context) {
    if (context.in_emitter) return SpectrumUse::emission;
    const std::string_view name = tag.value("name");
    const bool unbounded =
        name == "value"
            ? context.in_quantity
            : PropertyReader::is_quantity(context.legacy ? legacy_name(name) : std::string(name));
    return unbounded ? SpectrumUse::quantity : SpectrumUse::reflectance;
}

}  // namespace

bool PropertyReader::is_property(std::string_view tag) { return property_tags().contains(tag); }
bool PropertyReader::is_transform_step(std::string_view tag) { return step_tags().contains(tag); }
bool PropertyReader::is_quantity(std::string_view name) {
    constexpr std::array<std::string_view, 6> quantities = {"eta",     "k",       "emission",
                                                            "sigma_a", "sigma_s", "sigma_t"};
    return std::ranges::find(quantities, name) != quantities.end();
}
std::vector<std::string> PropertyReader::tags() { return keys(property_tags()); }

template <typename Parse>
auto PropertyReader::attempt(const Tag& tag, std::string_view attribute, Parse parse)
    -> std::optional<decltype(parse())> {
    try {
        return parse();
    } catch (const TransientFileError&) {
        throw;  // no fault of the scene
    } catch (const Error& error) {
        diagnostics_.error(tag.where(attribute), error.what());
    } catch (const std::invalid_argument& error) {  // of Transform
        diagnostics_.error(tag.where(attribute), error.what());
    }
    return {};
}

std::optional<PropertyValue> PropertyReader::read(const Tag& tag, const ReadContext& context) {
    if (tag.name == "spectrum" && tag.has("type")) {
        return read_spectrum_object(tag, context);
    }
    if (!check_property(tag, context)) return {};
    if (tag.name == "transform") return read_transform(tag, context);
    if (const XmlElement inner = tag.element.first_child()) {
        diagnostics_.error({tag.source, inner.offset()},
                           fmt::format("<{}> takes no elements", tag.name));
        return {};
    }
    if (tag.name == "spectrum") return read_spectrum_tag(tag, context);
    if (tag.name == "blackbody") return read_blackbody(tag);
    if (tag.name == "point" || tag.name == "vector") {
        const std::optional<Vector3d> value = read_triple(tag, 0.0);
        return value ? std::optional<PropertyValue>(Triple{*value}) : std::nullopt;
    }
    return attempt(tag, "value", [&]() -> PropertyValue {
        const std::string_view value = tag.value("value");
        if (tag.name == "boolean") return parse_boolean(value);
        if (tag.name == "integer") return parse_integer(value);
        if (tag.name == "float") return parse_float(value);
        if (tag.name == "rgb") {
            return Rgb{context.legacy ? parse_linear_rgb(value) : parse_rgb(value)};
        }
        if (tag.name == "srgb") return Rgb{parse_srgb(value)};
        return std::string(value);
    });
}

bool PropertyReader::check_property(const Tag& tag, const ReadContext& context) {
    AcceptedAttributes accepted = property_tags().at(tag.name);
    const bool may_have_intent = tag.name == "rgb" || (tag.name == "spectrum" && tag.has("value"));
    if (context.legacy && may_have_intent) accepted.optional.emplace_back("intent");
    if (!check_attributes(tag, accepted, diagnostics_)) return false;
    if (!tag.has("intent")) return true;
    // How a spectrum would be made of the colour; here it stays one.
    const std::string_view intent = tag.value("intent");
    if (intent == "reflectance" || intent == "illuminant") return true;
    diagnostics_.error(tag.where("intent"),
                       fmt::format("expected reflectance or illuminant, not {}", quote(intent)));
    return false;
}

std::optional<Vector3d> PropertyReader::read_triple(const Tag& tag, double absent) {
    const bool has_components = tag.has("x") || tag.has("y") || tag.has("z");
    if (tag.has("value") == has_components) {
        diagnostics_.error(tag.where(), fmt::format("<{}> needs either \"value\" or some of "
                                                    "\"x\", \"y\", \"z\"",
                                                    tag.name));
        return {};
    }
    if (tag.has("value")) {
        return attempt(tag, "value", [&] {
            // One number may stand for three equal ones.
            const std::vector<double> numbers = parse_numbers(tag.value("value"));
            if (numbers.size() == 1) return Vector3d(numbers[0]);
            return parse_triple(tag.value("value"));
        });
    }
    Vector3d result(absent);
    bool valid = true;
    for (int i = 0; i < 3; ++i) {
        const std::string_view axis =
            std::string_view("xyz").substr(static_cast<std::size_t>(i), 1);
        if (!tag.has(axis)) continue;
        const auto number = attempt(tag, axis, [&] { return parse_float(tag.value(axis)); });
        valid = valid && number;
        result[i] = number.value_or(0.0);
    }
    return valid ? std::optional(result) : std::nullopt;
}

std::optional<Rgb> PropertyReader::read_spectrum_tag(const Tag& tag, const ReadContext& context) {
    if (tag.has("value") == tag.has("filename")) {
        diagnostics_.error(tag.where(), "<spectrum> needs either \"value\" or \"filename\"");
        return {};
    }
    const char* const attribute = tag.has("value") ? "value" : "filename";
    return attempt(tag, attribute, [&]() -> Rgb {
        const std::string_view text = tag.value(attribute);
        const SpectrumUse use = spectrum_use(tag, context);
        if (tag.has("filename")) {
            const std::filesystem::path path = find_file(text, description_.search_paths);
            description_.found_files.push_back({tag.where(attribute), path.string()});
            return {ColorD(rgb_from_spectrum(read_spectrum(path), use))};
        }
        if (text.find(':') == std::string_view::npos) {
            // Mitsuba 0.6 as it was distributed had three samples of a spectrum: R, G and B.
            if (context.legacy) return {parse_linear_rgb(text)};
            // As light, Mitsuba 3 takes it for equal energy at all wavelengths; before, for white.
            const Color one = context.in_emitter ? rgb_from_spectrum({{}, {1}}, use) : Color(1);
            return {parse_float(text) * ColorD(one)};
        }
        return {ColorD(rgb_from_spectrum(parse_spectrum_list(text), use))};
    });
}

std::optional<PropertyValue> PropertyReader::read_spectrum_object(const Tag& tag,
                                                                  const ReadContext& context) {
    if (!check_attributes(tag, {{"name", "type"}, {}}, diagnostics_)) return {};
    std::vector<Property> properties;
    bool valid = true;
    for (XmlElement child = tag.element.first_child(); child; child = child.next_sibling()) {
        const Tag inner = read_tag(child, context, definitions_);
        if (!is_property(inner.name) || inner.has("type")) {
            diagnostics_.error(inner.where(), fmt::format("<{}> is no part of a spectrum; it takes "
                                                          "<float>, <string>, <rgb> and the like",
                                                          inner.name));
            valid = false;
            continue;
        }
        std::optional<PropertyValue> value;
        if (inner.complete) value = read(inner, context);
        valid = valid && value;
        if (!value) continue;
        properties.push_back({std::string(inner.value("name")), std::move(*value), inner.where()});
    }
    if (!valid) return {};
    return read_spectrum_plugin(tag.value("type"), tag.where("type"), properties,
                                spectrum_use(tag, context), diagnostics_);
}

std::optional<Rgb> PropertyReader::read_blackbody(const Tag& tag) {
    const auto temperature = attempt(tag, "temperature", [&] {
        std::string_view text = trimmed(tag.value("temperature"));
        if (text.ends_with('K') || text.ends_with('k')) text.remove_suffix(1);
        const double kelvin = parse_float(text);
        if (!(kelvin > 0)) throw Error(fmt::format("{} K is no temperature above zero", kelvin));
        return kelvin;
    });
    const auto scale = attempt(
        tag, "scale", [&] { return tag.has("scale") ? parse_float(tag.value("scale")) : 1.0; });
    if (!temperature || !scale) return {};
    return attempt(tag, "temperature",
                   [&] { return Rgb{ColorD(blackbody(*temperature)) * *scale}; });
}

std::optional<Transform> PropertyReader::read_transform(const Tag& tag,
                                                        const ReadContext& context) {
    Transform total;
    bool valid = true;
    for (XmlElement child = tag.element.first_child(); child; child = child.next_sibling()) {
        const Tag step = read_tag(child, context, definitions_);
        const auto known = step_tags().find(step.name);
        if (known == step_tags().end()) {
            const std::vector<std::string> names = keys(step_tags());
            diagnostics_.error(step.where(),
                               fmt::format("<{}> is no part of a transform; there are {}{}",
                                           step.name, join(names), did_you_mean(step.name, names)));
            valid = false;
            continue;
        }
        std::optional<Transform> next;
        if (step.complete && check_attributes(step, known->second, diagnostics_))
            next = read_step(step);
        valid = valid && next;
        if (next) total = *next * total;
    }
    if (valid && !(is_finite(total.matrix()) && is_finite(total.inverse_matrix()))) {
        diagnostics_.error(tag.where(), "the transform is too large for numbers");
        valid = false;
    }
    return valid ? std::optional(total) : std::nullopt;
}

std::optional<Transform> PropertyReader::read_step(const Tag& tag) {
    if (tag.name == "rotate") return read_rotation(tag);
    if (tag.name == "lookat") return read_look_at(tag);
    if (tag.name == "matrix") {
        return attempt(tag, "value", [&] { return Transform(parse_matrix(tag.value("value"))); });
    }
    const bool scales = tag.name == "scale";
    const std::optional<Vector3d> v = read_triple(tag, scales ? 1.0 : 0.0);
    if (!v) return {};
    const char* const attribute = tag.has("value") ? "value" : "";
    return attempt(tag, attribute,
                   [&] { return scales ? Transform::scale(*v) : Transform::translate(*v); });
}

std::optional<Transform> PropertyReader::read_rotation(const Tag& tag) {
    const std::optional<Vector3d> axis = read_triple(tag, 0.0);
    const auto angle = attempt(tag, "angle", [&] { return parse_float(tag.value("angle")); });
    if (!axis || !angle) return {};
    return attempt(tag, "", [&] { return Transform::rotate(*axis, *angle); });
}

std::optional<Transform> PropertyReader::read_look_at(const Tag& tag) {
    const auto vector = [&](const char* name, Vector3d absent) {
        return attempt(tag, name,
                       [&] { return tag.has(name) ? parse_triple(tag.value(name)) : absent; });
    };
    const auto origin = vector("origin", {});
    const auto target = vector("target", {});
    const auto up = vector("up", {0, 0, 0});
    if (!origin || !target || !up) return {};
    // Without "up", the image is turned as Mitsuba turns it.
    const bool has_up = *up != Vector3d(0);
    return attempt(tag, "target", [&] {
        return Transform::look_at(*origin, *target, has_up ? *up : axis_beside(*target - *origin));
    });
}

}  // namespace lucerna
