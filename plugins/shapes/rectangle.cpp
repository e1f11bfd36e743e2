// SPDX-License-Identifier: Apache-2.0
/// rectangle: the square [−1, 1]² in the plane z = 0, facing +z (plugins/shapes/parallelograms.h).
///
///   to_world      transform          any affine transform: it may become a parallelogram
///   flip_normals  boolean    false   faces −z
///
/// u runs along x, v against y (plugins/shapes/mesh.h tells why).
#include "plugins/shapes/parallelograms.h"

namespace lucerna {
namespace {

class RectangleShape final : public Parallelograms {
public:
    explicit RectangleShape(const Params& params) : Parallelograms(params) {
        const Transform& transform = world_from_object();
        const Parallelogram square{.corner = Vector3(transform.point(Vector3d(-1, 1, 0))),
                                   .edge_u = Vector3(transform.direction(Vector3d(2, 0, 0))),
                                   .edge_v = Vector3(transform.direction(Vector3d(0, -2, 0)))};
        // u × v points to −z; mirroring turns it over, but not the outside.
        assign({square}, flip_normals() == transform.swaps_handedness());
    }
};

}  // namespace

const PluginInfo plugin = describe<RectangleShape>("a rectangle or parallelogram");

}  // namespace lucerna
