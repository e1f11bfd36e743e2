// SPDX-License-Identifier: Apache-2.0
/// Reads the triangles of Wavefront OBJ files: v, vt, vn and f. All faces make one mesh; what says
/// nothing about triangles (groups, materials, lines, curves) is passed over.
#pragma once

#include "core/scene/mesh.h"
#include "plugins/shapes/text_cursor.h"

namespace lucerna {

class ObjReader {
public:
    ObjReader(std::span<const std::uint8_t> file, std::string name,
              const Transform& world_from_file)
        : at_(file, name) {
        source_.world_from_file = world_from_file;
        mesh_.name = std::move(name);
        mesh_.world_from_file = world_from_file;
    }

    /// Throws Error with the line.
    MeshData read() {
        for (; !at_.at_end(); at_.next_line()) read_statement();
        if (source_.normals.empty()) mesh_.normals.clear();
        if (source_.uvs.empty()) mesh_.uvs.clear();
        return std::move(mesh_);
    }

private:
    static constexpr std::uint32_t none = 0xffffffff;

    /// A vertex of the mesh is a position with its texture coordinates and normal. Those that
    /// share a position form a list.
    struct Vertex {
        std::uint32_t uv, normal;
        std::uint32_t next;
    };

    void read_statement() {
        const std::string_view word = at_.word();
        if (word == "v") {
            source_.add_position(read_triple("a coordinate"));
            first_vertex_.push_back(none);
        } else if (word == "vn") {
            source_.add_normal(read_triple("a normal"));
        } else if (word == "vt") {
            read_uv();
        } else if (word == "f") {
            read_face();
        } else if (!word.empty() && word[0] != '#' && !is_name(word)) {
            at_.fail("this is not a statement of an OBJ file; is it text?");
        }
    }

    /// Statements are words of letters and the like; anything else is a damaged or binary file.
    static bool is_name(std::string_view word) {
        return std::all_of(word.begin(), word.end(), [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                   c == '_';
        });
    }

    bool at_line_end() {
        at_.skip_blanks();
        return at_.peek() == '\n' || at_.peek() == '#';
    }

    Vector3d read_triple(std::string_view what) {
        const double x = at_.number(what);
        const double y = at_.number(what);
        const double z = at_.number(what);
        return {x, y, z};
    }

    void read_uv() {
        const double u = at_.number("a texture coordinate");
        const double v = at_line_end() ? 0 : at_.number("a texture coordinate");
        source_.uvs.emplace_back(Vector2d(u, v));
    }

    void read_face() {
        polygon_.clear();
        while (!at_line_end()) polygon_.push_back(read_corner());
        if (polygon_.size() < 3) {
            at_.fail(fmt::format("a face needs 3 vertices or more, not {}", polygon_.size()));
        }
        mesh_.add_polygon(polygon_);
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    std::uint32_t read_corner() {
        const std::uint32_t position = read_index("vertex", source_.positions.size());
        std::uint32_t uv = none, normal = none;
        if (at_.accept('/')) {
            if (at_.peek() != '/') uv = read_index("texture coordinate", source_.uvs.size());
            if (at_.accept('/')) normal = read_index("normal", source_.normals.size());
        }
        if (!at_.at_blank() && at_.peek() != '#') {
            at_.fail("a corner of a face should be written v, v/vt, v//vn or v/vt/vn");
        }
        return join(position, uv, normal);
    }

    /// Counted from 1; negative numbers count back from the last one read.
    std::uint32_t read_index(std::string_view what, std::size_t count) {
        const std::int64_t index = at_.integer(what);
        const auto size = static_cast<std::int64_t>(count);
        if (index >= 1 && index <= size) return static_cast<std::uint32_t>(index - 1);
        if (index <= -1 && index >= -size) return static_cast<std::uint32_t>(size + index);
        at_.fail(fmt::format("the face uses {} {}, but {} {} so far", what, index, count,
                             count == 1 ? "is defined" : "are defined"));
    }

    std::uint32_t join(std::uint32_t position, std::uint32_t uv, std::uint32_t normal) {
        for (std::uint32_t i = first_vertex_[position]; i != none; i = vertices_[i].next) {
            if (vertices_[i].uv == uv && vertices_[i].normal == normal) return i;
        }
        const auto added = static_cast<std::uint32_t>(vertices_.size());
        vertices_.push_back({uv, normal, first_vertex_[position]});
        first_vertex_[position] = added;
        mesh_.positions.push_back(source_.positions[position]);
        mesh_.uvs.push_back(uv == none ? Vector2(0) : source_.uvs[uv]);
        mesh_.normals.push_back(normal == none ? Vector3(0) : source_.normals[normal]);
        return added;
    }

    TextCursor at_;
    MeshData source_;  ///< what v, vt and vn have defined; no indices
    MeshData mesh_;
    std::vector<std::uint32_t> first_vertex_;  ///< of each position, or none
    std::vector<Vertex> vertices_;
    std::vector<std::uint32_t> polygon_;
};

/// The mesh of an OBJ file. Throws Error.
inline MeshData read_obj(std::span<const std::uint8_t> file, std::string name,
                         const Transform& world_from_file = {}) {
    return ObjReader(file, std::move(name), world_from_file).read();
}

}  // namespace lucerna
