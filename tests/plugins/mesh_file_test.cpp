// SPDX-License-Identifier: Apache-2.0
/// Mesh files, right and wrong: what is read, and the words in which the rest is refused.
#include "core/interfaces/bsdf.h"
#include "core/interfaces/emitter.h"
#include "plugins/shapes/obj_reader.h"
#include "plugins/shapes/ply_reader.h"
#include "plugins/shapes/serialized_reader.h"
#include "tests/paths.h"
#include "tests/plugins/world.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <limits>

namespace lucerna {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

MeshData obj(std::string_view text) { return read_obj(bytes_of(text), "a.obj"); }
MeshData ply(const Bytes& bytes) { return read_ply(bytes, "a.ply"); }
MeshData ply(std::string_view text) { return ply(bytes_of(text)); }
MeshData serialized(const Bytes& bytes, std::uint32_t index = 0) {
    return read_serialized(bytes, "a.serialized", index);
}

/// The message with which `action` fails; empty if it does not.
std::string error_of(const std::function<void()>& action) {
    try {
        action();
        return "";
    } catch (const Error& error) {
        return error.what();
    }
}

using Indices = std::vector<std::uint32_t>;

// OBJ.

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

const char* const square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Obj, polygons_become_fans_and_vertices_are_joined) {
    const MeshData mesh = obj(std::string(square) + "f 1 2 3 4\n");
    EXPECT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 0, 2, 3}));
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_TRUE(mesh.uvs.empty());
}

TEST(Obj, a_position_with_two_texture_coordinates_is_two_vertices) {
    const MeshData mesh = obj(std::string(square) +
                              "vt 0 0\nvt 0.25 1\nvn 0 0 2\n"
                              "f 1/1/1 2/2/1 3/1/1\nf 1/1/1 3/2/1 4/2/1\n");
    EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 0, 3, 4}));
    EXPECT_EQ(mesh.positions[2], mesh.positions[3]);
    EXPECT_EQ(mesh.uvs[3], Vector2(0.25f, 1));
    EXPECT_EQ(mesh.normals[0], Vector3(0, 0, 1));
}

TEST(Obj, everything_that_files_in_the_wild_contain_is_read) {
    const MeshData mesh =
        obj("# a comment\r\nmtllib a.mtl\r\no thing\r\n\r\n"
            "v +1.5 -2e-1 .25 1.0\r\nv 0 0 1\t0.5 0.5 0.5\r\nv 0 1 0 # the last\r\n"
            "vt 0.5\r\nvn 0 0 0\r\ng a b\r\nusemtl red\r\ns off\r\nl 1 2\r\n"
            "f -3/1/-1 \\\r\n  -2//1 3\r\n");
    EXPECT_EQ(mesh.positions[0], Vector3(1.5f, -0.2f, 0.25f));
    EXPECT_EQ(mesh.indices, (Indices{0, 1, 2}));
    EXPECT_EQ(mesh.uvs, (std::vector<Vector2>{{0.5f, 0}, {0, 0}, {0, 0}}));
    EXPECT_EQ(mesh.normals[0], Vector3(0));
}

using Warnings = std::vector<std::string>;

TEST(Obj, P5_concave_faces_are_cut_inside_of_their_outline) {
    // An L of area 3 whose first corner does not see all of it.
    const MeshData mesh =
        obj("v 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\n"
            "f 1 2 3 4 5 6\n");
    EXPECT_EQ(mesh.indices.size(), 12u);
    double area = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const Vector3 a = mesh.positions[mesh.indices[i]];
        const Vector3 n = glm::cross(mesh.positions[mesh.indices[i + 1]] - a,
                                     mesh.positions[mesh.indices[i + 2]] - a);
        EXPECT_GE(n.z, 0);
        area += 0.5 * static_cast<double>(n.z);
    }
    EXPECT_EQ(area, 3);
    EXPECT_EQ(mesh.crossing_polygons, 0u);
    EXPECT_EQ(obj(std::string(square) + "f 1 3 2 4\n").crossing_polygons, 1u);
}

TEST(Obj, P5_all_line_ends_and_continued_lines_are_read) {
    const std::vector<std::string> lines = {"# a quad",  "v 0 0 0", "v 1 0 \\", "0",
                                            "v 1 1 0",   "v 0 1 0", "g a \\",   "b",
                                            "f 1 2 3\\", " 4",      "f 1 2 \\", "3"};
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string text;
        for (const std::string& line : lines) text += line + end;
        const MeshData mesh = obj(text);
        EXPECT_EQ(mesh.positions.size(), 4u);
        EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 0, 2, 3, 0, 1, 2}));
        EXPECT_EQ(mesh.warnings, Warnings());
        EXPECT_EQ(error_of([&] { obj(text + "f 9 1 2" + end); }),
                  "a.obj:13: the face uses vertex 9, but 4 are defined so far");
    }
    // Whatever mixes them.
    EXPECT_EQ(obj("v 0 0 0\rv 1 0 0\r\nv 0 1 0\n\rf 1 2 3").indices, (Indices{0, 1, 2}));
}

TEST(Obj, all_objects_and_groups_are_one_mesh) {
    const MeshData mesh =
        obj("o first\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
            "o second\ng a b\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf -3 -2 -1\nfo 4 5 3\n");
    EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 3, 4, 5, 3, 4, 2}));
    EXPECT_EQ(mesh.warnings, Warnings());
}

TEST(Obj, what_is_not_read_is_told) {
    const std::string triangle = "f 1 2 3\n";
    EXPECT_EQ(obj(square + triangle + "l 1 2\ncurv 0 1 1 2\nl 2 3\n").warnings,
              (Warnings{"a.obj:6: statements \"curv\", \"l\" are not read: only faces are"}));
    EXPECT_EQ(obj("v 0 0 0 1 0 0\n" + (square + triangle)).warnings,
              (Warnings{"a.obj: vertex colours are not read"}));
    EXPECT_EQ(obj("v 0 0 0 1\n" + (square + triangle)).warnings, Warnings());
    // One material is what the shape's BSDF replaces, with or without a library that describes it.
    EXPECT_EQ(obj(square + ("usemtl red\n" + triangle + triangle)).warnings, Warnings());
    EXPECT_EQ(obj(square + ("usemtl red\n" + triangle + "usemtl blue\n" + triangle)).warnings,
              (Warnings{"a.obj: its faces are of several materials, which are not read: the "
                        "shape's BSDF holds for all; \"lucerna import\" makes a scene of the "
                        "file"}));
}

