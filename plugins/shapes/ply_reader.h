// SPDX-License-Identifier: Apache-2.0
/// Reads the triangles of PLY files (Turk 1994): ASCII and binary of both byte orders, properties
/// of any type in any order, polygons of any size, triangle strips. What is not read becomes a
/// warning.
#pragma once

#include "core/math/polygon.h"
#include "plugins/shapes/mesh.h"
#include "plugins/shapes/ply_attributes.h"
#include "plugins/shapes/ply_source.h"
#include "plugins/shapes/vertex_join.h"

namespace lucerna {

/// Reads what follows the header.
template <typename Source>
class PlyBody {
public:
    PlyBody(Source source, MeshData& mesh) : source_(std::move(source)), mesh_(mesh) {}

    void read(const PlyHeader& header) {
        uvs_of_faces_ = std::any_of(header.elements.begin(), header.elements.end(), has_face_uvs);
        for (const PlyElement& element : header.elements) {
            require_room(element);
            if (element.name == "vertex") {
                if (has_vertices_) source_.fail("there is a second element \"vertex\"");
                read_vertices(element);
            } else if (is_surface(element)) {
                has_faces_ = true;
                if (has_vertices_) {
                    read_surface(element);
                } else {
                    postponed_.push_back({source_, &element});
                    skip(element);
                }
            } else {
                if (element.count > 0) unread_.push_back("element " + shortened(element.name));
                skip(element);
            }
        }
        if (!has_vertices_) source_.fail("there is no element \"vertex\"");
        if (!has_faces_) {
            source_.fail("there is no element \"face\": point clouds cannot be rendered");
        }
        const bool has_more = source_.has_more();
        for (const Postponed& p : postponed_) {
            source_ = p.source;
            read_surface(*p.element);
        }
        warn(has_more);
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

    static constexpr int named_slots = 8;  ///< x, y, z, nx, ny, nz, u, v

    static bool is_corners(const PlyProperty& p) {
        return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
    }
    static bool is_face_uvs(const PlyProperty& p) { return p.count_type && p.name == "texcoord"; }
    static bool has_face_uvs(const PlyElement& element) {
        return element.name == "face" &&
               std::any_of(element.properties.begin(), element.properties.end(), is_face_uvs);
    }
    static bool is_surface(const PlyElement& element) {
        return element.name == "face" || element.name == "tristrips";
    }
    void read_surface(const PlyElement& element) {
        element.name == "face" ? read_faces(element) : read_strips(element);
    }

    void read_vertices(const PlyElement& element) {
        has_vertices_ = true;
        std::vector<int> slots;
        std::array<bool, named_slots> present{};
        for (const PlyProperty& property : element.properties) {
            slots.push_back(slot_of(property));
            if (slots.back() >= 0) present[static_cast<std::size_t>(slots.back())] = true;
        }
        if (!present[0] || !present[1] || !present[2]) {
            source_.fail("element \"vertex\" needs the properties x, y and z");
        }
        const std::vector<PlyAttribute> attributes = ply_attributes(element, "vertex_");
        std::vector<double> values(named_slots + mark_attributes(attributes, slots));
        const bool normals = present[3] && present[4] && present[5];
        const bool uvs = present[6] && present[7] && !uvs_of_faces_;
        note_unread(element, [&](std::size_t k) {
            const int slot = slots[k];
            return slot >= 0 && (slot < 3 || (slot < 6 ? normals : slot >= named_slots || uvs));
        });
        MeshData& to = uvs_of_faces_ ? source_mesh_ : mesh_;
        to.world_from_file = mesh_.world_from_file;
        to.reserve(element.count, 0);
        if (normals) to.normals.reserve(element.count);
        if (uvs) to.uvs.reserve(element.count);
        const std::size_t first = add_attributes(to, attributes, false);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            for (std::size_t k = 0; k < slots.size(); ++k) {
                if (slots[k] < 0) {
                    skip(element.properties[k]);
                } else {
                    values[static_cast<std::size_t>(slots[k])] =
                        source_.next(element.properties[k].type);
                }
            }
            to.add_position({values[0], values[1], values[2]});
            if (normals) to.add_normal({values[3], values[4], values[5]});
            if (uvs) to.uvs.emplace_back(Vector2d(values[6], values[7]));
            add_values(to, first, attributes, values.data() + named_slots);
            if (uvs_of_faces_) vertices_.add_position();
        }
        if (uvs_of_faces_) add_attributes(mesh_, attributes, false);
        vertex_count_ = element.count;
    }

