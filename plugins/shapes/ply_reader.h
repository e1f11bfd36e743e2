// SPDX-License-Identifier: Apache-2.0
/// Reads the triangles of PLY files (Turk 1994): ASCII and binary of both byte orders, properties
/// of any type in any order, polygons of any size. What is not geometry is passed over.
#pragma once

#include "core/scene/mesh.h"
#include "plugins/shapes/text_cursor.h"

#include <array>
#include <bit>
#include <cstring>
#include <optional>

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

/// The numbers of a text file, one after the other.
class PlyTextSource {
public:
    explicit PlyTextSource(TextCursor at) : at_(std::move(at)) {}

    double next(PlyType type) {
        at_.skip_space();
        if (at_.at_end()) at_.fail("the file ends too early");
        if (!is_integer(type)) return at_.number("a value");
        const auto value = static_cast<double>(at_.integer("a value"));
        if (!at_.at_blank()) at_.fail("a value of an integer type should be a whole number");
        return value;
    }
    std::size_t remaining() const { return at_.remaining(); }
    /// Bytes that each value takes at least, with a separator.
    static std::size_t least_size(PlyType) { return 2; }
    /// The last value needs no separator.
    static constexpr std::size_t slack = 1;
    [[noreturn]] void fail(std::string_view message) const { at_.fail(message); }

private:
    TextCursor at_;
};

/// The numbers of a binary file, one after the other.
class PlyBinarySource {
public:
    PlyBinarySource(std::span<const std::uint8_t> bytes, std::string name, bool swap)
        : bytes_(bytes), name_(std::move(name)), swap_(swap) {}

    double next(PlyType type) {
        switch (type) {
            case PlyType::int8:
                return take<std::int8_t>();
            case PlyType::uint8:
                return take<std::uint8_t>();
            case PlyType::int16:
                return take<std::int16_t>();
            case PlyType::uint16:
                return take<std::uint16_t>();
            case PlyType::int32:
                return take<std::int32_t>();
            case PlyType::uint32:
                return take<std::uint32_t>();
            case PlyType::float32:
                return static_cast<double>(take<float>());
            case PlyType::float64:
                break;
        }
        return take<double>();
    }
    std::size_t remaining() const { return bytes_.size(); }
    static std::size_t least_size(PlyType type) { return size_of(type); }
    static constexpr std::size_t slack = 0;
    [[noreturn]] void fail(std::string_view message) const {
        throw Error(fmt::format("{}: {}", name_, message));
    }

private:
    template <typename T>
    T take() {
        if (bytes_.size() < sizeof(T)) fail("the file ends too early");
        std::array<std::uint8_t, sizeof(T)> raw;
        std::memcpy(raw.data(), bytes_.data(), sizeof(T));
        bytes_ = bytes_.subspan(sizeof(T));
        if (swap_) std::reverse(raw.begin(), raw.end());
        return std::bit_cast<T>(raw);
    }

    std::span<const std::uint8_t> bytes_;
    std::string name_;
    bool swap_;
};

/// Reads the header; the cursor then stands behind it. Throws Error.
PlyHeader read_ply_header(TextCursor& at);

/// The mesh of a PLY file. Throws Error.
MeshData read_ply(std::span<const std::uint8_t> file, std::string name,
                  const Transform& world_from_file = {});

// The rest is implementation.

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