TEST(Obj, P5_faces_without_an_inside_are_left_out_and_told) {
    const MeshData mesh = obj(square + std::string("f 1 2\nf 1 2 3\nf 4\n"));
    EXPECT_EQ(mesh.indices, (Indices{0, 1, 2}));
    EXPECT_EQ(mesh.warnings, (Warnings{"a.obj:5: faces of fewer than 3 vertices are left out"}));
}

TEST(Obj, P5_slashes_at_the_end_of_a_corner_stand_for_nothing) {
    const std::string corners = std::string(square) + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    const MeshData mesh = obj(corners + "f 1/1/ 2/2/ 3/3/ 4/4/\n");
    EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 0, 2, 3}));
    EXPECT_EQ(mesh.uvs.size(), 4u);
    EXPECT_TRUE(mesh.normals.empty());
    const MeshData bare = obj(corners + "f 1/ 2// 3/\n");
    EXPECT_EQ(bare.indices, (Indices{0, 1, 2}));
}

TEST(Obj, P5_a_byte_order_mark_is_no_statement) {
    const MeshData mesh = obj("\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(mesh.indices, (Indices{0, 1, 2}));
    EXPECT_EQ(mesh.warnings, Warnings());
}

TEST(Obj, a_position_with_very_many_texture_coordinates_is_read_quickly) {
    // A search among all corners of the position would take minutes.
    std::string text = square;
    constexpr int count = 150000;
    for (int i = 0; i < count; ++i) text += fmt::format("vt {} 0\nf 1/{} 2/1 3/1\n", i, i + 1);
    EXPECT_EQ(obj(text).indices.size(), std::size_t{3} * count);
}

TEST(Obj, L1_wrong_files_are_refused_with_the_line) {
    const std::vector<std::pair<std::string, std::string>> cases = {
        {"f 1 2 5\n", "a.obj:5: the face uses vertex 5, but 4 are defined so far"},
        {"f 0 1 2\n", "a.obj:5: the face uses vertex 0, but 4 are defined so far"},
        {"f -5 1 2\n", "a.obj:5: the face uses vertex -5, but 4 are defined so far"},
        {"f 99999999999999999999 1 2\n",
         "a.obj:5: vertex should be a whole number, not \"99999999999999999999\""},
        {"vt 0 0\nf 1/2 2/1 3/1\n",
         "a.obj:6: the face uses texture coordinate 2, but 1 is defined so far"},
        {"f 1//1 2//1 3//1\n", "a.obj:5: the face uses normal 1, but 0 are defined so far"},
        {"f 1 2 3x\n", "a.obj:5: a corner of a face should be written v, v/vt, v//vn or v/vt/vn"},
        {"f 1 2 x\n", "a.obj:5: vertex should be a whole number, not \"x\""},
        {"v 1 2\n", "a.obj:5: a coordinate should be a number, not \"\""},
        {"v 1 2 1,5\n", "a.obj:5: a coordinate should be a number, not \"1,5\""},
        {"\nv 1 nan 2\n", "a.obj:6: a coordinate is not finite"},
        {"vn 1 -inf 2\n", "a.obj:5: a normal is not finite"},
        {"v 1 1e999 2\n", "a.obj:5: a coordinate should be a number, not \"1e999\""},
        {"\x7f\x45\x4c\x46", "a.obj:5: this is not a statement of an OBJ file; is it text?"},
    };
    for (const auto& [text, message] : cases) {
        const std::string file = square + text;
        EXPECT_EQ(error_of([&] { obj(file); }), message);
    }
}

// PLY.

const char* const ply_square =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

const std::string ascii_ply =
    std::string("ply\nformat ascii 1.0\n") + ply_square + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

template <typename T>
void append(Bytes& bytes, T value, bool big_endian = false) {
    std::array<std::uint8_t, sizeof(T)> raw;
    std::memcpy(raw.data(), &value, sizeof(T));
    if (big_endian) std::reverse(raw.begin(), raw.end());
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

/// A square whose properties are of all kinds, in an unusual order.
Bytes binary_ply(bool big_endian) {
    Bytes file = bytes_of(std::string("ply\nformat ") +
                          (big_endian ? "binary_big_endian" : "binary_little_endian") +
                          " 1.0\ncomment made by a test\nobj_info none\n"
                          "element vertex 4\nproperty uchar red\nproperty double z\n"
                          "property float x\nproperty list ushort short extra\n"
                          "property float y\nproperty float t\nproperty float s\n"
                          "property float nx\nproperty float ny\nproperty float nz\n"
                          "element edge 1\nproperty int a\n"
                          "element face 2\nproperty list int float weights\n"
                          "property list uint ushort vertex_index\nproperty float64 q\n"
                          "end_header\n");
    const Vector2 corners[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (const Vector2 p : corners) {
        append<std::uint8_t>(file, 200);
        append<double>(file, 0.5, big_endian);
        append<float>(file, p.x, big_endian);
        append<std::uint16_t>(file, 2, big_endian);
        append<std::int16_t>(file, -7, big_endian);
        append<std::int16_t>(file, 8, big_endian);
        append<float>(file, p.y, big_endian);
        append<float>(file, 1 - p.y, big_endian);
        append<float>(file, p.x, big_endian);
        for (const float n : {0.0f, 0.0f, 3.0f}) append<float>(file, n, big_endian);
    }
    append<std::int32_t>(file, 17, big_endian);
    for (const std::array<std::uint16_t, 3> face :
         {std::array<std::uint16_t, 3>{0, 1, 2}, {2, 3, 0}}) {
        append<std::int32_t>(file, 1, big_endian);
        append<float>(file, 0.5f, big_endian);
        append<std::uint32_t>(file, 3, big_endian);
        for (const std::uint16_t i : face) append<std::uint16_t>(file, i, big_endian);
        append<double>(file, 1.25, big_endian);
    }
    return file;
}

TEST(Ply, text_is_read) {
    const MeshData mesh = ply(ascii_ply);
    EXPECT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.positions[2], Vector3(1, 1, 0));
    EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 0, 2, 3}));
}

