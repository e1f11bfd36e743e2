// SPDX-License-Identifier: Apache-2.0
/// obj: a mesh from a Wavefront OBJ file.
///
///   filename         string             required
///   flip_tex_coords  boolean    true    v counts upwards in the file, as is usual for OBJ; false:
///                                       downwards
///   face_normals     boolean    false   ignores vertex normals, which gives a faceted look
///   to_world         transform
///   flip_normals     boolean    false
///
/// All faces of all objects and groups become one mesh; polygons, concave ones too, are cut into
/// triangles. Materials of the file are not read: the shape's BSDF holds for all of it, and a
/// warning says so if there are several. `lucerna import` makes a scene with materials of such a
/// file. Without normals, smooth ones are computed. Lines, points, curved surfaces and vertex
/// colours are not read, with a warning.
#include "core/base/file_bytes.h"
#include "plugins/shapes/obj_reader.h"

namespace lucerna {
namespace {

class ObjShape final : public Mesh {
public:
    explicit ObjShape(const Params& params) : Mesh(params) {
        const bool upwards =
            params.boolean("flip_tex_coords", true, "v counts upwards in the file");
        params.no_effect("collapse", "an OBJ file is always one shape");
        const std::filesystem::path path = params.file("filename", "the OBJ file");
        if (path.empty()) return;
        MeshData data =
            read_obj(read_file_bytes(path), path.filename().string(), world_from_object());
        if (!upwards) data.flip_v();
        assign(params, std::move(data));
    }
};

}  // namespace

const PluginInfo plugin = describe<ObjShape>("a mesh from a Wavefront OBJ file");

}  // namespace lucerna
