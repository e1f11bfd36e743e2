// SPDX-License-Identifier: Apache-2.0
/// The header of PLY files (Turk 1994): which elements there are, and of which properties.
#pragma once

#include "plugins/shapes/text_cursor.h"

#include <array>
#include <optional>
#include <vector>

namespace lucerna {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::float32;
    std::optional<PlyType> count_type;  ///< of a list
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

enum class PlyFormat : std::uint8_t { ascii, little_endian, big_endian };

struct PlyHeader {
    std::optional<PlyFormat> format;
    std::vector<PlyElement> elements;
};

constexpr std::size_t size_of(PlyType type) {
    constexpr std::array<std::size_t, 8> sizes = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[static_cast<std::size_t>(type)];
}

constexpr bool is_integer(PlyType type) { return type < PlyType::float32; }

inline PlyType read_ply_type(TextCursor& at) {
    static constexpr std::array<std::pair<std::string_view, PlyType>, 16> names = {{
        {"char", PlyType::int8},
        {"int8", PlyType::int8},
        {"uchar", PlyType::uint8},
        {"uint8", PlyType::uint8},
        {"short", PlyType::int16},
        {"int16", PlyType::int16},
        {"ushort", PlyType::uint16},
        {"uint16", PlyType::uint16},
        {"int", PlyType::int32},
        {"int32", PlyType::int32},
        {"uint", PlyType::uint32},
        {"uint32", PlyType::uint32},
        {"float", PlyType::float32},
        {"float32", PlyType::float32},
        {"double", PlyType::float64},
        {"float64", PlyType::float64},
    }};
    const std::string_view word = at.word();
    for (const auto& [name, type] : names) {
        if (name == word) return type;
    }
    at.fail(fmt::format("there is no type \"{}\" in PLY files", word.substr(0, 32)));
}

inline PlyFormat read_ply_format(TextCursor& at) {
    const std::string_view word = at.word();
    if (word == "ascii") return PlyFormat::ascii;
    if (word == "binary_little_endian") return PlyFormat::little_endian;
    if (word == "binary_big_endian") return PlyFormat::big_endian;
    at.fail(
        fmt::format("the format should be ascii, binary_little_endian or binary_big_endian, "
                    "not \"{}\"",
                    word.substr(0, 32)));
}

inline PlyProperty read_ply_property(TextCursor& at) {
    PlyProperty property;
    TextCursor ahead = at;
    if (ahead.word() == "list") {
        at = ahead;
        property.count_type = read_ply_type(at);
        if (!is_integer(*property.count_type)) at.fail("a list is counted by an integer type");
    }
    property.type = read_ply_type(at);
    property.name = at.word();
    if (property.name.empty()) at.fail("the property has no name");
    return property;
}

/// Reads the header; the cursor then stands behind it. Throws Error.
inline PlyHeader read_ply_header(TextCursor& at) {
    if (at.word() != "ply") at.fail("this is not a PLY file: it does not start with \"ply\"");
    PlyHeader header;
    const std::string_view line_end = at.next_line();
    for (;; at.next_line()) {
        if (at.at_end()) at.fail("the header has no \"end_header\"");
        const std::string_view word = at.word();
        if (word == "end_header") break;
        if (word == "format") {
            header.format = read_ply_format(at);
        } else if (word == "element") {
            PlyElement element;
            element.name = at.word();
            const std::int64_t count = at.integer("the number of elements");
            if (count < 0) at.fail("a number of elements cannot be negative");
            element.count = static_cast<std::uint64_t>(count);
            header.elements.push_back(std::move(element));
        } else if (word == "property") {
            if (header.elements.empty()) at.fail("a property stands before the first element");
            header.elements.back().properties.push_back(read_ply_property(at));
        } else if (word != "comment" && word != "obj_info") {
            at.fail(fmt::format("\"{}\" is no part of a PLY header", word.substr(0, 32)));
        }
    }
    at.next_line(line_end);
    if (!header.format) at.fail("the header does not name the format");
    return header;
}

}  // namespace lucerna