TEST(Ply, L6_both_byte_orders_and_all_types_are_read) {
    for (const bool big_endian : {false, true}) {
        const MeshData mesh = ply(binary_ply(big_endian));
        EXPECT_EQ(mesh.positions,
                  (std::vector<Vector3>{{0, 0, 0.5f}, {1, 0, 0.5f}, {1, 1, 0.5f}, {0, 1, 0.5f}}));
        EXPECT_EQ(mesh.normals, std::vector<Vector3>(4, Vector3(0, 0, 1)));
        EXPECT_EQ(mesh.uvs, (std::vector<Vector2>{{0, 1}, {1, 1}, {1, 0}, {0, 0}}));
        EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 2, 3, 0}));
    }
}

TEST(Ply, L6_big_endian_doubles_are_read) {
    Bytes file = bytes_of(
        "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty double x\n"
        "property double y\nproperty double z\nproperty double u\nproperty double v\n"
        "element face 1\nproperty list uint uint vertex_indices\nend_header\n");
    for (const double x :
         {0.0, 0.0, 0.1, 0.0, 0.0, 1.5, 0.0, 0.1, 1.0, 0.25, -2.0, 1e7, 0.1, 0.5, 1.0}) {
        append(file, x, true);
    }
    for (const std::uint32_t i : {3u, 0u, 1u, 2u}) append(file, i, true);
    const MeshData mesh = ply(file);
    EXPECT_EQ(mesh.positions,
              (std::vector<Vector3>{{0, 0, 0.1f}, {1.5f, 0, 0.1f}, {-2, 1e7f, 0.1f}}));
    EXPECT_EQ(mesh.uvs, (std::vector<Vector2>{{0, 0}, {1, 0.25f}, {0.5f, 1}}));
    EXPECT_EQ(mesh.indices, (Indices{0, 1, 2}));
    EXPECT_EQ(mesh.warnings, Warnings());
}

TEST(Ply, all_line_ends_are_read_also_before_binary_data) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string header = std::string("ply\nformat binary_little_endian 1.0\n") + ply_square;
        std::string text = ascii_ply;
        for (std::string* s : {&header, &text}) {
            for (std::size_t at = 0; (at = s->find('\n', at)) != std::string::npos;
                 at += end.size()) {
                s->replace(at, 1, end);
            }
        }
        EXPECT_EQ(ply(text).indices, (Indices{0, 1, 2, 0, 2, 3}));
        Bytes file = bytes_of(header);
        // The first byte of the data is a line feed.
        const float ten = std::bit_cast<float>(0x4120000au);
        for (const float x : {ten, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.f}) {
            append(file, x);
        }
        append<std::uint8_t>(file, 3);
        for (const std::int32_t i : {0, 2, 3}) append(file, i);
        EXPECT_EQ(ply(file).positions[0], Vector3(ten, 0, 0));
        EXPECT_EQ(ply(file).indices, (Indices{0, 2, 3}));
    }
}

TEST(Ply, concave_faces_may_stand_before_their_vertices) {
    const MeshData mesh =
        ply("ply\nformat ascii 1.0\nelement face 2\nproperty list uchar int vertex_indices\n"
            "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
            "4 0 1 2 3\n3 0 1 2\n0 0 0\n2 2 0\n4 0 0\n2 6 0\n");
    // An arrow: the fan around its first corner would turn a triangle over.
    EXPECT_EQ(mesh.indices.size(), 9u);
    EXPECT_EQ(Indices(mesh.indices.end() - 3, mesh.indices.end()), (Indices{0, 1, 2}));
    for (std::size_t i = 0; i < 6; i += 3) {
        const Vector3 a = mesh.positions[mesh.indices[i]];
        EXPECT_EQ(glm::cross(mesh.positions[mesh.indices[i + 1]] - a,
                             mesh.positions[mesh.indices[i + 2]] - a),
                  Vector3(0, 0, 8));
    }
}

const char* const textured_faces =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face 3\n"
    "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
    "0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n"
    "3 0 1 2 6 0 0 0.5 0 0.5 1\n3 0 2 3 6 0 0 1 1 0 1\n3 1 2 3 0\n";

TEST(Ply, P5_texture_coordinates_of_faces_are_read) {
    const MeshData mesh = ply(textured_faces);
    // Vertex 0 has one pair of coordinates, vertex 2 has two; where a face has none, it is (0, 0).
    EXPECT_EQ(mesh.indices, (Indices{0, 1, 2, 0, 3, 4, 5, 6, 7}));
    EXPECT_EQ(mesh.uvs, (std::vector<Vector2>{
                            {0, 0}, {0.5f, 0}, {0.5f, 1}, {1, 1}, {0, 1}, {0, 0}, {0, 0}, {0, 0}}));
    EXPECT_EQ(mesh.positions[3], Vector3(1, 1, 0));
    EXPECT_EQ(mesh.normals, std::vector<Vector3>(8, Vector3(0, 0, 1)));
    EXPECT_EQ(mesh.warnings, Warnings());
}

TEST(Ply, L2_texture_coordinates_of_faces_fit_their_corners) {
    EXPECT_EQ(error_of([] { ply(replaced(textured_faces, "6 0 0 1 1 0 1", "5 0 0 1 1 0")); }),
              "a.ply:19: face 1 has 3 corners and 5 numbers in the list \"texcoord\"; it needs two "
              "for each corner");
}

