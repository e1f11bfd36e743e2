// SPDX-License-Identifier: Apache-2.0
/// instance: shows the shapes of a shapegroup once more.
///
///   <shape type="shapegroup">   the group, usually as a <ref>
///   to_world   transform        from the space of the group to the world
#include "plugins/shapes/group.h"

namespace lucerna {
namespace {

class InstanceShape final : public SurfacelessShape {
public:
    explicit InstanceShape(const Params& params)
        : world_from_group_(params.transform("to_world", "from the group to the world")),
          group_(params.nested<Shape>("the shapegroup, usually a reference")) {
        if (!group_ || !std::holds_alternative<GroupGeometry>(group_->geometry())) {
            throw Error(
                "an instance needs a shapegroup: <shape type=\"shapegroup\" id=\"tree\">…</shape> "
                "in the scene, and <ref id=\"tree\"/> in the instance");
        }
        const Geometry geometry = group_->geometry();
        for (const Shape* shape : std::get<GroupGeometry>(geometry).shapes) {
            bounds_.include(world_from_group_.bounds(shape->bounds()));
        }
    }

    Geometry geometry() const override { return InstanceGeometry{group_, world_from_group_}; }
    Bounds3 bounds() const override { return bounds_; }

private:
    Transform world_from_group_;
    const Shape* group_;
    Bounds3 bounds_;
};

}  // namespace

const PluginInfo plugin = describe<InstanceShape>("a shapegroup, placed in the world");

}  // namespace lucerna
