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
#include "core/scene/huge_pages.h"

#include <vector>

namespace lucerna {

class Parallelograms : public Shape {
public:
    Geometry geometry() const final { return ParallelogramGeometry{list_}; }
    Bounds3 bounds() const final { return bounds_; }

    void fill(const Ray&, const Hit& hit, Interaction& at) const final {
        const Parallelogram& it = list_[hit.primitive];
        const Facts& facts = facts_[hit.primitive];
        at.p = point(it, hit.uv);
        at.error = facts.error;
        at.n = facts.normal;
        at.uv = hit.uv;
        at.dpdu = it.edge_u;
        at.dpdv = it.edge_v;
        at.shading = needs_tangents() ? Frame::from_normal_tangent(at.n, it.edge_u)
                                      : Frame::from_normal(at.n);
    }

    std::uint32_t primitive_count() const final { return static_cast<std::uint32_t>(list_.size()); }

    float area(std::uint32_t primitive) const final { return facts_[primitive].area; }

    SurfaceSample sample_area(std::uint32_t primitive, Vector2 u) const final {
        const Facts& facts = facts_[primitive];
        return {.p = point(list_[primitive], u),
                .n = facts.normal,
                .uv = u,
                .error = facts.error,
                .pdf = 1 / facts.area};
    }

    std::optional<SurfaceSample> sample_solid_angle(std::uint32_t primitive, const Receiver& from,
                                                    Vector2 u) const final {
        const std::optional<SphericalRectangle> seen = spherical_rectangle(from.p, primitive);
        if (!seen) return seen_from(from.p, sample_area(primitive, u));
        SurfaceSample sample = sample_area(primitive, seen->sample(Vector2d(u)));
        sample.pdf = seen->pdf();
        return sample;
    }

    float pdf_solid_angle(std::uint32_t primitive, const Receiver& from, Vector3 wi,
                          const Interaction& hit) const final {
        const std::optional<SphericalRectangle> seen = spherical_rectangle(from.p, primitive);
        return seen ? seen->pdf() : Shape::pdf_solid_angle(primitive, from, wi, hit);
    }

    std::pair<Vector3, float> normal_cone(std::uint32_t primitive) const final {
        return {facts_[primitive].normal, 1.0f};
    }

    Bounds3 primitive_bounds(std::uint32_t primitive) const final {
        return bounds_of(list_[primitive]);
    }

protected:
    /// Empty until `assign`.
    explicit Parallelograms(const Params& params) : Shape(params) {}

    /// Takes parallelograms of the world; `flipped`: they face where edge_v × edge_u points.
    void assign(std::vector<Parallelogram> list, bool flipped) {
        list_.assign(list.begin(), list.end());
        facts_.reserve(list_.size());
        for (const Parallelogram& it : list_) {
            facts_.emplace_back(it, flipped ? -1.0f : 1.0f);
            const Bounds3 bounds = bounds_of(it);
            bounds_.include(bounds.min);
            bounds_.include(bounds.max);
        }
    }

private:
    /// What hits and samples ask for, computed once.
    struct Facts {
        Vector3 normal;  ///< unit length
        float area;
        float error;     ///< of points, for all coordinates alike
        float diagonal;  ///< the longer
        bool rectangle;

        Facts(const Parallelogram& it, float side)
            : error(gamma(7) *
                    max_component(absolute(it.corner) + absolute(it.edge_u) + absolute(it.edge_v))),
              diagonal(std::max(glm::length(it.edge_u + it.edge_v),
                                glm::length(it.edge_u - it.edge_v))) {
            const Vector3d n = glm::cross(Vector3d(it.edge_u), Vector3d(it.edge_v));
            const double length = glm::length(n);
            normal = length > 0 ? side * Vector3(n / length) : Vector3(0, 0, side);
            area = static_cast<float>(length);
            // Matrices are written with six digits; a shear below that biases nothing visible.
            const float uv = glm::dot(it.edge_u, it.edge_v);
            rectangle = std::abs(uv) < 1e-5f * glm::length(it.edge_u) * glm::length(it.edge_v);
        }
    };

    static Vector3 point(const Parallelogram& it, Vector2 uv) {
        return it.corner + uv.x * it.edge_u + uv.y * it.edge_v;
    }

    static Bounds3 bounds_of(const Parallelogram& it) {
        Bounds3 bounds;
        bounds.include(it.corner);
        bounds.include(it.corner + it.edge_u);
        bounds.include(it.corner + it.edge_v);
        bounds.include(it.corner + it.edge_u + it.edge_v);
        return bounds;
    }

    /// Empty if it must be sampled by area from there.
    std::optional<SphericalRectangle> spherical_rectangle(Vector3 p,
                                                          std::uint32_t primitive) const {
        const Parallelogram& it = list_[primitive];
        const Facts& facts = facts_[primitive];
        const Vector3 d = point(it, Vector2(0.5f)) - p;
        if (!facts.rectangle || sample_by_area(facts.diagonal, glm::dot(d, d))) return {};
        const SphericalRectangle seen(p, it.corner, it.edge_u, it.edge_v);
        if (!sample_by_solid_angle(seen.solid_angle())) return {};
        return seen;
    }

    std::vector<Parallelogram, HugePages<Parallelogram>> list_;
    std::vector<Facts, HugePages<Facts>> facts_;  ///< of each
    Bounds3 bounds_;
};

}  // namespace lucerna
