// SPDX-License-Identifier: Apache-2.0
#include "core/render/stored_film.h"

#include "core/scene/builder.h"

#include <fmt/format.h>

#include <optional>
#include <sstream>

namespace lucerna {

namespace {

const Element* child_of_kind(const Element* parent, std::string_view kind) {
    if (!parent) return nullptr;
    for (const Child& child : parent->children) {
        if (child.element->kind == kind) return child.element;
    }
    return nullptr;
}

/// Text of a parameter that is a single value; films have no others.
std::optional<std::string> value_text(const PropertyValue& value) {
    if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
    if (const auto* integer = std::get_if<std::int64_t>(&value)) return std::to_string(*integer);
    if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
    if (const auto* text = std::get_if<std::string>(&value)) return *text;
    if (const auto* text = std::get_if<UntypedText>(&value)) return text->text;
    return {};
}

}  // namespace

std::string film_text(const Description& description) {
    const Element* const sensor = child_of_kind(description.root, "sensor");
    const Element* const film = child_of_kind(sensor, Film::kind);
    if (!film) return "hdrfilm";
    std::string text = film->type;
    for (const Property& property : film->properties) {
        if (const std::optional<std::string> value = value_text(property.value)) {
            text += fmt::format("\n{}={}", property.name, *value);
        }
    }
    return text;
}

StoredFilm::StoredFilm(const std::string& text, Registry& registry) {
    Description description;
    Element& element = description.elements.emplace_back();
    element.kind = Film::kind;
    std::istringstream lines(text);
    std::getline(lines, element.type);
    if (element.type.empty()) element.type = "hdrfilm";
    for (std::string line; std::getline(lines, line);) {
        const std::size_t equals = std::min(line.find('='), line.size());
        const std::size_t value = std::min(equals + 1, line.size());
        element.properties.push_back({.name = line.substr(0, equals),
                                      .value = UntypedText{line.substr(value)},
                                      .where = {}});
    }
    Diagnostics diagnostics;
    film_ = static_cast<const Film*>(
        build_object(element, description, registry, diagnostics, objects_));
    diagnostics.throw_if_errors();
}

}  // namespace lucerna
