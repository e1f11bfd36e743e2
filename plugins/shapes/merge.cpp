// SPDX-License-Identifier: Apache-2.0
/// merge: shapes as one. Mitsuba joins their meshes; here they are a group that is shown where it
/// is, and keep their materials.
///
///   <shape>…   shapes, in the world; without emitters, groups and instances
#include "plugins/shapes/group.h"

namespace lucerna {
namespace {

class MergedShapes final : public GroupShape {
public:
    explicit MergedShapes(const Params& params) : GroupShape(params, "") {}
};

class MergeShape final : public SurfacelessShape {
public:
    explicit MergeShape(const Params& params) : group_(params) {
        const Geometry geometry = group_.geometry();
        for (const Shape* shape : std::get<GroupGeometry>(geometry).shapes) {
            bounds_.include(shape->bounds());
        }
    }

    Geometry geometry() const override { return InstanceGeometry{&group_, Transform()}; }
    Bounds3 bounds() const override { return bounds_; }

private:
    MergedShapes group_;
    Bounds3 bounds_;
};

}  // namespace

const PluginInfo plugin = describe<MergeShape>("shapes as one");

}  // namespace lucerna