TEST(Ply, P5_triangle_strips_are_read) {
    const std::string file = replaced(replaced(ascii_ply, "element face", "element tristrips"),
                                      "4 0 1 2 3", "10 0 1 2 3 -1 3 2 1 1 0");
    // Every other triangle is turned; a new strip begins as the first; two triangles of the second
    // strip have a vertex twice.
    EXPECT_EQ(ply(file).indices, (Indices{0, 1, 2, 2, 1, 3, 3, 2, 1}));
    EXPECT_EQ(error_of([&] { ply(replaced(file, "-1 3", "-1 4")); }),
              "a.ply:14: strip 0 uses vertex 4, but there are only 4, counted from 0");
    EXPECT_EQ(error_of([&] { ply(replaced(file, "-1 3", "-2 3")); }),
              "a.ply:14: strip 0 uses vertex -2");
}

/// Two triangles that share an edge, and a third of another face; all kinds of attributes.
const std::string attributed_ply =
    "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
    "property float z\nproperty float heat_x\nproperty float wind_x\nproperty float wind_y\n"
    "property float wind_z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
    "property uchar alpha\nelement face 2\nproperty float r\nproperty float g\n"
    "property float b\nproperty list uchar int vertex_indices\nproperty double load_0\n"
    "end_header\n"
    "0 0 0 1 1 2 3 0 128 255 9\n1 0 0 2 4 5 6 0 0 0 9\n1 1 0 3 7 8 9 255 255 255 9\n"
    "0 1 0 4 0 0 0 0 0 0 9\n2 0 0 5 0 0 0 0 0 0 9\n"
    "0.25 0.5 1 4 0 1 2 3 7\n2 0 0 3 1 4 2 -8\n";

std::vector<float> values_of(const MeshData& mesh, const std::string& name) {
    for (const MeshAttribute& a : mesh.attributes) {
        if (a.name == name) return a.values;
    }
    ADD_FAILURE() << "no " << name;
    return {};
}

TEST(Ply, colours_and_other_numbers_are_attributes) {
    const MeshData mesh = ply(attributed_ply);
    std::string names;
    for (const MeshAttribute& a : mesh.attributes) names += fmt::format("{}:{} ", a.name, a.size);
    EXPECT_EQ(names, "vertex_color:3 vertex_heat:1 vertex_wind:3 face_color:3 face_load:1 ");
    EXPECT_EQ(values_of(mesh, "vertex_heat"), (std::vector<float>{1, 2, 3, 4, 5}));
    EXPECT_EQ(values_of(mesh, "vertex_wind")[5], 6);
    // Integers are decoded from sRGB.
    EXPECT_EQ(values_of(mesh, "vertex_color")[0], 0);
    EXPECT_NEAR(values_of(mesh, "vertex_color")[1], 0.2158605f, 1e-6f);
    EXPECT_EQ(values_of(mesh, "vertex_color")[2], 1);
    // The first face is two triangles.
    EXPECT_EQ(values_of(mesh, "face_color"),
              (std::vector<float>{0.25f, 0.5f, 1, 0.25f, 0.5f, 1, 2, 0, 0}));
    EXPECT_EQ(values_of(mesh, "face_load"), (std::vector<float>{7, 7, -8}));
    EXPECT_EQ(mesh.warnings, (Warnings{"a.ply: not read: alpha of vertex"}));
}

TEST(Ply, vertices_that_texture_coordinates_divide_keep_their_attributes) {
    const std::string heated =
        replaced(replaced(textured_faces, "property float nz\n",
                          "property float nz\nproperty float heat_x\n"),
                 "0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n",
                 "0 0 0 0 0 1 5\n1 0 0 0 0 1 6\n1 1 0 0 0 1 7\n0 1 0 0 0 1 8\n");
    const MeshData mesh = ply(heated);
    const std::vector<float> heat = values_of(mesh, "vertex_heat");
    ASSERT_EQ(heat.size(), mesh.positions.size());
    for (std::size_t i = 0; i < heat.size(); ++i) {
        const Vector3 p = mesh.positions[i];
        EXPECT_EQ(heat[i], p.y == 0 ? 5 + p.x : 8 - p.x);
    }
}

TEST(Ply, strips_have_no_attributes_of_faces) {
    const std::string both =
        replaced(replaced(attributed_ply, "end_header\n",
                          "element tristrips 1\nproperty list int int vertex_indices\n"
                          "end_header\n"),
                 "3 1 4 2 -8\n", "3 1 4 2 -8\n4 0 1 2 3\n");
    EXPECT_EQ(values_of(ply(both), "face_load"), (std::vector<float>{7, 7, -8, 0, 0}));
}

