// SPDX-License-Identifier: Apache-2.0
/// shapegroup: shapes that are stored once and shown many times, through `instance`.
///
///   <shape>…   shapes, in the space of the group; without emitters, groups and instances
#include "plugins/shapes/group.h"

namespace lucerna {
namespace {

class ShapeGroup final : public GroupShape {
public:
    explicit ShapeGroup(const Params& params) : GroupShape(params, ", once for each instance") {
        params.no_effect("to_world", "each instance places the group by its own");
    }
};

}  // namespace

const PluginInfo plugin = describe<ShapeGroup>("shapes to be shown by instances");

}  // namespace lucerna
