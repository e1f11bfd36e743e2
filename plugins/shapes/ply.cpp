// SPDX-License-Identifier: Apache-2.0
/// ply: a mesh from a PLY file, ASCII or binary.
///
///   filename         string             required
///   flip_tex_coords  boolean    false   v counts upwards in the file; false: downwards
///   face_normals     boolean    false   ignores vertex normals, which gives a faceted look
///   to_world         transform
///   flip_normals     boolean    false
///
/// Reads x y z, nx ny nz, u v (or s t, texture_u texture_v) of vertices, and vertex_indices and
/// texcoord of faces; polygons, concave ones too, are cut into triangles. Triangle strips are read,
/// too. Colours and other numbers of vertices and faces become attributes (ply_attributes.h) for
/// the texture `mesh_attribute`. A warning lists what is not read. Without normals, smooth ones are
/// computed.
#include "core/base/file_bytes.h"
#include "plugins/shapes/ply_reader.h"

namespace lucerna {
namespace {

class PlyShape final : public Mesh {
public:
    explicit PlyShape(const Params& params) : Mesh(params) {
        const bool upwards =
            params.boolean("flip_tex_coords", false, "v counts upwards in the file");
        const std::filesystem::path path = params.file("filename", "the PLY file");
        if (path.empty()) return;
        MeshData data =
            read_ply(read_file_bytes(path), path.filename().string(), world_from_object());
        if (!upwards) data.flip_v();
        assign(params, std::move(data));
    }
};

}  // namespace

const PluginInfo plugin = describe<PlyShape>("a mesh from a PLY file");

}  // namespace lucerna