TEST(Ply, what_is_not_read_is_told) {
    EXPECT_EQ(
        ply(binary_ply(false)).warnings,
        (Warnings{"a.ply: not read: red, extra of vertex; element edge; weights, q of face"}));
    const std::string pair =
        replaced(attributed_ply, "property float heat_x", "property float x_0");
    EXPECT_EQ(ply(replaced(pair, "property float wind_x", "property float x_1")).warnings,
              (Warnings{"a.ply: not read: x_0, x_1, wind_y, wind_z, alpha of vertex"}));
    const std::string half =
        replaced(ascii_ply, "property float z\n", "property float z\nproperty float u\n");
    const std::string half_uvs =
        replaced(half, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n", "0 0 0 5\n1 0 0 5\n1 1 0 5\n0 1 0 5\n");
    EXPECT_EQ(ply(half_uvs).warnings, (Warnings{"a.ply: not read: u of vertex"}));
    EXPECT_TRUE(ply(half_uvs).uvs.empty());
    const Warnings more = {"a.ply: more follows the last element; is its header right?"};
    EXPECT_EQ(ply(ascii_ply + "\n \n").warnings, Warnings());
    EXPECT_EQ(ply(ascii_ply + "3 0 1 2\n").warnings, more);
    Bytes file = bytes_of(std::string("ply\nformat binary_little_endian 1.0\n") + ply_square);
    for (int i = 0; i < 12; ++i) append(file, static_cast<float>(i));
    append<std::uint8_t>(file, 3);
    for (const std::int32_t i : {0, 2, 3}) append(file, i);
    append<std::uint8_t>(file, '\n');
    EXPECT_EQ(ply(file).warnings, Warnings());
    append<std::uint8_t>(file, 3);
    EXPECT_EQ(ply(file).warnings, more);
}

TEST(Ply, L4_truncated_at_every_length_is_refused) {
    const Bytes whole = binary_ply(false);
    for (std::size_t length = 0; length < whole.size(); ++length) {
        const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
        EXPECT_NE(error_of([&] { ply(part); }), "") << length;
    }
    // The last number of a text can be cut short without anyone noticing; anything before cannot.
    const std::size_t last = ascii_ply.size() - 2;
    for (std::size_t length = 0; length < last; ++length) {
        EXPECT_NE(error_of([&] { ply(ascii_ply.substr(0, length)); }), "") << length;
    }
}

TEST(Ply, L2_L3_wrong_headers_are_refused_before_anything_is_allocated) {
    const std::vector<std::array<std::string, 3>> cases = {
        {"ply", "PLY", "a.ply:1: this is not a PLY file: it does not start with \"ply\""},
        {"ascii", "utf8",
         "a.ply:2: the format should be ascii, binary_little_endian or binary_big_endian, not "
         "\"utf8\""},
        {"format ascii 1.0\n", "", "a.ply:9: the header does not name the format"},
        {"end_header\n", "", "a.ply:9: \"0\" is no part of a PLY header"},
        {"element vertex 4\n", "", "a.ply:3: a property stands before the first element"},
        {"vertex 4", "vertex 4294967296",
         "a.ply:10: 4294967296 elements \"vertex\" do not fit into the 34 bytes that follow"},
        {"vertex 4", "vertex -4", "a.ply:3: a number of elements cannot be negative"},
        {"vertex 4", "vertex many",
         "a.ply:3: the number of elements should be a whole number, not \"many\""},
        {"face 1", "face 9000000000000000000",
         "a.ply:13: 9000000000000000000 elements \"face\" do not fit into the 11 bytes that "
         "follow"},
        {"float x", "half x", "a.ply:4: there is no type \"half\" in PLY files"},
        {"property float y", "property float", "a.ply:5: the property has no name"},
        {"property float y\n", "", "a.ply:9: element \"vertex\" needs the properties x, y and z"},
        {"list uchar", "list float", "a.ply:8: a list is counted by an integer type"},
        {"vertex_indices", "corners",
         "a.ply:13: element \"face\" needs the list vertex_indices or vertex_index"},
        {"element face 1\nproperty list uchar int vertex_indices\n", "",
         "a.ply:11: there is no element \"face\": point clouds cannot be rendered"},
        {"element face 1",
         "element vertex 1\nproperty int x\nproperty int y\nproperty int z\nelement face 1",
         "a.ply:17: there is a second element \"vertex\""},
    };
    for (const auto& [from, to, message] : cases) {
        const std::string file = replaced(ascii_ply, from, to);
        EXPECT_EQ(error_of([&] { ply(file); }), message) << from;
    }
}

TEST(Ply, L2_L6_wrong_contents_are_refused) {
    const std::vector<std::array<std::string, 3>> cases = {
        {"4 0 1 2 3", "2 0 1 2 3", "a.ply:14: face 0 has 2 corners; it needs 3 or more"},
        {"4 0 1 2 3", "9 0 1 2 3", "a.ply:15: the file ends too early"},
        {"4 0 1 2 3", "-1 0 1 2 3", "a.ply:14: list \"vertex_indices\" has the length -1"},
        {"4 0 1 2 3", "4 0 1 2 -3", "a.ply:14: face 0 uses vertex -3"},
        {"4 0 1 2 3", "4 0 1 2 1.5",
         "a.ply:14: a value of an integer type should be a whole number"},
        {"1 1 0", "1 nan 0", "a.ply:12: a value is not finite"},
        {"1 1 0", "1 one 0", "a.ply:12: a value should be a number, not \"one\""},
    };
    for (const auto& [from, to, message] : cases) {
        const std::string file = replaced(ascii_ply, from, to);
        EXPECT_EQ(error_of([&] { ply(file); }), message) << to;
    }
}

// Serialized.

struct Flags {
    static constexpr std::uint32_t normals = 1, uvs = 2, colors = 8, face_normals = 16,
                                   double_precision = 0x2000, single_precision = 0x1000;
};

Bytes compressed(const Bytes& raw) {
    uLongf size = compressBound(raw.size());
    Bytes result(size);
    EXPECT_EQ(compress(result.data(), &size, raw.data(), raw.size()), Z_OK);
    result.resize(size);
    return result;
}

/// One triangle at height z, without header and table.
template <typename Number>
Bytes triangle(int version, std::uint32_t flags, double z, std::uint64_t vertices = 3,
               std::uint64_t triangles = 1) {
    Bytes raw;
    append(raw, flags);
    if (version == 4) raw.insert(raw.end(), {'t', 'r', 'i', 0});
    append(raw, vertices);
    append(raw, triangles);
    const auto numbers = [&](std::initializer_list<double> values) {
        for (const double value : values) append(raw, static_cast<Number>(value));
    };
    numbers({0, 0, z, 1, 0, z, 0, 1, z});
    if (flags & Flags::normals) numbers({0, 0, 1, 0, 0, 1, 0, 0, 1});
    if (flags & Flags::uvs) numbers({0, 0, 1, 0, 0, 1});
    if (flags & Flags::colors) numbers({1, 1, 1, 1, 1, 1, 1, 1, 1});
    for (const std::uint32_t i : {0u, 1u, 2u}) append(raw, i);
    return raw;
}

/// A file of several meshes.
Bytes container(std::uint16_t version, const std::vector<Bytes>& meshes) {
    Bytes file;
    std::vector<std::uint64_t> offsets;
    for (const Bytes& mesh : meshes) {
        offsets.push_back(file.size());
        append<std::uint16_t>(file, 0x041c);
        append(file, version);
        const Bytes packed = compressed(mesh);
        file.insert(file.end(), packed.begin(), packed.end());
    }
    for (const std::uint64_t offset : offsets) {
        if (version == 4) {
            append(file, offset);
        } else {
            append(file, static_cast<std::uint32_t>(offset));
        }
    }
    append(file, static_cast<std::uint32_t>(meshes.size()));
    return file;
}

Bytes three_meshes(std::uint16_t version) {
    return container(
        version,
        {triangle<float>(version, Flags::single_precision, 1),
         triangle<double>(version,
                          Flags::double_precision | Flags::normals | Flags::uvs | Flags::colors, 2),
         triangle<float>(version, Flags::uvs | Flags::face_normals, 3)});
}

TEST(Serialized, meshes_of_both_versions_and_precisions_are_read) {
    for (const std::uint16_t version : std::array<std::uint16_t, 2>{3, 4}) {
        const Bytes file = three_meshes(version);
        for (std::uint32_t i = 0; i < 3; ++i) {
            const MeshData mesh = serialized(file, i);
            ASSERT_EQ(mesh.positions.size(), 3u);
            EXPECT_EQ(mesh.positions[1], Vector3(1, 0, static_cast<float>(i + 1)));
            EXPECT_EQ(mesh.normals.size(), i == 1 ? 3u : 0u);
            EXPECT_EQ(mesh.uvs.size(), i == 0 ? 0u : 3u);
            EXPECT_EQ(mesh.face_normals, i == 2);
            EXPECT_EQ(mesh.warnings, Warnings());
            EXPECT_EQ(mesh.attributes.size(), i == 1 ? 1u : 0u);
            const std::size_t colors = i == 1 ? values_of(mesh, "vertex_color").size() : 0;
            EXPECT_EQ(colors, i == 1 ? 9u : 0u);
            EXPECT_EQ(mesh.indices, (Indices{0, 1, 2}));
        }
        EXPECT_EQ(error_of([&] { serialized(file, 3); }),
                  "a.serialized: \"shape_index\" is 3, but the file holds 3 meshes, counted from "
                  "0");
    }
}

TEST(Serialized, L4_truncated_at_every_length_is_refused) {
    const Bytes whole = container(4, {triangle<float>(4, Flags::normals, 1)});
    const Indices indices = serialized(whole).indices;
    // Neither the table nor the end of the stream is needed for the first mesh.
    const std::size_t table = 12, end_of_stream = 8;
    for (std::size_t length = 0; length < whole.size(); ++length) {
        const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
        Indices read;
        const std::string error = error_of([&] { read = serialized(part).indices; });
        EXPECT_TRUE(error.empty() ? read == indices : read.empty()) << length;
        EXPECT_TRUE(length + table + end_of_stream > whole.size() || !error.empty()) << length;
    }
}

TEST(Serialized, L5_wrong_files_are_refused) {
    const Bytes right = three_meshes(4);
    Bytes file = right;
    file[0] = 0;
    EXPECT_EQ(error_of([&] { serialized(file); }),
              "a.serialized: this is not a serialized mesh of Mitsuba");
    file = right;
    file[2] = 5;
    EXPECT_EQ(error_of([&] { serialized(file); }),
              "a.serialized: version 5 cannot be read, only 3 and 4");
    file = right;
    for (std::size_t i = 6; i < 30; ++i) file[i] = 0xff;
    EXPECT_EQ(error_of([&] { serialized(file); }), "a.serialized: the compressed data is damaged");
    file = right;
    file[file.size() - 4 - 16] = 77;  // offset of mesh 1
    EXPECT_EQ(error_of([&] { serialized(file, 1); }),
              "a.serialized: this is not a serialized mesh of Mitsuba");
    file[file.size() - 4 - 9] = 77;
    EXPECT_EQ(error_of([&] { serialized(file, 1); }),
              "a.serialized: its table of meshes is damaged");
    file = right;
    file.back() = 0xff;  // number of meshes
    EXPECT_EQ(error_of([&] { serialized(file, 1); }),
              "a.serialized: its table of meshes is damaged");
    // It promises more than its bytes can hold.
    file = container(4, {triangle<float>(4, 0, 1, 1ull << 60)});
    EXPECT_EQ(error_of([&] { serialized(file); }),
              "a.serialized: 1152921504606846976 vertices and 1 triangles do not fit into its " +
                  std::to_string(file.size()) + " bytes");
    file = container(4, {triangle<float>(4, 0, 1, 3, 100)});
    EXPECT_EQ(error_of([&] { serialized(file); }),
              "a.serialized: the mesh ends too early: the file is damaged");
}

// Shapes made of files.

class MeshShapes : public testing::Test {
protected:
    /// A shape of a file with these contents.
    std::string shape(const std::string& name, std::string_view contents,
                      const std::string& body = "") const {
        std::ofstream file(folder_ / name, std::ios::binary);
        file.write(contents.data(), static_cast<std::streamsize>(contents.size()));
        const std::string type = name.substr(name.rfind('.') + 1);
        return fmt::format("<shape type='{}'><string name='filename' value='{}'/>{}</shape>", type,
                           (folder_ / name).string(), body);
    }
    std::string shape(const std::string& name, const Bytes& contents,
                      const std::string& body = "") const {
        return shape(name, {reinterpret_cast<const char*>(contents.data()), contents.size()}, body);
    }

    TemporaryFolder folder_;
};

std::string flag(const std::string& name, bool value) {
    return fmt::format("<boolean name='{}' value='{}'/>", name, value);
}

/// Looks straight down on (x, y).
std::optional<Interaction> look_down(const World& world, float x, float y) {
    return world.scene().intersect({.o = {x, y, 10}, .d = {0, 0, -1}});
}

TEST_F(MeshShapes, A14_vertices_that_are_no_numbers_are_refused) {
    Bytes file = bytes_of(std::string("ply\nformat binary_little_endian 1.0\n") + ply_square);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const float x : {0.f, 0.f, 0.f, 1.f, nan, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.f}) {
        append(file, x);
    }
    append<std::uint8_t>(file, 3);
    for (const std::int32_t i : {0, 2, 3}) append(file, i);
    EXPECT_EQ(refusal(shape("a.ply", file)),
              "a.ply: vertex 1 is (nan, nan, nan); coordinates must be finite and below 1e+18");
    EXPECT_EQ(refusal(shape("b.obj", "v 0 0 0\nv 1 0 0\nv 0 2e18 0\nf 1 2 3\n")),
              "b.obj: vertex 2 is (0, 2e+18, 0); coordinates must be finite and below 1e+18");
}

