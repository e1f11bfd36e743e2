// SPDX-License-Identifier: Apache-2.0
/// Solid angles and their sampling.
#include "core/math/solid_angle.h"

#include <complex>

namespace lucerna {
namespace {

/// The part of `v` perpendicular to the unit vector `axis`.
Vector3d perpendicular(Vector3d v, Vector3d axis) { return v - glm::dot(v, axis) * axis; }

/// √(x² + y²); std::hypot's care against overflow would cost more than all the rest.
double length_of(double x, double y) { return std::sqrt(x * x + y * y); }

/// A complex number whose argument is half the solid angle of the triangle a b c.
std::complex<double> half_solid_angle(Vector3d a, Vector3d b, Vector3d c) {
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    return {la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb,
            std::abs(glm::dot(a, glm::cross(b - a, c - a)))};
}

double solid_angle_of(Vector3d a, Vector3d b, Vector3d c) {
    return 2 * std::arg(half_solid_angle(a, b, c));
}

}  // namespace

double triangle_solid_angle(Vector3d p, Vector3d v0, Vector3d v1, Vector3d v2) {
    return solid_angle_of(v0 - p, v1 - p, v2 - p);
}

SphericalTriangle::SphericalTriangle(Vector3 p, Vector3 v0, Vector3 v1, Vector3 v2)
    : v0_(Vector3d(v0) - Vector3d(p)),
      v1_(Vector3d(v1) - Vector3d(p)),
      v2_(Vector3d(v2) - Vector3d(p)),
      a_(glm::normalize(v0_)),
      b_(glm::normalize(v1_)),
      solid_angle_(solid_angle_of(v0_, v1_, v2_)) {
    // Tangents from the edges, not the vertices: exact however small the triangle is.
    const Vector3d towards_b = perpendicular(v1_ - v0_, a_);
    const Vector3d towards_c = perpendicular(v2_ - v0_, a_);
    alpha_ =
        std::atan2(glm::length(glm::cross(towards_b, towards_c)), glm::dot(towards_b, towards_c));
    towards_c_ = glm::normalize(towards_c);
    tan_half_ab_ = glm::length(b_ - a_) / glm::length(b_ + a_);
}

SphericalTriangle::Sample SphericalTriangle::sample(Vector2d u) const {
    // The sub-triangle a b c' of area u.x·Ω. Its area E obeys
    // tan(E/2) = tan(b/2) tan(c/2) sin α / (1 + tan(b/2) tan(c/2) cos α)  (Todhunter, "Spherical
    // Trigonometry", art. 103), which gives the arc from a to c': tan(b/2) = s / t.
    const double half_area = 0.5 * u.x * solid_angle_;
    const double s = std::sin(half_area), t = tan_half_ab_ * std::sin(alpha_ - half_area);
    const Vector3d c = ((t * t - s * s) * a_ + 2 * s * t * towards_c_) / (t * t + s * s);

    // A point of the arc from b to c', uniform in its distance cosine.
    const Vector3d chord = c - b_;
    const double drop = u.y * 0.5 * glm::dot(chord, chord);
    const Vector3d side = perpendicular(chord, b_);
    const double side_length = glm::length(side);
    Vector3d w = (1 - drop) * b_;
    if (side_length > 0) w += safe_sqrt(drop * (2 - drop)) / side_length * side;

    // Where w meets the plane.
    const Vector3d e1 = v1_ - v0_, e2 = v2_ - v0_;
    const Vector3d n = glm::cross(e1, e2);
    const Vector3d q = w * (glm::dot(v0_, n) / glm::dot(w, n)) - v0_;
    const double n2 = glm::dot(n, n);
    const double b1 = std::clamp(glm::dot(glm::cross(q, e2), n) / n2, 0.0, 1.0);
    const double b2 = std::clamp(glm::dot(glm::cross(e1, q), n) / n2, 0.0, 1.0 - b1);
    return {Vector3(w), Vector2(Vector2d(1 - b1 - b2, b1))};
}

Vector2d SphericalTriangle::invert(Vector3d direction) const {
    // c' is where the great circle through b and w meets the arc from a to c. On the circle of the
    // arc, a point is cos β·a + sin β·towards_c.
    const Vector3d w = glm::normalize(direction);
    const Vector3d n = glm::cross(b_, w - b_);
    double cosine = glm::dot(n, towards_c_), sine = -glm::dot(n, a_);
    if (sine < 0) {
        cosine = -cosine;
        sine = -sine;
    }
    const double length = length_of(cosine, sine);
    if (!(length > 0)) return {0, 0};
    const Vector3d c = (cosine * a_ + sine * towards_c_) / length;
    const Vector3d to_c = c - b_, to_w = w - b_;
    const Vector2d u(solid_angle_of(a_, b_, c) / solid_angle_,
                     glm::dot(to_w, to_w) / glm::dot(to_c, to_c));
    return glm::clamp(u, 0.0, 1.0);
}

SphericalRectangle::SphericalRectangle(Vector3 p, Vector3 corner, Vector3 edge_x, Vector3 edge_y) {
    const Vector3d ex(edge_x), ey(edge_y), to_corner = Vector3d(corner) - Vector3d(p);
    const double width = glm::length(ex), height = glm::length(ey);
    x0_ = glm::dot(to_corner, ex) / width;
    y0_ = glm::dot(to_corner, ey) / height;
    z_ = std::abs(glm::dot(to_corner, glm::normalize(glm::cross(ex, ey))));
    x1_ = x0_ + width;
    y1_ = y0_ + height;
    solid_angle_ = solid_angle_up_to(x1_);
}

double SphericalRectangle::solid_angle_up_to(double x) const {
    const Vector3d v00(x0_, y0_, z_), v10(x, y0_, z_), v11(x, y1_, z_), v01(x0_, y1_, z_);
    // Arguments add up in a product: one arctangent for both triangles. Their sum is at most π,
    // which rounding may turn into −π.
    const double half = std::arg(half_solid_angle(v00, v10, v11) * half_solid_angle(v00, v11, v01));
    return half < 0 ? 2 * std::numbers::pi : 2 * half;
}

Vector2 SphericalRectangle::sample(Vector2d u) const {
    // The paper's internal angles γ2 and γ3 and the cosines b0 and b1, with acos written as atan2.
    const double gamma2 = std::atan2(z_ * std::sqrt(x0_ * x0_ + y1_ * y1_ + z_ * z_), x0_ * y1_);
    const double gamma3 = std::atan2(z_ * std::sqrt(x0_ * x0_ + y0_ * y0_ + z_ * z_), -x0_ * y0_);
    const double b0 = -y0_ / length_of(y0_, z_), b1 = y1_ / length_of(y1_, z_);
    const double angle = u.x * solid_angle_ + 2 * std::numbers::pi - gamma2 - gamma3;
    const double f = (std::cos(angle) * b0 - b1) / std::sin(angle);
    const double c = std::clamp(std::copysign(1.0, f) / length_of(f, b0), -1.0, 1.0);
    const double x = std::clamp(c * z_ / safe_sqrt((1 - c) * (1 + c)), x0_, x1_);

    // Along y, the sine of the elevation is uniform.
    const double d = length_of(x, z_);
    const double h0 = y0_ / length_of(d, y0_), h1 = y1_ / length_of(d, y1_);
    const double h = h0 + u.y * (h1 - h0);
    const double y = std::clamp(h * d / safe_sqrt((1 - h) * (1 + h)), y0_, y1_);
    return Vector2(Vector2d((x - x0_) / (x1_ - x0_), (y - y0_) / (y1_ - y0_)));
}

Vector2d SphericalRectangle::invert(Vector2d st) const {
    const double x = x0_ + st.x * (x1_ - x0_), y = y0_ + st.y * (y1_ - y0_);
    const double d = length_of(x, z_);
    const double h0 = y0_ / length_of(d, y0_), h1 = y1_ / length_of(d, y1_);
    const double h = y / length_of(d, y);
    return glm::clamp(Vector2d(solid_angle_up_to(x) / solid_angle_, (h - h0) / (h1 - h0)), 0.0,
                      1.0);
}

std::optional<SphereCone> SphereCone::from(Vector3 p, Vector3 center, float radius) {
    const Vector3d to_center = Vector3d(center) - Vector3d(p);
    const double distance2 = glm::dot(to_center, to_center);
    const double sin2 = sqr(static_cast<double>(radius)) / distance2;
    if (!(sin2 < 1)) return {};
    return SphereCone(to_center / std::sqrt(distance2), sin2);
}

SphereCone::Sample SphereCone::sample(Vector2d u) const {
    const double t = u.x * one_minus_cos_;
    const double phi = 2 * std::numbers::pi * u.y;
    const double cos = 1 - t, sin2 = t * (2 - t);
    // Any frame around the axis (Duff et al. 2017).
    const double sign = std::copysign(1.0, axis_.z), a = -1 / (sign + axis_.z);
    const double b = axis_.x * axis_.y * a;
    const Vector3d x(1 + sign * axis_.x * axis_.x * a, sign * b, -sign * axis_.x);
    const Vector3d y(b, sign + axis_.y * axis_.y * a, -axis_.y);
    const Vector3d side = std::cos(phi) * x + std::sin(phi) * y;

    // The angle at the center between the point and the way back to p (pbrt 4e, 6.2.4).
    const double sin_max = std::sqrt(sin2_), sin = std::sqrt(sin2);
    const double ratio = std::min(sin / sin_max, 1.0);
    const double cos_alpha = sin * ratio + cos * safe_sqrt((1 - ratio) * (1 + ratio));
    const double sin_alpha = safe_sqrt((1 - cos_alpha) * (1 + cos_alpha));
    return {Vector3(cos * axis_ + sin * side), Vector3(sin_alpha * side - cos_alpha * axis_)};
}

}  // namespace lucerna
