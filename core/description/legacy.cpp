// SPDX-License-Identifier: Apache-2.0
#include "core/description/legacy.h"

#include <optional>
#include <stdexcept>

namespace lucerna {

namespace {

bool is_lower(char c) { return c >= 'a' && c <= 'z'; }
bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }

struct Renaming {
    std::string_view kind, type, old_name, name;
};
constexpr Renaming renamings[] = {
    {"bsdf", "diffuse", "diffuse_reflectance", "reflectance"},
};

template <typename Named>
void rename(const Element& element, Named& parameter) {
    for (const Renaming& r : renamings) {
        if (element.kind == r.kind && element.type == r.type && parameter.name == r.old_name) {
            parameter.name = r.name;
        }
    }
}

/// Removes a number and returns it. What is not a number stays, to be reported by the plugin.
std::optional<double> take_number(Element& element, std::string_view name, Location& where) {
    for (auto p = element.properties.begin(); p != element.properties.end(); ++p) {
        const double* const number = std::get_if<double>(&p->value);
        if (p->name != name || !number) continue;
        const double value = *number;
        where = p->where;
        element.properties.erase(p);
        return value;
    }
    return {};
}

}  // namespace

std::string legacy_name(std::string_view name) {
    std::string result;
    bool in_hump = false;  // of the camel: capitals that follow a small letter
    for (std::size_t i = 0; i < name.size(); ++i) {
        const bool starts = i > 0 && is_lower(name[i - 1]) && is_upper(name[i]);
        if (starts) result += '_';
        in_hump = starts || (in_hump && is_upper(name[i]));
        result += in_hump ? static_cast<char>(name[i] - 'A' + 'a') : name[i];
    }
    return result;
}

std::string legacy_type(std::string_view type) {
    std::string result(type);
    for (char& c : result) c = is_upper(c) ? static_cast<char>(c - 'A' + 'a') : c;
    return result;
}

std::string_view legacy_tag(std::string_view tag) { return tag == "lookAt" ? "lookat" : tag; }

void upgrade_legacy(Element& element, Diagnostics& diagnostics) {
    for (Property& property : element.properties) rename(element, property);
    for (Child& child : element.children) rename(element, child);
    if (element.kind != "texture") return;
    Location where = element.where;
    const auto both = take_number(element, "uvscale", where);
    const auto u_scale = take_number(element, "uscale", where);
    const auto v_scale = take_number(element, "vscale", where);
    const auto u_offset = take_number(element, "uoffset", where);
    const auto v_offset = take_number(element, "voffset", where);
    if (!both && !u_scale && !v_scale && !u_offset && !v_offset) return;
    const double scale = both.value_or(1.0);
    Matrix4d matrix(1.0);
    matrix[0][0] = u_scale.value_or(scale);
    matrix[1][1] = v_scale.value_or(scale);
    matrix[3][0] = u_offset.value_or(0.0);
    matrix[3][1] = v_offset.value_or(0.0);
    try {
        element.properties.push_back({"to_uv", Transform(matrix), where});
    } catch (const std::invalid_argument&) {
        diagnostics.error(where, "the scale of texture coordinates is zero");
    }
}

}  // namespace lucerna