TEST_F(MeshShapes, A15_indices_beyond_the_vertices_are_refused) {
    EXPECT_EQ(refusal(shape("a.ply", replaced(ascii_ply, "4 0 1 2 3", "4 0 1 2 4"))),
              "a.ply:14: face 0 uses vertex 4, but there are only 4, counted from 0");
}

TEST_F(MeshShapes, A10_triangles_without_area_are_never_hit) {
    const World world(shape("a.obj", std::string(square) + "f 1 2 3\nf 1 1 3\nf 2 2 2\n"
                                                           "v 2 0 0\nv 3 0 0\nv 4 0 0\nf 5 6 7\n"));
    EXPECT_TRUE(look_down(world, 0.7f, 0.3f));
    EXPECT_FALSE(look_down(world, 0.3f, 0.7f));
    EXPECT_FALSE(look_down(world, 3, 0));
    for (std::uint32_t i = 1; i < 4; ++i) {
        EXPECT_EQ(world.shape().area(i), 0);
        const Receiver from{.p = {0, 0, 1}};
        EXPECT_FALSE(world.shape().sample_solid_angle(i, from, {0.3f, 0.6f}));
        EXPECT_TRUE(is_finite(world.shape().sample_area(i, {0.3f, 0.6f}).n));
    }
}

