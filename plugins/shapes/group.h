// SPDX-License-Identifier: Apache-2.0
/// What shapegroup, instance and merge share: they place other shapes, and are never hit
/// themselves.
#pragma once

#include "core/interfaces/shape.h"

namespace lucerna {

/// A shape without a surface of its own: there is nothing to hit, and nothing to sample.
class SurfacelessShape : public Shape {
public:
    SurfacelessShape() : Shape(NoSurface()) {}

    void fill(const Ray&, const Hit&, Interaction&) const final {}
    std::uint32_t primitive_count() const final { return 0; }
    float area(std::uint32_t) const final { return 0; }
    SurfaceSample sample_area(std::uint32_t, Vector2) const final { return {}; }
};

/// Shapes to be shown by instances.
class GroupShape : public SurfacelessShape {
public:
    Geometry geometry() const final { return GroupGeometry{shapes_}; }
    /// Empty: the group itself is nowhere in the world.
    Bounds3 bounds() const final { return {}; }

protected:
    /// `emitter_remedy` ends the message about a shape that emits.
    GroupShape(const Params& params, const std::string& emitter_remedy)
        : shapes_(params.all_nested<Shape>({.min = 1}, "shapes of the group")) {
        for (const Shape* shape : shapes_) {
            if (shape->emitter()) {
                throw Error("a shape of a " + params.type() +
                            " has an emitter, which instances cannot carry; put the emitting "
                            "shape directly into the scene" +
                            emitter_remedy);
            }
            const Geometry geometry = shape->geometry();
            if (std::holds_alternative<GroupGeometry>(geometry) ||
                std::holds_alternative<InstanceGeometry>(geometry)) {
                throw Error("a " + params.type() +
                            " holds another shapegroup or an instance; only one level of "
                            "instancing is possible, so list the shapes themselves");
            }
        }
    }

private:
    std::vector<const Shape*> shapes_;
};

}  // namespace lucerna
