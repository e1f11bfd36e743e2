// SPDX-License-Identifier: Apache-2.0
/// Reads the faces of Wavefront OBJ files: v, vt, vn and f (Wavefront 1992, "Object Files"). All
/// objects and groups make one mesh. What cannot be read and would be seen becomes a warning.
#pragma once

#include "core/math/polygon.h"
#include "plugins/shapes/mesh.h"
#include "plugins/shapes/text_cursor.h"
#include "plugins/shapes/vertex_join.h"

#include <array>
#include <set>

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
        warn();
        if (source_.normals.empty()) mesh_.normals.clear();
        if (source_.uvs.empty()) mesh_.uvs.clear();
        return std::move(mesh_);
    }

private:
    static constexpr std::uint32_t none = 0xffffffff;

    /// What a corner of a face adds to its position; `none` if it does not.
    struct Corner {
        std::uint32_t uv, normal;
        bool operator==(const Corner&) const = default;
    };

    void read_statement() {
        const std::string_view word = at_.word();
        if (word.empty() || word[0] == '#') return;
        if (word == "v") {
            read_position();
        } else if (word == "vn") {
            source_.add_normal(read_triple("a normal"));
        } else if (word == "vt") {
            read_uv();
        } else if (word == "f" || word == "fo") {  // fo: as f, until version 2
            read_face();
        } else if (word == "usemtl") {
            material_ = at_.word();
            is_new_material_ = true;
        } else if (!is_name(word)) {
            at_.fail("this is not a statement of an OBJ file; is it text?");
        } else if (!draws_nothing(word)) {
            if (unread_.empty()) first_unread_ = at_.at_this_line("");
            if (unread_.size() < most_unread) unread_.emplace(word.substr(0, 32));
        }
        while (!at_line_end()) at_.word();  // to the end of lines that continue
    }

    /// Names, numbers of groups and levels, and what belongs to curved surfaces, which are found by
    /// their own statements.
    static bool draws_nothing(std::string_view word) {
        static constexpr std::array<std::string_view, 24> words = {
            "g",        "o",        "s",   "mg",    "mtllib", "usemap", "maplib",     "bevel",
            "c_interp", "d_interp", "lod", "vp",    "cstype", "deg",    "bmat",       "step",
            "parm",     "end",      "con", "ctech", "stech",  "sp",     "shadow_obj", "trace_obj"};
        return std::find(words.begin(), words.end(), word) != words.end();
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
        return at_.at_line_end() || at_.peek() == '#';
    }

    /// x y z, then a weight (of curves) or a colour.
    void read_position() {
        source_.add_position(read_triple("a coordinate"));
        vertices_.add_position();
        int more = 0;
        for (; !at_line_end(); ++more) at_.number("a weight or colour");
        has_colors_ = has_colors_ || more >= 3;
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
            if (flat_faces_++ == 0) first_flat_face_ = at_.at_this_line("");
            return;
        }
        if (!mesh_.add_polygon(polygon_)) {
            at_.fail(fmt::format("a face that is not convex has {} vertices, more than {}; cut it",
                                 polygon_.size(), max_concave_corners));
        }
        if (is_new_material_ && used_materials_.size() < 2) used_materials_.insert(material_);
        is_new_material_ = false;
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`; some exporters leave slashes at the end: `v/vt/`.
    std::uint32_t read_corner() {
        const std::uint32_t position = read_index("vertex", source_.positions.size());
        std::uint32_t uv = none, normal = none;
        if (at_.accept('/')) {
            if (at_.peek() != '/' && !at_.at_blank()) {
                uv = read_index("texture coordinate", source_.uvs.size());
            }
            if (at_.accept('/') && !at_.at_blank()) {
                normal = read_index("normal", source_.normals.size());
            }
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
        const auto [vertex, is_new] = vertices_.find(position, {uv, normal});
        if (is_new) {
            mesh_.positions.push_back(source_.positions[position]);
            mesh_.uvs.push_back(uv == none ? Vector2(0) : source_.uvs[uv]);
            mesh_.normals.push_back(normal == none ? Vector3(0) : source_.normals[normal]);
        }
        return vertex;
    }

    void warn() {
        if (!unread_.empty()) {
            mesh_.warnings.push_back(fmt::format("{}statements \"{}\" are not read: only faces are",
                                                 first_unread_, fmt::join(unread_, "\", \"")));
        }
        if (flat_faces_ > 0) {
            mesh_.warnings.push_back(fmt::format(
                "{}{} of fewer than 3 vertices {} left out", first_flat_face_,
                flat_faces_ == 1 ? "a face" : "faces", flat_faces_ == 1 ? "is" : "are"));
        }
        if (has_colors_) {
            mesh_.warnings.push_back(fmt::format("{}: vertex colours are not read", mesh_.name));
        }
        if (used_materials_.size() > 1) {
            mesh_.warnings.push_back(fmt::format(
                "{}: its faces are of several materials, which are not read: the shape's BSDF "
                "holds for all; \"lucerna import\" makes a scene of the file",
                mesh_.name));
        }
    }

    static constexpr std::size_t most_unread = 16;

    TextCursor at_;
    MeshData source_;  ///< what v, vt and vn have defined; no indices
    MeshData mesh_;
    VertexJoin<Corner> vertices_;
    std::vector<std::uint32_t> polygon_;
    std::string material_;
    bool is_new_material_ = true;
    std::set<std::string> used_materials_, unread_;
    std::string first_unread_;  ///< its place
    bool has_colors_ = false;
    std::size_t flat_faces_ = 0;   ///< of fewer than 3 vertices
    std::string first_flat_face_;  ///< its place
};

/// The mesh of an OBJ file. Throws Error.
inline MeshData read_obj(std::span<const std::uint8_t> file, std::string name,
                         const Transform& world_from_file = {}) {
    return ObjReader(file, std::move(name), world_from_file).read();
}

}  // namespace lucerna