TEST_F(MeshShapes, L7_a_mesh_without_triangles_loads) {
    for (const std::string& xml :
         {shape("a.obj", ""), shape("b.obj", square),
          shape("c.ply", replaced(replaced(ascii_ply, "face 1", "face 0"), "4 0 1 2 3\n", ""))}) {
        const World world(xml);
        EXPECT_EQ(world.shape().primitive_count(), 0u);
        EXPECT_FALSE(look_down(world, 0.3f, 0.3f));
        ASSERT_EQ(world.diagnostics().all().size(), 1u);
        const std::string& message = world.diagnostics().all()[0].message;
        EXPECT_TRUE(message.ends_with(": there are no faces: nothing of it is seen")) << message;
    }
}

TEST_F(MeshShapes, L7_degenerate_texture_coordinates_leave_finite_tangents) {
    const World world(shape("a.obj", std::string(square) + "vt 0.5 0.5\nf 1/1 2/1 3/1\n"));
    const auto at = look_down(world, 0.7f, 0.3f);
    ASSERT_TRUE(at);
    EXPECT_TRUE(is_finite(at->dpdu) && is_finite(at->dpdv));
    EXPECT_GT(glm::length(glm::cross(at->dpdu, at->dpdv)), 0.1f);
    EXPECT_EQ(at->uv, Vector2(0.5f, 0.5f));
}

TEST_F(MeshShapes, pictures_stand_upright_as_in_mitsuba) {
    const std::string textured =
        std::string(square) + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
    EXPECT_NEAR(look_down(World(shape("a.obj", textured)), 0.5f, 0.9f)->uv.y, 0.9, 1e-6);
    const std::string turned = shape("b.obj", textured, flag("flip_tex_coords", false));
    EXPECT_NEAR(look_down(World(turned), 0.5f, 0.9f)->uv.y, 0.1, 1e-6);
    // The y of the file's squares is 1 − v there.
    EXPECT_NEAR(look_down(World(shape("c.ply", binary_ply(true))), 0.5f, 0.9f)->uv.y, 0.9, 1e-6);
    const std::string upwards = shape("d.ply", binary_ply(true), flag("flip_tex_coords", true));
    EXPECT_NEAR(look_down(World(upwards), 0.5f, 0.9f)->uv.y, 0.1, 1e-6);
}

TEST_F(MeshShapes, normals_of_the_file_tell_the_outside) {
    // Wound clockwise, but with normals upwards.
    const std::string text = std::string(square) + "vn 0 0 1\nf 4//1 3//1 2//1 1//1\n";
    EXPECT_GT(look_down(World(shape("a.obj", text)), 0.5f, 0.4f)->n.z, 0);
    EXPECT_LT(look_down(World(shape("b.obj", text, flag("face_normals", true))), 0.5f, 0.4f)->n.z,
              0);
    EXPECT_LT(look_down(World(shape("c.obj", text, flag("flip_normals", true))), 0.5f, 0.4f)->n.z,
              0);
    const std::string mirror = "<transform name='to_world'><scale x='-1' y='1' z='1'/></transform>";
    EXPECT_GT(look_down(World(shape("d.obj", text, mirror)), -0.5f, 0.4f)->n.z, 0);
}

TEST_F(MeshShapes, missing_normals_are_smoothed_unless_faces_are_asked_for) {
    const std::string roof =
        "v -1 -1 0\nv -1 1 0\nv 0 -1 1\nv 0 1 1\nv 1 -1 0\nv 1 1 0\n"
        "f 1 3 4 2\nf 3 5 6 4\n";
    const auto smooth = look_down(World(shape("a.obj", roof)), 1e-4f, 0.3f);
    EXPECT_GT(smooth->shading.n.z, 0.999f);
    EXPECT_NEAR(smooth->n.z, std::sqrt(0.5), 1e-6);
    const auto flat =
        look_down(World(shape("b.obj", roof, flag("face_normals", true))), 1e-4f, 0.3f);
    EXPECT_EQ(flat->shading.n, flat->n);
}