    void read_faces(const PlyElement& element) {
        if (std::none_of(element.properties.begin(), element.properties.end(), is_corners)) {
            source_.fail("element \"face\" needs the list vertex_indices or vertex_index");
        }
        const std::vector<PlyAttribute> attributes = ply_attributes(element, "face_");
        std::vector<int> slots(element.properties.size(), -1);
        std::vector<double> values(named_slots + mark_attributes(attributes, slots));
        note_unread(element, [&](std::size_t k) {
            return slots[k] >= 0 || is_corners(element.properties[k]) ||
                   is_face_uvs(element.properties[k]);
        });
        const std::size_t first = add_attributes(mesh_, attributes, true);
        mesh_.indices.reserve(3 * element.count);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            face_uvs_.clear();
            for (std::size_t k = 0; k < slots.size(); ++k) {
                const PlyProperty& property = element.properties[k];
                if (is_corners(property)) {
                    read_corners(property, i);
                } else if (is_face_uvs(property)) {
                    read_list(property, face_uvs_);
                } else if (slots[k] >= 0) {
                    values[static_cast<std::size_t>(slots[k])] = source_.next(property.type);
                } else {
                    skip(property);
                }
            }
            const std::size_t before = mesh_.indices.size();
            add_face(i);
            for (std::size_t n = before; n < mesh_.indices.size(); n += 3) {
                add_values(mesh_, first, attributes, values.data() + named_slots);
            }
        }
    }

    /// Gives the numbers of attributes the slots behind; returns how many there are.
    static std::size_t mark_attributes(const std::vector<PlyAttribute>& attributes,
                                       std::vector<int>& slots) {
        int next = named_slots;
        for (const PlyAttribute& attribute : attributes) {
            for (std::size_t c = 0; c < attribute.size; ++c) {
                slots[attribute.properties[c]] = next++;
            }
        }
        return static_cast<std::size_t>(next - named_slots);
    }

    /// Makes room for attributes; returns where they begin. Triangles that are there have zeros.
    static std::size_t add_attributes(MeshData& to, const std::vector<PlyAttribute>& attributes,
                                      bool of_faces) {
        const std::size_t first = to.attributes.size();
        for (const PlyAttribute& a : attributes) {
            const std::size_t before = of_faces ? to.indices.size() / 3 * a.size : 0;
            to.attributes.push_back({.name = a.name,
                                     .of_faces = of_faces,
                                     .size = static_cast<std::uint32_t>(a.size),
                                     .values = std::vector<float>(before)});
        }
        return first;
    }

    static void add_values(MeshData& to, std::size_t first,
                           const std::vector<PlyAttribute>& attributes, const double* value) {
        for (std::size_t i = 0; i < attributes.size(); ++i) {
            for (std::size_t c = 0; c < attributes[i].size; ++c) {
                to.attributes[first + i].values.push_back(attributes[i].decoded(*value++));
            }
        }
    }

    void read_list(const PlyProperty& property, std::vector<double>& values) {
        values.clear();
        const std::size_t size = read_list_size(property);
        for (std::size_t i = 0; i < size; ++i) values.push_back(source_.next(property.type));
    }

    void read_corners(const PlyProperty& property, std::uint64_t face) {
        const std::size_t size = read_list_size(property);
        if (size < 3) {
            source_.fail(fmt::format("face {} has {} corners; it needs 3 or more", face, size));
        }
        polygon_.clear();
        for (std::size_t i = 0; i < size; ++i) {
            polygon_.push_back(checked_index(source_.next(property.type), "face", face));
        }
    }

    std::uint32_t checked_index(double index, std::string_view what, std::uint64_t number) const {
        if (!(index >= 0 && index == std::floor(index))) {
            source_.fail(fmt::format("{} {} uses vertex {:g}", what, number, index));
        }
        if (index >= static_cast<double>(vertex_count_)) {
            source_.fail(fmt::format("{} {} uses vertex {}, but there are only {}, counted from 0",
                                     what, number, index, vertex_count_));
        }
        return static_cast<std::uint32_t>(index);
    }

    void add_face(std::uint64_t face) {
        if (!face_uvs_.empty() && face_uvs_.size() != 2 * polygon_.size()) {
            source_.fail(
                fmt::format("face {} has {} corners and {} numbers in the list "
                            "\"texcoord\"; it needs two for each corner",
                            face, polygon_.size(), face_uvs_.size()));
        }
        for (std::size_t i = 0; uvs_of_faces_ && i < polygon_.size(); ++i) {
            const bool has_uvs = !face_uvs_.empty();
            polygon_[i] = join(
                polygon_[i],
                has_uvs ? Vector2(Vector2d(face_uvs_[2 * i], face_uvs_[2 * i + 1])) : Vector2(0));
        }
        if (!mesh_.add_polygon(polygon_)) {
            source_.fail(
                fmt::format("face {} is not convex and has {} corners, more than {}; cut it", face,
                            polygon_.size(), max_concave_corners));
        }
    }

