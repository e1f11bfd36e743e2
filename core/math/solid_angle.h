// SPDX-License-Identifier: Apache-2.0
/// Solid angles of triangles, rectangles and spheres, and uniform sampling of them.
///
/// All are seen from a reference point `p`, computed in double and exact also for shapes that are
/// tiny or nearly fill the hemisphere. `sample` maps u in [0, 1)² to the shape, `invert` maps back;
/// the density is 1 / solid_angle [1/sr].
#pragma once

#include "core/math/vector.h"

#include <optional>

namespace lucerna {

/// Whether a polygon of this solid angle [sr] should be sampled by solid angle. Below, sampling by
/// area is as good and cheaper; above, the polygon touches the reference point. The answer must
/// decide for sample and pdf alike.
constexpr bool sample_by_solid_angle(double solid_angle) {
    return solid_angle > 3e-4 && solid_angle < 6.22;
}

/// True if a flat polygon of extent `diagonal` is far enough from the reference point (squared
/// distance `distance2` to its centre) to be sampled by area: its points then differ little enough
/// in distance and cosine that the noise grows by some percent only, for half of the cost.
constexpr bool sample_by_area(float diagonal, float distance2) {
    return distance2 > diagonal * diagonal;
}

/// The density per solid angle [1/sr], seen from `from`, of a density per area [1/m²] at the point
/// `p` with the unit normal `n` (Veach 1997, 8.2.2.2). In double where floats over- or underflow,
/// or would lose what a grazing cosine has left; infinite or not a number where not defined.
inline float solid_angle_density(float pdf_area, Vector3 from, Vector3 p, Vector3 n) {
    const Vector3 d = p - from;
    const float distance2 = glm::dot(d, d), projected = std::abs(glm::dot(d, n));
    if (projected * projected > 1e-4f * distance2 && distance2 > 1e-20f && distance2 < 1e20f) {
        return pdf_area * (distance2 / projected * std::sqrt(distance2));
    }
    const Vector3d exact = Vector3d(p) - Vector3d(from);
    const double exact2 = glm::dot(exact, exact);
    const double cosine = std::abs(glm::dot(exact, Vector3d(n))) / std::sqrt(exact2);
    return static_cast<float>(static_cast<double>(pdf_area) * exact2 / cosine);
}

/// Whether samples can be weighted with it.
inline bool is_usable_density(float pdf) { return pdf > 0 && pdf < infinity; }

/// Solid angle [sr] of the triangle, in [0, 2π] (Van Oosterom and Strackee 1983). The determinant
/// is taken of edge differences, because that of unit vectors cancels for small triangles.
double triangle_solid_angle(Vector3d p, Vector3d v0, Vector3d v1, Vector3d v2);

/// A triangle seen from a point, for uniform sampling by solid angle
/// (Arvo 1995, "Stratified Sampling of Spherical Triangles").
class SphericalTriangle {
public:
    struct Sample {
        Vector3 direction;
        /// (b0, b1): the point hit is b0 v0 + b1 v1 + (1 − b0 − b1) v2.
        Vector2 barycentrics;
    };

    SphericalTriangle(Vector3 p, Vector3 v0, Vector3 v1, Vector3 v2);

    double solid_angle() const { return solid_angle_; }
    float pdf() const { return static_cast<float>(1 / solid_angle_); }
    /// Only for a solid angle above zero.
    Sample sample(Vector2d u) const;
    /// The u for which `sample` returns `direction`, which must hit the triangle.
    Vector2d invert(Vector3d direction) const;

private:
    /// Vertices relative to the reference point, then unit directions to them.
    Vector3d v0_, v1_, v2_, a_, b_;
    /// Unit tangent at a_ towards v2.
    Vector3d towards_c_;
    /// Angle at a_, and tan(half the arc from a_ to b_).
    double alpha_, tan_half_ab_;
    double solid_angle_;
};

/// A rectangle seen from a point, for uniform sampling by solid angle
/// (Ureña, Fajardo, King 2013, "An Area-Preserving Parametrization for Spherical Rectangles").
class SphericalRectangle {
public:
    /// The edges leave `corner` and must be perpendicular.
    SphericalRectangle(Vector3 p, Vector3 corner, Vector3 edge_x, Vector3 edge_y);

    double solid_angle() const { return solid_angle_; }
    float pdf() const { return static_cast<float>(1 / solid_angle_); }
    /// Position (s, t) in [0, 1]²: the point is corner + s·edge_x + t·edge_y. Only for a solid
    /// angle above zero.
    Vector2 sample(Vector2d u) const;
    /// The u for which `sample` returns `st`.
    Vector2d invert(Vector2d st) const;

private:
    /// Solid angle of the part from x0_ to x.
    double solid_angle_up_to(double x) const;

    /// Extent in a frame around p whose axes follow the edges; distance of the plane.
    double x0_, x1_, y0_, y1_, z_;
    double solid_angle_;
};

/// 1 − cos θ for sin² θ, without cancellation; θ ≤ 90°.
inline double one_minus_cos_from_sin2(double sin2) { return sin2 / (1 + safe_sqrt(1 - sin2)); }

/// A sphere seen from a point outside it, for uniform sampling of the cone of directions to it.
class SphereCone {
public:
    struct Sample {
        Vector3 direction;
        /// Outward normal n where `direction` first meets the sphere: the point is
        /// center + radius·n.
        Vector3 normal;
    };

    /// Empty if p is inside or on the sphere: then sample by area.
    static std::optional<SphereCone> from(Vector3 p, Vector3 center, float radius);

    double solid_angle() const { return 2 * std::numbers::pi * one_minus_cos_; }
    float pdf() const { return static_cast<float>(1 / solid_angle()); }
    Sample sample(Vector2d u) const;

private:
    SphereCone(Vector3d axis, double sin2)
        : axis_(axis), sin2_(sin2), one_minus_cos_(one_minus_cos_from_sin2(sin2)) {}

    /// Unit vector to the center; sin² of the cone's half angle.
    Vector3d axis_;
    double sin2_, one_minus_cos_;
};

}  // namespace lucerna
