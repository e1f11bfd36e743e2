// SPDX-License-Identifier: Apache-2.0
/// Colours and other numbers of vertices and faces in PLY files, by Mitsuba 3's names.
///
/// The properties r, g, b (or red, green, blue) are "vertex_color" or "face_color". One property
/// `heat_x`, or three in a row, `wind_x`, `wind_y`, `wind_z`, are "vertex_heat" and "vertex_wind"
/// (or "face_…"); they may also end in r g b, 0 1 2, or 1 2 3. Colours that are integers are what
/// displays get: the largest is 1, and the curve is that of sRGB.
#pragma once

#include "core/image/color.h"
#include "plugins/shapes/ply_header.h"

#include <algorithm>

namespace lucerna {

struct PlyAttribute {
    std::string name;
    std::size_t size = 1;                     ///< 1 or 3
    std::array<std::size_t, 3> properties{};  ///< their indices in the element
    double largest = 0;  ///< integer that stands for 1 in a colour; 0: numbers are taken as written

    float decoded(double value) const {
        const auto number = static_cast<float>(largest > 0 ? value / largest : value);
        return largest > 0 ? srgb_to_linear(number) : number;
    }
};

constexpr double largest_of(PlyType type) {
    constexpr std::array<double, 8> largest = {127,        255,        32767, 65535,
                                               2147483647, 4294967295, 0,     0};
    return largest[static_cast<std::size_t>(type)];
}

/// Red, green and blue of an element, if there are all three.
inline std::optional<PlyAttribute> ply_color(const PlyElement& element) {
    static constexpr std::array<std::array<std::string_view, 3>, 2> names = {
        {{"r", "g", "b"}, {"red", "green", "blue"}}};
    const auto& all = element.properties;
    for (const auto& channels : names) {
        PlyAttribute color{.name = "color", .size = 3};
        std::size_t found = 0;
        for (; found < 3; ++found) {
            const auto p = std::find_if(all.begin(), all.end(), [&](const PlyProperty& property) {
                return property.name == channels[found] && !property.count_type;
            });
            if (p == all.end()) break;
            color.properties[found] = static_cast<std::size_t>(p - all.begin());
            color.largest = largest_of(p->type);
        }
        if (found == 3) return color;
    }
    return {};
}

/// Which component of an attribute a property is, by the letter after the last underline of its
/// name: the index in "xyz", "rgb", "012" or "123". Empty: none.
inline std::optional<std::size_t> ply_component(const PlyProperty& property,
                                                std::string_view letters) {
    const std::string& name = property.name;
    if (property.count_type || name.size() < 3 || name[name.size() - 2] != '_') return {};
    const std::size_t index = letters.find(name.back());
    return index == std::string_view::npos ? std::optional<std::size_t>() : index;
}

/// The attributes of an element; their names begin with `prefix`. Properties that are no part of
/// one are left out, as are pairs.
inline std::vector<PlyAttribute> ply_attributes(const PlyElement& element,
                                                const std::string& prefix) {
    std::vector<PlyAttribute> attributes;
    if (auto color = ply_color(element)) attributes.push_back(std::move(*color));
    const auto& all = element.properties;
    for (const std::string_view letters : {"xyz", "rgb", "012", "123"}) {
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (ply_component(all[i], letters) != 0) continue;
            const std::string name = all[i].name.substr(0, all[i].name.size() - 2);
            std::size_t size = 1;
            while (size < 3 && i + size < all.size() &&
                   ply_component(all[i + size], letters) == size &&
                   all[i + size].name.starts_with(name + "_")) {
                ++size;
            }
            // What starts with 1 was the second component of what starts with 0.
            const bool second = letters == "123" && i > 0 && ply_component(all[i - 1], "012") == 0;
            if (size == 2 || second) continue;
            attributes.push_back({.name = name, .size = size, .properties = {i, i + 1, i + 2}});
        }
    }
    for (PlyAttribute& attribute : attributes) attribute.name = prefix + attribute.name;
    return attributes;
}

}  // namespace lucerna
