// SPDX-License-Identifier: Apache-2.0
/// The kinds of geometry that rays are traced against, and points on them.
#pragma once

#include "core/interfaces/interaction.h"
#include "core/math/bounds.h"
#include "core/math/transform.h"

#include <span>
#include <variant>
#include <vector>

namespace lucerna {

/// Positions of vertices that lie `stride` floats apart. There are 16 readable bytes at each.
struct VertexPositions {
    const float* first = nullptr;
    std::size_t count = 0;
    std::size_t stride = 3;

    Vector3 operator[](std::size_t i) const {
        const float* const p = first + i * stride;
        return {p[0], p[1], p[2]};
    }
};

/// Vertices and, three to a triangle, their indices. The shape keeps the memory.
struct TriangleGeometry {
    VertexPositions positions;
    std::span<const std::uint32_t> indices;
};

/// corner + u edge_u + v edge_v for u, v in [0, 1].
struct Parallelogram {
    Vector3 corner, edge_u, edge_v;
};

/// One parallelogram to a primitive.
struct ParallelogramGeometry {
    std::vector<Parallelogram> list;
};

/// Round curves, each a chain of segments (Embree's, with spherical ends of linear ones). The shape
/// keeps the memory.
struct CurveGeometry {
    enum class Basis { linear, bspline } basis;
    std::span<const glm::vec4> points;         ///< x, y, z, radius
    std::span<const std::uint32_t> first;      ///< control point of each segment
    std::span<const std::uint8_t> neighbours;  ///< linear segments: 1 if one is before, 2 if behind
};

/// One primitive that answers rays by itself through `Shape::intersect`.
struct AnalyticGeometry {
    Bounds3 bounds;
};

/// A set of shapes, placed once more.
struct InstanceGeometry {
    const Shape* group;
    Transform world_from_group;
};

/// Shapes that are only seen through instances.
struct GroupGeometry {
    std::span<const Shape* const> shapes;
};

using Geometry = std::variant<TriangleGeometry, ParallelogramGeometry, CurveGeometry,
                              AnalyticGeometry, InstanceGeometry, GroupGeometry>;

/// Where a ray met a primitive.
struct Hit {
    float t = infinity;
    Vector2 uv{
        0};  ///< barycentrics of vertices 1 and 2, u and v of a parallelogram, u of a curve's
             ///< segment, or free
    std::uint32_t primitive = 0;
};

/// A point on a surface, chosen by area or by solid angle.
struct SurfaceSample {
    Vector3 p{0};
    Vector3 n{0, 0, 1};
    Vector2 hit_uv{0};  ///< place on the primitive: Hit::uv of rays that meet it there
    float error = 0;
    float pdf = 0;  ///< per area [1/m²] or per solid angle [1/sr]: the function says
};

}  // namespace lucerna
