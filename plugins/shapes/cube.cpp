// SPDX-License-Identifier: Apache-2.0
/// cube: the surface of [−1, 1]³, made of twelve triangles.
///
///   to_world      transform          any affine transform
///   flip_normals  boolean    false   the normals point inside
///
/// (u, v) runs over [0, 1]² on each face, placed as in Mitsuba (plugins/shapes/mesh.h).
#include "plugins/shapes/mesh.h"

namespace lucerna {
namespace {

/// A face: where (u, v) is (0, 0), and the edges along which u and v grow.
/// edge_u × edge_v points outside.
struct Face {
    Vector3d corner, edge_u, edge_v;
};

const Face faces[] = {
    {{1, -1, -1}, {0, 0, 2}, {-2, 0, 0}},  // y = −1
    {{1, 1, -1}, {-2, 0, 0}, {0, 0, 2}},   // y = 1
    {{1, -1, -1}, {0, 2, 0}, {0, 0, 2}},   // x = 1
    {{1, -1, 1}, {0, 2, 0}, {-2, 0, 0}},   // z = 1
    {{-1, -1, 1}, {0, 2, 0}, {0, 0, -2}},  // x = −1
    {{1, 1, -1}, {0, -2, 0}, {-2, 0, 0}},  // z = −1
};

class CubeShape final : public Mesh {
public:
    explicit CubeShape(const Params& params) : Mesh(params) {
        MeshData data;
        data.name = "cube";
        data.world_from_file = world_from_object();
        data.face_normals = true;
        data.reserve(24, 12);
        for (const Face& face : faces) {
            const auto first = static_cast<std::uint32_t>(data.positions.size());
            for (const Vector2d uv : {Vector2d(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
                data.add_position(face.corner + uv.x * face.edge_u + uv.y * face.edge_v);
                data.uvs.emplace_back(uv);
            }
            const std::uint32_t corners[] = {first, first + 1, first + 2, first + 3};
            data.add_polygon(corners);
        }
        assign(params, std::move(data));
    }
};

}  // namespace

const PluginInfo plugin = describe<CubeShape>("a cube, or any parallelepiped");

}  // namespace lucerna