TEST_F(MeshShapes, B9_a_mesh_far_from_the_origin_keeps_its_shape) {
    // Moved back in double, before anything is rounded.
    const std::string far = "v 1e7 0 0\nv 10000001 0 0\nv 10000000.25 1 0\nf 1 2 3\n";
    const World world(
        shape("a.obj", far, "<transform name='to_world'><translate x='-1e7'/></transform>"));
    EXPECT_EQ(world.shape().area(0), 0.5f);
    EXPECT_EQ(world.shape().bounds().max, Vector3(1, 1, 0));
}

TEST_F(MeshShapes, concave_faces_are_hit_inside_and_missed_outside) {
    const std::string l = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n";
    for (int first = 0; first < 6; ++first) {
        std::string face = "f";
        for (int i = 0; i < 6; ++i) face += fmt::format(" {}", (first + i) % 6 + 1);
        const World world(shape("a.obj", l + face));
        for (const float x : {0.01f, 0.5f, 0.99f, 1.01f, 1.5f, 1.99f}) {
            for (const float y : {0.02f, 0.49f, 0.98f, 1.02f, 1.51f, 1.98f}) {
                EXPECT_EQ(look_down(world, x, y).has_value(), x < 1 || y < 1) << x << ' ' << y;
            }
        }
    }
}

TEST_F(MeshShapes, texture_coordinates_of_ply_faces_reach_the_hit) {
    const World world(shape("a.ply", textured_faces, flag("flip_tex_coords", true)));
    EXPECT_NEAR(look_down(world, 0.2f, 0.7f)->uv.x, 0.2, 1e-6);
    EXPECT_NEAR(look_down(world, 0.2f, 0.7f)->uv.y, 0.7, 1e-6);
}

TEST_F(MeshShapes, attributes_reach_the_material_and_the_light) {
    const auto texture = [](const std::string& input, const std::string& name) {
        return "<texture type='mesh_attribute' name='" + input + "'><string name='name' value='" +
               name + "'/><float name='scale' value='0.1'/></texture>";
    };
    const std::string plain =
        "<bsdf type='diffuse'>" + texture("reflectance", "vertex_wind") + "</bsdf>";
    const World world(shape("a.ply", attributed_ply, plain));
    const auto at = look_down(world, 0.75f, 0.25f);
    ASSERT_TRUE(at);
    // (0.25, 0.5, 0.25) of the first three vertices.
    const Color expected =
        0.1f * (0.25f * Color(1, 2, 3) + 0.5f * Color(4, 5, 6) + 0.25f * Color(7, 8, 9));
    EXPECT_LT(glm::distance(at->shape->bsdf()->albedo(*at, {0, 0, 1}), expected), 1e-6f);
    const std::string grouped =
        "<shape type='merge'>" + shape("a.ply", attributed_ply, plain) + "</shape>";
    const World group(grouped);
    const auto inside = look_down(group, 0.75f, 0.25f);
    ASSERT_TRUE(inside);
    EXPECT_LT(glm::distance(inside->shape->bsdf()->albedo(*inside, {0, 0, 1}), expected), 1e-6f);

    const World lit(
        shape("b.ply", attributed_ply,
              "<emitter type='area'>" + texture("radiance", "face_color") + "</emitter>"));
    for (const Light& light : lit.scene().lights()) {
        const Color radiance = light.primitive < 2 ? Color(0.025f, 0.05f, 0.1f) : Color(0.2f, 0, 0);
        const Receiver above{.p = {0.6f, 0.4f, 2}, .n = {0, 0, -1}, .ns = {0, 0, -1}};
        const auto sample = light.emitter->sample_li(light, above, {0.3f, 0.6f});
        ASSERT_TRUE(sample);
        EXPECT_LT(glm::distance(sample->radiance, radiance), 1e-6f);
    }
}

TEST_F(MeshShapes, attributes_that_the_shape_has_not_are_refused) {
    const auto diffuse = [](const std::string& name) {
        return "<bsdf type='twosided'><bsdf type='diffuse'><texture type='mesh_attribute' "
               "name='reflectance'><string name='name' value='" +
               name + "'/></texture></bsdf></bsdf>";
    };
    EXPECT_EQ(refusal(shape("a.ply", attributed_ply, diffuse("vertex_colour"))),
              "a.ply: not read: alpha of vertex\n"
              "the shape has no attribute \"vertex_colour\"; it has vertex_color, vertex_heat, "
              "vertex_wind, face_color, face_load; did you mean \"vertex_color\"?");
    EXPECT_EQ(refusal("<shape type='sphere'>" + diffuse("vertex_color") + "</shape>"),
              "the shape has no attribute \"vertex_color\": it has none");
    EXPECT_EQ(refusal("<shape type='sphere'>" + diffuse("color") + "</shape>"),
              "\"name\" must begin with \"vertex_\" or \"face_\", as \"vertex_color\"");
}

TEST_F(MeshShapes, warnings_of_files_are_those_of_the_scene) {
    const World world(shape("a.obj", std::string(square) + "l 1 2\nf 1 3 2 4\n"));
    ASSERT_EQ(world.diagnostics().all().size(), 2u);
    EXPECT_EQ(world.diagnostics().all()[0].message,
              "a.obj:5: statements \"l\" are not read: only faces are");
    EXPECT_EQ(world.diagnostics().all()[1].message,
              "a.obj: 1 of its faces cross themselves, or are bent so much that they seem to: what "
              "is inside of them is not defined; cut them into triangles");
}

TEST_F(MeshShapes, parameters_without_effect_are_reported) {
    const World world(shape("a.obj", square + std::string("f 1 2 3\n"),
                            "<float name='max_smooth_angle' value='40'/>"));
    ASSERT_EQ(world.diagnostics().all().size(), 1u);
    EXPECT_EQ(world.diagnostics().all()[0].message,
              "\"max_smooth_angle\" has no effect: normals are smoothed over all edges whose faces "
              "share vertices; \"face_normals\" smooths none");
}

}  // namespace
}  // namespace lucerna
