// SPDX-License-Identifier: Apache-2.0
#include "core/description/overrides.h"

#include "core/description/kinds.h"

#include <fmt/format.h>

namespace lucerna {

namespace {

/// What an object has if the scene does not say so: its parameters can be set all the same.
struct Implied {
    std::string_view parent, kind;
};
constexpr std::array implied{Implied{"scene", "sensor"}, Implied{"sensor", "film"},
                             Implied{"sensor", "sampler"}};

/// One override while it is applied.
class Override {
public:
    Override(const SourceFile& source, Description& description, Diagnostics& diagnostics)
        : source_(source), description_(description), diagnostics_(diagnostics) {}

    /// From `start`; if it is null, from the scene, or from an element with an id.
    void apply(Element* start) {
        const std::string_view text = source_.text;
        const std::size_t equals = text.find('=');
        if (equals == std::string_view::npos || equals == 0) {
            return error(0, start ? "expected name=value, like radius=2"
                                  : "expected --set path=value, like integrator.max_depth=8");
        }
        value_ = text.substr(equals + 1);
        std::string_view path = text.substr(0, equals);
        Element* element = start ? start : description_.root;
        if (Element* const by_id = start ? nullptr : take_id(path)) element = by_id;
        while (element) {
            const std::size_t dot = path.find('.');
            const std::string_view step = path.substr(0, dot);
            const std::size_t offset = static_cast<std::size_t>(step.data() - text.data());
            if (step.empty()) return error(offset, "a step of the path is missing");
            if (dot == std::string_view::npos) return set(*element, step, offset);
            element = descend(*element, step, offset);
            path.remove_prefix(dot + 1);
        }
    }

private:
    /// The element whose id the path starts with; ids may contain points. Removes it from the path.
    Element* take_id(std::string_view& path) {
        for (std::size_t end = path.rfind('.'); end != std::string_view::npos && end > 0;
             end = path.rfind('.', end - 1)) {
            for (Element& element : description_.elements) {
                if (element.id != path.substr(0, end) || element.id.empty()) continue;
                path.remove_prefix(end + 1);
                return &element;
            }
        }
        return nullptr;
    }

    /// The children that a step may mean: the one of that name, that id, or all of that kind. Of
    /// several sensors, a scene is rendered with the first.
    static std::vector<Child*> matches(Element& parent, std::string_view step) {
        std::vector<Child*> of_kind;
        for (Child& child : parent.children) {
            if (child.name == step) return {&child};
        }
        for (Child& child : parent.children) {
            if (child.element->id == step) return {&child};
            if (child.element->kind == step) of_kind.push_back(&child);
        }
        if (step == "sensor" && of_kind.size() > 1) of_kind.resize(1);
        return of_kind;
    }

    Element* descend(Element& parent, std::string_view step, std::size_t offset) {
        const std::vector<Child*> found = matches(parent, step);
        if (found.size() == 1) return found.front()->element;
        if (!found.empty()) {
            report_ambiguous(found, step, offset);
            return nullptr;
        }
        for (const Implied& object : implied) {
            if (object.parent != parent.kind || object.kind != step || parent.incomplete) continue;
            return add(parent, step, default_type(step), offset);
        }
        report_unknown(parent, step, offset);
        return nullptr;
    }

    void set(Element& element, std::string_view step, std::size_t offset) {
        const bool is_root = &element == description_.root;
        if (step == "type" && !is_root) return set_type(element);
        for (Property& property : element.properties) {
            if (property.name != step) continue;
            property = {property.name, UntypedText{value_}, {&source_, offset}};
            return;
        }
        const std::vector<Child*> found = matches(element, step);
        if (is_object_kind(step)) {
            const bool named = found.size() == 1 && found.front()->element->kind != step;
            if (found.size() > 1) return report_ambiguous(found, step, offset);
            if (found.size() == 1 && !named) return set_type(*found.front()->element);
            if (found.empty()) {
                if (check_type()) add(element, step, value_, offset);
                return;
            }
        }
        if (is_root) return report_unknown(element, step, offset);
        // A texture gives way to a plain value.
        std::erase_if(element.children, [&](const Child& child) { return child.name == step; });
        element.properties.push_back({std::string(step), UntypedText{value_}, {&source_, offset}});
    }

    void set_type(Element& element) {
        if (!check_type() || element.type == value_) return;
        element.type = value_;
        element.type_overridden = true;
    }

    Element* add(Element& parent, std::string_view kind, std::string_view type,
                 std::size_t offset) {
        const Location where{&source_, offset};
        Element& element = description_.elements.emplace_back();
        element.kind = kind;
        element.type = type;
        element.where = where;
        parent.children.push_back({"", &element, where});
        return &element;
    }

    bool check_type() {
        if (value_.empty()) error(source_.text.size() - 1, "expected a type after \"=\"");
        return !value_.empty();
    }

    void report_unknown(const Element& parent, std::string_view step, std::size_t offset) {
        if (parent.incomplete) return;  // it may be in what could not be read
        std::vector<std::string> names;
        const auto add = [&](const std::string& name) {
            const bool known = std::find(names.begin(), names.end(), name) != names.end();
            if (!name.empty() && !known) names.push_back(name);
        };
        for (const Child& child : parent.children) {
            add(child.element->kind);
            add(child.name);
            add(child.element->id);
        }
        const bool is_root = &parent == description_.root;
        const std::string place =
            is_root ? "the scene" : fmt::format("<{} type=\"{}\">", parent.kind, parent.type);
        const std::string hint = did_you_mean(step, names);
        constexpr std::size_t shown = 20;
        if (names.size() > shown) {
            names.resize(shown);
            names.emplace_back("...");
        }
        const std::string list =
            names.empty() ? "nothing is nested in it" : fmt::format("it has {}", join(names));
        error(offset, fmt::format("{} has no \"{}\"; {}{}", place, step, list, hint));
    }

    void report_ambiguous(const std::vector<Child*>& found, std::string_view step,
                          std::size_t offset) {
        std::vector<std::string> ids;
        for (const Child* child : found) {
            if (!child->element->id.empty()) ids.push_back(child->element->id);
            if (ids.size() == 10) break;
        }
        const std::string hint =
            ids.empty() ? "give one an id and name that" : "name one by its id: " + join(ids);
        error(offset, fmt::format("there are {} <{}> here; {}", found.size(), step, hint));
    }

    void error(std::size_t offset, std::string message) {
        diagnostics_.error({&source_, offset}, std::move(message));
    }

    const SourceFile& source_;
    Description& description_;
    Diagnostics& diagnostics_;
    std::string value_;
};

}  // namespace

void apply_overrides(const std::vector<std::string>& overrides, Description& description,
                     Diagnostics& diagnostics) {
    for (const std::string& text : overrides) {
        const SourceFile& source = description.sources.emplace_back(SourceFile{"--set", text});
        Override(source, description, diagnostics).apply(nullptr);
    }
}

void apply_settings(const std::vector<std::string>& settings, const std::string& name,
                    Element& element, Description& description, Diagnostics& diagnostics) {
    for (const std::string& text : settings) {
        const SourceFile& source = description.sources.emplace_back(SourceFile{name, text});
        Override(source, description, diagnostics).apply(&element);
    }
}

}  // namespace lucerna
