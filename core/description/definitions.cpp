// SPDX-License-Identifier: Apache-2.0
#include "core/description/definitions.h"

#include "core/description/values.h"

#include <fmt/format.h>

namespace lucerna {

namespace {

bool is_word(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/// The name after a '$', bare or in braces, and what follows it. Empty if there is none.
std::string_view split_name(std::string_view& rest) {
    if (rest.starts_with('{')) {
        const std::size_t end = rest.find('}');
        if (end == std::string_view::npos) return {};
        const std::string_view name = rest.substr(1, end - 1);
        rest.remove_prefix(end + 1);
        return name;
    }
    std::size_t length = 0;
    while (length < rest.size() && is_word(rest[length])) ++length;
    const std::string_view name = rest.substr(0, length);
    rest.remove_prefix(length);
    return name;
}

}  // namespace

Definitions::Definitions(const std::vector<std::pair<std::string, std::string>>& command_line,
                         std::size_t max_bytes, Description& description, Diagnostics& diagnostics)
    : bytes_left_(max_bytes), diagnostics_(diagnostics) {
    for (const auto& [name, value] : command_line) {
        const SourceFile& source =
            description.sources.emplace_back(SourceFile{"-D", fmt::format("{}={}", name, value)});
        if (name.empty()) diagnostics_.error({&source, 0}, "expected -D name=value");
        definitions_[name] = {value, {&source, 0}, true, false};
    }
}

void Definitions::set_default(std::string_view name, std::string_view value, Location where) {
    defaults_.try_emplace(std::string(name), where);
    definitions_.try_emplace(std::string(name), Definition{std::string(value), where});
}

std::optional<std::string_view> Definitions::expand(std::string_view value, Location where) {
    if (value.find('$') == std::string_view::npos) return value;
    std::string result;
    if (!append_expanded(value, where, result)) return {};
    bytes_left_ -= result.size();
    return expanded_.emplace_back(std::move(result));
}

bool Definitions::append_expanded(std::string_view value, Location where, std::string& result) {
    while (!value.empty()) {
        const std::size_t dollar = std::min(value.find('$'), value.size());
        result += value.substr(0, dollar);
        if (dollar < value.size()) {
            value.remove_prefix(dollar + 1);
            const std::string_view start = value;
            const std::string_view name = split_name(value);
            if (name.empty()) {
                diagnostics_.error(where, "expected a name after \"$\": $name or ${name}");
                return false;
            }
            auto found = definitions_.find(name);
            // As in Mitsuba, a name may go on as text: $part1 is $part and "1".
            for (std::size_t n = name.size() - 1; found == definitions_.end() && n > 0; --n) {
                if (start.starts_with('{')) break;
                found = definitions_.find(start.substr(0, n));
                if (found == definitions_.end()) continue;
                value = start.substr(n);
                diagnostics_.warning(
                    where, fmt::format("\"${}\" has no value; it is taken as ${{{}}}{}", name,
                                       start.substr(0, n), name.substr(n)));
            }
            if (found == definitions_.end()) {
                const std::vector<std::string> names = names_in_scene();
                diagnostics_.error(
                    where, fmt::format("\"${}\" has no value; give it one above, with <default "
                                       "name=\"{}\" value=\"...\"/>, or with -D {}=...{}",
                                       name, name, name, did_you_mean(name, names)));
                return false;
            }
            found->second.used = true;
            result += found->second.value;
        } else {
            value = {};
        }
        if (result.size() > bytes_left_) {
            diagnostics_.error(where, "what $ parameters expand to is too long");
            return false;
        }
    }
    return true;
}

std::vector<std::string> Definitions::names_in_scene() const {
    std::vector<std::string> names;
    for (const auto& [name, definition] : definitions_) {
        if (!definition.from_command_line || definition.used || defaults_.contains(name)) {
            names.push_back(name);
        }
    }
    return names;
}

void Definitions::report_unused() const {
    const std::vector<std::string> names = names_in_scene();
    for (const auto& [name, definition] : definitions_) {
        if (!definition.from_command_line || definition.used || name.empty()) continue;
        if (defaults_.contains(name)) {
            diagnostics_.error(
                definition.where,
                fmt::format("the scene declares \"{}\" but uses ${} nowhere", name, name));
            continue;
        }
        const std::string others =
            names.empty() ? "it has none" : fmt::format("it has {}", join(names));
        diagnostics_.error(definition.where,
                           fmt::format("the scene has no parameter {}; {}{}", quote(name), others,
                                       did_you_mean(name, names)));
    }
}

}  // namespace lucerna