inline PlyHeader read_ply_header(TextCursor& at) {
    if (at.word() != "ply") at.fail("this is not a PLY file: it does not start with \"ply\"");
    PlyHeader header;
    while (true) {
        at.next_line();
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
    at.next_line();
    if (!header.format) at.fail("the header does not name the format");
    return header;
}

/// Reads what follows the header.
template <typename Source>
class PlyBody {
public:
    PlyBody(Source source, MeshData& mesh) : source_(std::move(source)), mesh_(mesh) {}

    void read(const PlyHeader& header) {
        bool has_vertices = false, has_faces = false;
        for (const PlyElement& element : header.elements) {
            require_room(element);
            if (element.name == "vertex") {
                if (has_vertices) source_.fail("there is a second element \"vertex\"");
                read_vertices(element);
                has_vertices = true;
            } else if (element.name == "face") {
                read_faces(element);
                has_faces = true;
            } else {
                skip(element);
            }
        }
        if (!has_vertices) source_.fail("there is no element \"vertex\"");
        if (!has_faces) {
            source_.fail(
                "there is no element \"face\": point clouds and triangle strips cannot be "
                "rendered");
        }
    }

private:
    /// What the header promises must fit into the file before anything is allocated.
    void require_room(const PlyElement& element) const {
        std::size_t each = 0;
        for (const PlyProperty& p : element.properties) {
            each += source_.least_size(p.count_type.value_or(p.type));
        }
        if (each == 0 && element.count > 0) {
            source_.fail(fmt::format("element \"{}\" has no properties", element.name));
        }
        if (element.count > 0 && element.count > (source_.remaining() + source_.slack) / each) {
            source_.fail(fmt::format("{} elements \"{}\" do not fit into the {} bytes that follow",
                                     element.count, element.name, source_.remaining()));
        }
    }

    std::size_t read_list_size(const PlyProperty& property) {
        const double count = source_.next(*property.count_type);
        if (!(count >= 0 && count <= 0xffffffff)) {
            source_.fail(fmt::format("list \"{}\" has the length {:g}", property.name, count));
        }
        return static_cast<std::size_t>(count);
    }

    void skip(const PlyProperty& property) {
        const std::size_t values = property.count_type ? read_list_size(property) : 1;
        for (std::size_t i = 0; i < values; ++i) source_.next(property.type);
    }

    void skip(const PlyElement& element) {
        for (std::uint64_t i = 0; i < element.count; ++i) {
            for (const PlyProperty& property : element.properties) skip(property);
        }
    }

    /// Position of a property in `values` below, or −1.
    static int slot_of(const PlyProperty& property) {
        static constexpr std::array<std::string_view, 12> names = {
            "x", "y", "z", "nx", "ny", "nz", "u", "v", "s", "t", "texture_u", "texture_v"};
        const auto found = std::find(names.begin(), names.end(), property.name);
        if (property.count_type || found == names.end()) return -1;
        const auto index = static_cast<int>(found - names.begin());
        return index < 6 ? index : 6 + index % 2;
    }

    void read_vertices(const PlyElement& element) {
        std::vector<int> slots;
        std::array<bool, 8> present{};
        for (const PlyProperty& property : element.properties) {
            slots.push_back(slot_of(property));
            if (slots.back() >= 0) present[static_cast<std::size_t>(slots.back())] = true;
        }
        if (!present[0] || !present[1] || !present[2]) {
            source_.fail("element \"vertex\" needs the properties x, y and z");
        }
        const bool normals = present[3] && present[4] && present[5];
        const bool uvs = present[6] && present[7];
        mesh_.reserve(element.count, 0);
        if (normals) mesh_.normals.reserve(element.count);
        if (uvs) mesh_.uvs.reserve(element.count);
        std::array<double, 8> values{};
        for (std::uint64_t i = 0; i < element.count; ++i) {
            for (std::size_t k = 0; k < slots.size(); ++k) {
                if (slots[k] < 0) {
                    skip(element.properties[k]);
                } else {
                    values[static_cast<std::size_t>(slots[k])] =
                        source_.next(element.properties[k].type);
                }
            }
            mesh_.add_position({values[0], values[1], values[2]});
            if (normals) mesh_.add_normal({values[3], values[4], values[5]});
            if (uvs) mesh_.uvs.emplace_back(Vector2d(values[6], values[7]));
        }
    }

    void read_faces(const PlyElement& element) {
        const auto is_corners = [](const PlyProperty& p) {
            return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
        };
        if (std::none_of(element.properties.begin(), element.properties.end(), is_corners)) {
            source_.fail("element \"face\" needs the list vertex_indices or vertex_index");
        }
        mesh_.indices.reserve(3 * element.count);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            for (const PlyProperty& property : element.properties) {
                if (is_corners(property)) {
                    read_polygon(property, i);
                } else {
                    skip(property);
                }
            }
        }
    }

    void read_polygon(const PlyProperty& property, std::uint64_t face) {
        const std::size_t size = read_list_size(property);
        if (size < 3) {
            source_.fail(fmt::format("face {} has {} corners; it needs 3 or more", face, size));
        }
        polygon_.clear();
        for (std::size_t i = 0; i < size; ++i) {
            const double index = source_.next(property.type);
            if (!(index >= 0 && index <= 0xfffffffe && index == std::floor(index))) {
                source_.fail(fmt::format("face {} uses vertex {:g}", face, index));
            }
            polygon_.push_back(static_cast<std::uint32_t>(index));
        }
        mesh_.add_polygon(polygon_);
    }

    Source source_;
    MeshData& mesh_;
    std::vector<std::uint32_t> polygon_;
};

inline MeshData read_ply(std::span<const std::uint8_t> file, std::string name,
                         const Transform& world_from_file) {
    MeshData mesh;
    mesh.name = name;
    mesh.world_from_file = world_from_file;
    TextCursor at(file, name);
    const PlyHeader header = read_ply_header(at);
    if (header.format == PlyFormat::ascii) {
        PlyBody(PlyTextSource(std::move(at)), mesh).read(header);
        return mesh;
    }
    const bool swap =
        (header.format == PlyFormat::little_endian) != (std::endian::native == std::endian::little);
    PlyBody(PlyBinarySource(file.last(at.remaining()), std::move(name), swap), mesh).read(header);
    return mesh;
}

}  // namespace lucerna
