// SPDX-License-Identifier: Apache-2.0
/// What shapes made of parallelograms share (`rectangle`, `city`): each is one primitive, and one
/// light if the shape emits.
///
/// (u, v) runs along both edges; the front is where edge_u × edge_v points. As a light it is
/// sampled by solid angle (Ureña, Fajardo and King 2013); where it is not a rectangle, or is far or
/// very near, by area.
#pragma once

#include "core/interfaces/shape.h"
#include "core/math/rounding.h"
#include "core/math/solid_angle.h"

#include <vector>

namespace lucerna {

class Parallelograms : public Shape {
public:
    Geometry geometry() const final { return ParallelogramGeometry{list_}; }
    Bounds3 bounds() const final { return bounds_; }

    void fill(const Ray&, const Hit& hit, Interaction& at) const final {
        const Parallelogram& it = list_[hit.primitive];
        at.p = it.corner + hit.uv.x * it.edge_u + hit.uv.y * it.edge_v;
        at.error = error(it);
        at.n = normal(it);
        at.uv = hit.uv;
        at.dpdu = it.edge_u;
        at.dpdv = it.edge_v;
        at.shading = Frame::from_normal_tangent(at.n, it.edge_u);
    }

    std::uint32_t primitive_count() const final { return static_cast<std::uint32_t>(list_.size()); }

    float area(std::uint32_t primitive) const final {
        return static_cast<float>(glm::length(scaled_normal(list_[primitive])));
    }

    SurfaceSample sample_area(std::uint32_t primitive, Vector2 u) const final {
        const Parallelogram& it = list_[primitive];
        return {.p = it.corner + u.x * it.edge_u + u.y * it.edge_v,
                .n = normal(it),
                .uv = u,
                .error = error(it),
                .pdf = 1 / area(primitive)};
    }

    std::optional<SurfaceSample> sample_solid_angle(std::uint32_t primitive, const Receiver& from,
                                                    Vector2 u) const final {
        const std::optional<SphericalRectangle> seen = seen_from(from.p, list_[primitive]);
        if (!seen) return Shape::sample_solid_angle(primitive, from, u);
        SurfaceSample sample = sample_area(primitive, seen->sample(Vector2d(u)));
        sample.pdf = seen->pdf();
        return sample;
    }

    float pdf_solid_angle(std::uint32_t primitive, const Receiver& from, Vector3 wi,
                          const Interaction& hit) const final {
        const std::optional<SphericalRectangle> seen = seen_from(from.p, list_[primitive]);
        return seen ? seen->pdf() : Shape::pdf_solid_angle(primitive, from, wi, hit);
    }

    std::pair<Vector3, float> normal_cone(std::uint32_t primitive) const final {
        return {normal(list_[primitive]), 1.0f};
    }

    Bounds3 primitive_bounds(std::uint32_t primitive) const final {
        return bounds_of(list_[primitive]);
    }

protected:
    /// Empty until `assign`.
    explicit Parallelograms(const Params& params) : Shape(params) {}

    /// Takes parallelograms of the world; `flipped`: they face where edge_v × edge_u points.
    void assign(std::vector<Parallelogram> list, bool flipped) {
        list_ = std::move(list);
        side_ = flipped ? -1.0f : 1.0f;
        for (const Parallelogram& it : list_) {
            const Bounds3 bounds = bounds_of(it);
            bounds_.include(bounds.min);
            bounds_.include(bounds.max);
        }
    }

private:
    static Vector3d scaled_normal(const Parallelogram& it) {
        return glm::cross(Vector3d(it.edge_u), Vector3d(it.edge_v));
    }

    Vector3 normal(const Parallelogram& it) const {
        // In float unless it is so thin that the cross product cancels.
        const Vector3 c = glm::cross(it.edge_u, it.edge_v);
        const float length2 = glm::dot(c, c);
        const float scale2 = glm::dot(it.edge_u, it.edge_u) * glm::dot(it.edge_v, it.edge_v);
        constexpr float smallest = 1e-30f, largest = 1e30f;  // no square over- or underflows
        if (length2 > 0.01f * scale2 && length2 > smallest && scale2 < largest) {
            return (side_ / std::sqrt(length2)) * c;
        }
        const Vector3d n = scaled_normal(it);
        const double length = glm::length(n);
        return length > 0 ? side_ * Vector3(n / length) : Vector3(0, 0, side_);
    }

    static float error(const Parallelogram& it) {
        return gamma(7) *
               max_component(glm::abs(it.corner) + glm::abs(it.edge_u) + glm::abs(it.edge_v));
    }

    static Bounds3 bounds_of(const Parallelogram& it) {
        Bounds3 bounds;
        bounds.include(it.corner);
        bounds.include(it.corner + it.edge_u);
        bounds.include(it.corner + it.edge_v);
        bounds.include(it.corner + it.edge_u + it.edge_v);
        return bounds;
    }

    /// Matrices are written with six digits; a shear below that biases nothing visible.
    static bool is_rectangle(const Parallelogram& it) {
        const float uv = glm::dot(it.edge_u, it.edge_v);
        return std::abs(uv) < 1e-5f * glm::length(it.edge_u) * glm::length(it.edge_v);
    }

    /// Empty if it must be sampled by area from there.
    static std::optional<SphericalRectangle> seen_from(Vector3 p, const Parallelogram& it) {
        const Vector3 d = it.corner + 0.5f * (it.edge_u + it.edge_v) - p;
        const float diagonal =
            std::max(glm::length(it.edge_u + it.edge_v), glm::length(it.edge_u - it.edge_v));
        if (sample_by_area(diagonal, glm::dot(d, d)) || !is_rectangle(it)) return {};
        const SphericalRectangle seen(p, it.corner, it.edge_u, it.edge_v);
        if (!sample_by_solid_angle(seen.solid_angle())) return {};
        return seen;
    }

    std::vector<Parallelogram> list_;
    Bounds3 bounds_;
    float side_ = 1;
};

}  // namespace lucerna
