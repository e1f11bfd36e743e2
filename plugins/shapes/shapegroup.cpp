// SPDX-License-Identifier: Apache-2.0
/// shapegroup: shapes that are stored once and shown many times, through `instance`.
///
///   <shape>…   shapes, in the space of the group; without emitters, groups and instances
#include "plugins/shapes/group.h"

namespace lucerna {
namespace {

class ShapeGroup final : public SurfacelessShape {
public:
    explicit ShapeGroup(const Params& params)
        : shapes_(params.all_nested<Shape>({.min = 1}, "shapes of the group")) {
        for (const Shape* shape : shapes_) {
            if (shape->emitter()) {
                throw Error(
                    "a shape of a shapegroup has an emitter, which instances cannot carry; put "
                    "the emitting shape directly into the scene, once for each instance");
            }
            const Geometry geometry = shape->geometry();
            if (std::holds_alternative<GroupGeometry>(geometry) ||
                std::holds_alternative<InstanceGeometry>(geometry)) {
                throw Error(
                    "a shapegroup holds another shapegroup or an instance; only one level of "
                    "instancing is possible, so list the shapes themselves");
            }
        }
    }

    Geometry geometry() const override { return GroupGeometry{shapes_}; }
    /// Empty: the group itself is nowhere in the world.
    Bounds3 bounds() const override { return {}; }

private:
    std::vector<const Shape*> shapes_;
};

}  // namespace

const PluginInfo plugin = describe<ShapeGroup>("shapes to be shown by instances");

}  // namespace lucerna