    /// A vertex of the file with texture coordinates of a face.
    std::uint32_t join(std::uint32_t index, Vector2 uv) {
        const auto [vertex, is_new] = vertices_.find(index, uv);
        if (is_new) {
            mesh_.positions.push_back(source_mesh_.positions[index]);
            if (!source_mesh_.normals.empty()) {
                mesh_.normals.push_back(source_mesh_.normals[index]);
            }
            mesh_.uvs.push_back(uv);
            for (std::size_t i = 0; i < source_mesh_.attributes.size(); ++i) {
                const MeshAttribute& from = source_mesh_.attributes[i];
                const auto value = from.values.begin() + std::ptrdiff_t{index} * from.size;
                std::vector<float>& to = mesh_.attributes[i].values;
                to.insert(to.end(), value, value + from.size);
            }
        }
        return vertex;
    }

    /// Lists of vertices, each of which makes a triangle with the two before; −1 begins anew. Every
    /// other triangle is wound the other way.
    void read_strips(const PlyElement& element) {
        if (std::none_of(element.properties.begin(), element.properties.end(), is_corners)) {
            source_.fail("element \"tristrips\" needs the list vertex_indices or vertex_index");
        }
        note_unread(element, [&](std::size_t k) { return is_corners(element.properties[k]); });
        for (std::uint64_t i = 0; i < element.count; ++i) {
            for (const PlyProperty& property : element.properties) {
                if (is_corners(property)) {
                    read_strip(property, i);
                } else {
                    skip(property);
                }
            }
        }
    }

    void read_strip(const PlyProperty& property, std::uint64_t strip) {
        const std::size_t size = read_list_size(property);
        std::vector<std::uint32_t> last;
        bool turned = false;
        for (std::size_t i = 0; i < size; ++i) {
            const double index = source_.next(property.type);
            if (index == -1) {
                last.clear();
                turned = false;
                continue;
            }
            const std::uint32_t vertex = checked_index(index, "strip", strip);
            last.push_back(uvs_of_faces_ ? join(vertex, Vector2(0)) : vertex);
            if (last.size() < 3) continue;
            // Strips are sewn together with triangles that have a vertex twice.
            if (last[0] != last[1] && last[1] != last[2] && last[2] != last[0]) {
                mesh_.indices.insert(mesh_.indices.end(),
                                     {last[turned ? 1 : 0], last[turned ? 0 : 1], last[2]});
            }
            last.erase(last.begin());
            turned = !turned;
        }
        for (MeshAttribute& a : mesh_.attributes) {
            if (a.of_faces) a.values.resize(mesh_.indices.size() / 3 * a.size);
        }
    }

    static std::string shortened(const std::string& name) { return name.substr(0, 32); }

    /// Remembers the properties that are not `read`, a function of their index.
    template <typename Read>
    void note_unread(const PlyElement& element, const Read& read) {
        std::string names;
        for (std::size_t k = 0; element.count > 0 && k < element.properties.size(); ++k) {
            if (read(k)) continue;
            names += (names.empty() ? "" : ", ") + shortened(element.properties[k].name);
        }
        if (!names.empty()) unread_.push_back(names + " of " + element.name);
    }

    void warn(bool has_more) {
        if (!unread_.empty()) {
            std::string text = fmt::format("{}: not read: {}", mesh_.name, join_words(unread_));
            mesh_.warnings.push_back(std::move(text));
        }
        if (has_more) {
            mesh_.warnings.push_back(
                fmt::format("{}: more follows the last element; is its header right?", mesh_.name));
        }
    }

    static std::string join_words(const std::vector<std::string>& words) {
        constexpr std::size_t most = 400;
        std::string text = lucerna::join(words, "; ");
        if (text.size() > most) text = text.substr(0, most) + "...";
        return text;
    }

    struct Postponed {
        Source source;
        const PlyElement* element;
    };

    Source source_;
    MeshData& mesh_;
    MeshData source_mesh_;  ///< the vertices, if texture coordinates belong to faces
    VertexJoin<Vector2> vertices_;
    std::vector<Postponed> postponed_;  ///< faces that stand before their vertices
    std::vector<std::uint32_t> polygon_;
    std::vector<double> face_uvs_;
    std::vector<std::string> unread_;
    std::uint64_t vertex_count_ = 0;
    bool has_vertices_ = false, has_faces_ = false, uvs_of_faces_ = false;
};

/// The mesh of a PLY file. Throws Error.

inline MeshData read_ply(std::span<const std::uint8_t> file, std::string name,
                         const Transform& world_from_file = {}) {
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
