// SPDX-License-Identifier: Apache-2.0
#include "core/plugin/params.h"

#include "core/description/values.h"
#include "core/plugin/build_context.h"
#include "core/plugin/former_names.h"

#include <fmt/format.h>

namespace lucerna {

namespace {

constexpr std::string_view world_transform = "to_world";

std::string triple_text(Vector3 v) { return fmt::format("{:g} {:g} {:g}", v.x, v.y, v.z); }

std::string color_text(Color c) {
    return c.x == c.y && c.y == c.z ? fmt::format("{:g}", c.x) : triple_text(c);
}

}  // namespace

bool Range::contains(double x) const {
    return (open_min ? x > min : x >= min) && (open_max ? x < max : x <= max);
}

std::string Range::text() const {
    const bool low = std::isfinite(min), high = std::isfinite(max);
    if (low && high) {
        return fmt::format("{}{:g}, {:g}{}", open_min ? "(" : "[", min, max, open_max ? ")" : "]");
    }
    if (low) return fmt::format("{} {:g}", open_min ? ">" : ">=", min);
    if (high) return fmt::format("{} {:g}", open_max ? "<" : "<=", max);
    return "";
}

Params::Params(const Element& element, BuildContext& context)
    : element_(element),
      context_(context),
      property_read_(element.properties.size()),
      child_read_(element.children.size()) {}

Params::~Params() = default;

const std::string& Params::type() const { return element_.type; }
const std::string& Params::id() const { return element_.id; }

const Property* Params::find(std::string_view name) const {
    const Property* found = nullptr;
    for (std::size_t i = 0; i < element_.properties.size(); ++i) {
        if (element_.properties[i].name != name) continue;
        property_read_[i] = true;  // also of what is given twice, which the reader has reported
        if (!found) found = &element_.properties[i];
    }
    return found;
}

const Child* Params::find_child(std::string_view name) const {
    for (std::size_t i = 0; i < element_.children.size(); ++i) {
        if (element_.children[i].name == name) {
            child_read_[i] = true;
            return &element_.children[i];
        }
    }
    return nullptr;
}

bool Params::has(std::string_view name) const {
    const auto named = [&](const auto& item) { return item.name == name; };
    return std::any_of(element_.properties.begin(), element_.properties.end(), named) ||
           std::any_of(element_.children.begin(), element_.children.end(), named);
}

bool Params::is_word(std::string_view name) const {
    const auto named = [&](const Property& p) { return p.name == name; };
    const auto p = std::find_if(element_.properties.begin(), element_.properties.end(), named);
    if (p == element_.properties.end()) return false;
    const auto* text = std::get_if<UntypedText>(&p->value);
    if (!text) return std::holds_alternative<std::string>(p->value);
    try {
        parse_float(text->text);
        return false;
    } catch (const Error&) {
        return true;
    }
}

namespace {

Location place_of(const Element& element, std::string_view name) {
    for (const Property& p : element.properties) {
        if (p.name == name) return p.where;
    }
    for (const Child& c : element.children) {
        if (c.name == name) return c.where;
    }
    return element.where;
}

}  // namespace

void Params::error(std::string_view name, std::string message) const {
    const auto unreadable = [&](const Property& p) {
        return p.name == name && std::holds_alternative<Unreadable>(p.value);
    };
    const auto& given = element_.properties;
    if (std::any_of(given.begin(), given.end(), unreadable)) return;
    if (!wrong_.emplace(name).second) return;
    context_.diagnostics().error(place_of(element_, name), std::move(message));
}

void Params::error(const Property& property, std::string message) const {
    error(property.name, std::move(message));
}

void Params::warning(std::string_view name, std::string message) const {
    context_.diagnostics().warning(place_of(element_, name), std::move(message));
}

void Params::no_effect(std::string_view name, std::string_view why) const {
    if (find(name) || find_child(name)) {
        warning(name, fmt::format("\"{}\" has no effect: {}", name, why));
    }
}

void Params::declare(std::string_view name, std::string_view type, std::string default_value,
                     Range range, std::string_view doc) const {
    if (!context_.describing()) return;
    asked_.push_back({std::string(name), std::string(type), std::move(default_value), range.text(),
                      std::string(doc)});
}

void Params::wrong_type(const Property& property, std::string_view expected) const {
    error(property, fmt::format("\"{}\" of {} \"{}\" must be {}, not {}", property.name,
                                element_.kind, element_.type, expected, type_name(property.value)));
}

namespace {

/// The value of a property of the type T, or of the text of `--set` parsed as T.
template <typename T, typename Parse>
const T* value_of(const Property& property, T& parsed, Parse parse) {
    if (const T* value = std::get_if<T>(&property.value)) return value;
    if (const auto* text = std::get_if<UntypedText>(&property.value)) {
        parsed = parse(text->text);
        return &parsed;
    }
    return nullptr;
}

}  // namespace

bool Params::boolean(std::string_view name, bool default_value, std::string_view doc) const {
    declare(name, "boolean", default_value ? "true" : "false", any_value, doc);
    const Property* property = find(name);
    if (!property) return default_value;
    try {
        bool parsed = false;
        if (const bool* value = value_of<bool>(*property, parsed, parse_boolean)) return *value;
        wrong_type(*property, "a boolean");
    } catch (const Error& e) {
        error(*property, e.what());
    }
    return default_value;
}

std::int64_t Params::integer(std::string_view name, std::int64_t default_value, Range range,
                             std::string_view doc) const {
    declare(name, "integer", fmt::format("{}", default_value), range, doc);
    const Property* property = find(name);
    if (!property) return default_value;
    try {
        std::int64_t parsed = 0;
        const auto* value = value_of<std::int64_t>(*property, parsed, parse_integer);
        if (!value) {
            wrong_type(*property, "an integer");
        } else if (!range.contains(static_cast<double>(*value))) {
            const bool bounded = std::isfinite(range.min) && std::isfinite(range.max);
            error(name, fmt::format("\"{}\" is {}, but must be {}{}", name, *value,
                                    bounded ? "in " : "", range.text()));
        } else {
            return *value;
        }
    } catch (const Error& e) {
        error(*property, e.what());
    }
    return default_value;
}

int Params::int32(std::string_view name, int default_value, Range range,
                  std::string_view doc) const {
    range.min = std::max<double>(range.min, std::numeric_limits<int>::min());
    range.max = std::min<double>(range.max, std::numeric_limits<int>::max());
    Range shown = range;
    if (range.max == std::numeric_limits<int>::max()) shown.max = any_value.max;
    if (range.min == std::numeric_limits<int>::min()) shown.min = any_value.min;
    const bool outside = [&] {
        const Property* property = find(name);
        const auto* value = property ? std::get_if<std::int64_t>(&property->value) : nullptr;
        if (!value) return false;
        const double x = static_cast<double>(*value);
        return shown.contains(x) && !range.contains(x);
    }();
    return static_cast<int>(integer(name, default_value, outside ? range : shown, doc));
}

double Params::number(const Property& property, double default_value, Range range) const {
    double value = default_value;
    try {
        double parsed = 0;
        if (const auto* real = value_of<double>(property, parsed, parse_float)) {
            value = *real;
        } else if (const auto* whole = std::get_if<std::int64_t>(&property.value)) {
            value = static_cast<double>(*whole);
        } else {
            wrong_type(property, "a float");
            return default_value;
        }
    } catch (const Error& e) {
        error(property, e.what());
        return default_value;
    }
    if (range.contains(value)) return value;
    error(property, fmt::format("\"{}\" is {:g}, but must be {}{}", property.name, value,
                                std::isfinite(range.min) && std::isfinite(range.max) ? "in " : "",
                                range.text()));
    return default_value;
}

float Params::real(std::string_view name, double default_value, Range range,
                   std::string_view doc) const {
    declare(name, "float", fmt::format("{:g}", default_value), range, doc);
    const Property* property = find(name);
    return static_cast<float>(property ? number(*property, default_value, range) : default_value);
}

std::string Params::string(std::string_view name, std::string_view default_value,
                           std::string_view doc) const {
    declare(name, "string", fmt::format("\"{}\"", default_value), any_value, doc);
    const Property* property = find(name);
    if (!property) return std::string(default_value);
    std::string parsed;
    const auto* value =
        value_of<std::string>(*property, parsed, [](const std::string& text) { return text; });
    if (value) return *value;
    wrong_type(*property, "a string");
    return std::string(default_value);
}

Vector3d Params::triple(std::string_view name, Vector3d default_value) const {
    const Property* property = find(name);
    if (!property) return default_value;
    try {
        Triple parsed{};
        const auto* value = value_of<Triple>(
            *property, parsed, [](std::string_view text) { return Triple{parse_triple(text)}; });
        if (value) return value->value;
        wrong_type(*property, "a point or vector");
    } catch (const Error& e) {
        error(*property, e.what());
    }
    return default_value;
}

Vector3d Params::point(std::string_view name, Vector3d default_value, std::string_view doc) const {
    declare(name, "point", triple_text(Vector3(default_value)), any_value, doc);
    return triple(name, default_value);
}

Vector3 Params::vector(std::string_view name, Vector3 default_value, std::string_view doc) const {
    declare(name, "vector", triple_text(default_value), any_value, doc);
    return Vector3(triple(name, Vector3d(default_value)));
}

Vector3 Params::numbers(std::string_view name, std::string_view doc) const {
    declare(name, "vector or float", "", any_value, doc);
    const Property* property = find(name);
    if (!property) {
        if (!context_.describing()) {
            error(name, fmt::format("{} \"{}\" needs \"{}\", a vector or a float", element_.kind,
                                    element_.type, name));
        }
        return Vector3(0);
    }
    const auto* text = std::get_if<UntypedText>(&property->value);
    const bool one = std::holds_alternative<double>(property->value) ||
                     std::holds_alternative<std::int64_t>(property->value) ||
                     (text && !is_word(name));
    return one ? Vector3(static_cast<float>(number(*property, 0, any_value)))
               : Vector3(triple(name, Vector3d(0)));
}

ColorD Params::color(const Property& property, ColorD default_value, Range range) const {
    if (std::holds_alternative<double>(property.value) ||
        std::holds_alternative<std::int64_t>(property.value)) {
        return ColorD(number(property, default_value.x, range));
    }
    try {
        Rgb parsed{};
        const auto* value = value_of<Rgb>(
            property, parsed, [](std::string_view text) { return Rgb{parse_rgb(text)}; });
        if (!value) {
            wrong_type(property, "a colour or a number");
            return default_value;
        }
        const ColorD c = value->value;
        if (range.contains(c.x) && range.contains(c.y) && range.contains(c.z)) return c;
        // Spectra of real materials may leave the gamut: that is the format's limit, not the
        // author's mistake. Anything further out is.
        const ColorD clamped = glm::clamp(c, ColorD(range.min), ColorD(range.max));
        if (glm::length(c - clamped) <= 0.1 * glm::length(c)) return clamped;
        error(property,
              fmt::format("\"{}\" is {}, but each channel must be {}{}", property.name,
                          color_text(Color(c)),
                          std::isfinite(range.min) && std::isfinite(range.max) ? "in " : "",
                          range.text()));
    } catch (const Error& e) {
        error(property, e.what());
    }
    return default_value;
}

Color Params::rgb(std::string_view name, Color default_value, Range range,
                  std::string_view doc) const {
    declare(name, "rgb", color_text(default_value), range, doc);
    const Property* property = find(name);
    return property ? Color(color(*property, ColorD(default_value), range)) : default_value;
}

Transform Params::transform(std::string_view name, std::string_view doc) const {
    declare(name, "transform", "identity", any_value, doc);
    Transform result;
    if (const Property* property = find(name)) {
        if (const auto* value = std::get_if<Transform>(&property->value)) {
            result = *value;
        } else {
            wrong_type(*property, "a transform");
        }
    }
    return name == world_transform ? context_.placement(element_) * result : result;
}

std::filesystem::path Params::file(std::string_view name, std::string_view doc) const {
    declare(name, "file", "", any_value, doc);
    const Property* property = find(name);
    if (context_.describing()) return {};
    const bool made_up_before = std::exchange(made_up_, true);
    if (!property) {
        error(name, fmt::format("{} \"{}\" needs a file: <string name=\"{}\" value=\"…\"/>",
                                element_.kind, element_.type, name));
        return {};
    }
    std::string parsed;
    const auto* value =
        value_of<std::string>(*property, parsed, [](const std::string& text) { return text; });
    if (!value) {
        error(name, fmt::format("\"{}\" must be the name of a file", name));
        return {};
    }
    try {
        const std::filesystem::path found = context_.find_file(*value);
        made_up_ = made_up_before;
        return found;
    } catch (const TransientFileError&) {
        throw;  // no fault of the scene
    } catch (const Error& e) {
        error(name, e.what());
        return {};
    }
}

std::size_t Params::choose(std::string_view name, std::size_t default_index,
                           const std::vector<std::string>& words, std::string_view doc) const {
    declare(name, "string", "\"" + words[default_index] + "\"", any_value,
            fmt::format("{} [{}]", doc, join(words, " | ")));
    const Property* property = find(name);
    if (!property) return default_index;
    std::string parsed;
    const auto* value =
        value_of<std::string>(*property, parsed, [](const std::string& text) { return text; });
    if (!value) {
        wrong_type(*property, "a string");
        return default_index;
    }
    const auto found = std::find(words.begin(), words.end(), *value);
    if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
    error(name, fmt::format("\"{}\" of {} \"{}\" cannot be \"{}\"{}\n  it can be: {}", name,
                            element_.kind, element_.type, *value, did_you_mean(*value, words),
                            join(words)));
    return default_index;
}

std::pair<Color, const Object*> Params::color_or_child(std::string_view kind, std::string_view name,
                                                       Color default_value, Range range,
                                                       std::string_view doc) const {
    declare(name, fmt::format("rgb or {}", kind), color_text(default_value), range, doc);
    if (const Property* property = find(name)) {
        return {Color(color(*property, ColorD(default_value), range)), nullptr};
    }
    return {default_value, named_child(kind, name, "")};
}

const Object* Params::object(const Child& child) const {
    if (const Object* built = context_.object(child)) return built;
    // It is wrong, which has been reported. The plugin sees a sound one in its place, so that its
    // other parameters can be checked.
    made_up_ = true;
    return context_.default_object(child.element->kind, default_plugin(child.element->kind));
}

const Object* Params::named_child(std::string_view kind, std::string_view name,
                                  std::string_view doc) const {
    if (!doc.empty()) declare(name, kind, "none", any_value, doc);
    const Child* child = find_child(name);
    if (!child) return nullptr;
    if (child->element->kind == kind) return object(*child);
    context_.diagnostics().error(
        child->where, fmt::format("\"{}\" of {} \"{}\" must be a {}, not a {}", name, element_.kind,
                                  element_.type, kind, child->element->kind));
    return nullptr;
}

const Object* Params::single_child(std::string_view kind, std::string_view default_type,
                                   std::string_view doc) const {
    declare(fmt::format("<{}>", kind), "nested",
            default_type.empty() ? "none" : std::string(default_type), any_value, doc);
    const Object* result = nullptr;
    for (std::size_t i = 0; i < element_.children.size(); ++i) {
        const Child& child = element_.children[i];
        if (child_read_[i] || child.element->kind != kind) continue;
        child_read_[i] = true;
        if (result) {
            context_.diagnostics().error(
                child.where, fmt::format("{} \"{}\" takes only one nested {}", element_.kind,
                                         element_.type, kind));
        }
        result = object(child);
    }
    if (!result && !default_type.empty()) result = context_.default_object(kind, default_type);
    return result;
}

std::vector<const Object*> Params::remaining_children(std::string_view kind, Range count,
                                                      std::string_view doc) const {
    declare(fmt::format("<{}> …", kind), "nested", "", count, doc);
    std::vector<const Object*> result;
    if (context_.describing()) {
        const int needed = std::isfinite(count.min) ? static_cast<int>(std::ceil(count.min)) : 0;
        for (int i = 0; i < needed; ++i) {
            result.push_back(context_.default_object(kind, default_plugin(kind)));
        }
        return result;
    }
    for (std::size_t i = 0; i < element_.children.size(); ++i) {
        const Child& child = element_.children[i];
        if (child_read_[i] || child.element->kind != kind) continue;
        child_read_[i] = true;
        result.push_back(object(child));
    }
    if (count.contains(static_cast<double>(result.size()))) return result;
    const std::string wanted =
        count.min == count.max ? fmt::format("exactly {:g}", count.min) : count.text();
    throw Error(fmt::format("{} \"{}\" needs nested {}s: {}, but there {} {}", element_.kind,
                            element_.type, kind, wanted, result.size() == 1 ? "is" : "are",
                            result.size()));
}

std::vector<std::string> Params::child_names(std::string_view kind) const {
    std::vector<std::string> names;
    for (const Child& child : element_.children) {
        if (child.element->kind == kind) names.push_back(child.name);
    }
    return names;
}

void Params::report_unused(bool stopped,
                           const std::function<std::vector<ParameterInfo>()>& accepted) const {
    std::vector<std::pair<std::string, Location>> unused;
    for (std::size_t i = 0; i < property_read_.size(); ++i) {
        const Property& p = element_.properties[i];
        if (!property_read_[i]) unused.emplace_back(p.name, p.where);
    }
    for (std::size_t i = 0; i < child_read_.size(); ++i) {
        const Child& c = element_.children[i];
        if (child_read_[i]) continue;
        unused.emplace_back(c.name.empty() ? fmt::format("<{}>", c.element->kind) : c.name,
                            c.where);
    }
    if (unused.empty()) return;
    std::stable_sort(unused.begin(), unused.end(), [](const auto& a, const auto& b) {
        return a.second.offset < b.second.offset;
    });

    std::vector<std::string> names;
    std::string list;
    for (const ParameterInfo& info : accepted()) {
        names.push_back(info.name);
        list += fmt::format("\n    {} ({}{}{})", info.name, info.type,
                            info.default_value.empty() ? ", required" : ", default ",
                            info.default_value);
    }
    std::string remedy = list.empty() ? "; it takes none" : "\n  it takes:" + list;
    for (const auto& [name, where] : unused) {
        // Nested objects of which there may be several are declared with dots.
        const bool known = std::find(names.begin(), names.end(), name) != names.end() ||
                           std::find(names.begin(), names.end(), name + " …") != names.end();
        if (stopped && known) continue;
        const std::string former = advice_for_former(former_parameters, element_.kind, name);
        const std::string what =
            fmt::format("{} \"{}\" has no parameter \"{}\"{}", element_.kind, element_.type, name,
                        former.empty() ? did_you_mean(name, names) : former);
        if (element_.type_overridden || context_.lenient()) {
            context_.diagnostics().warning(where, what + ": ignored");
        } else {
            context_.diagnostics().error(where, what + remedy);
            remedy.clear();  // once for all of an object
        }
    }
}

}  // namespace lucerna
