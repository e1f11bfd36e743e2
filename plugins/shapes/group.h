// SPDX-License-Identifier: Apache-2.0
/// What shapegroup and instance share: they place other shapes, and are never hit themselves.
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

}  // namespace lucerna
