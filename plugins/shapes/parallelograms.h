// SPDX-License-Identifier: Apache-2.0
/// What shapes made of parallelograms share (`rectangle`, `city`): each is one primitive, and one
/// light if the shape emits.
///
/// (u, v) runs along both edges; the front is where edge_u × edge_v points. As a light it is
/// sampled by solid angle (Ureña, Fajardo and King 2013); where it is not a rectangle, or is far or
/// very near, by area.
#pragma once

#include "core/base/huge_pages.h"
#include "core/interfaces/shape.h"
#include "core/math/rounding.h"
#include "core/math/solid_angle.h"

#include <vector>

namespace lucerna {

class Parallelograms : public Shape {
public:
    Geometry geometry() const final {
        return ParallelogramGeometry{{entries_.begin(), entries_.end()}};
    }
    Bounds3 bounds() const final { return bounds_; }

    void fill(const Ray&, const Hit& hit, Interaction& at) const final {
        const Entry& it = entries_[hit.primitive];
        at.p = it.point(hit.uv);
        at.error = it.error;
        at.n = it.normal;
        at.uv = hit.uv;
        at.dpdu = it.edge_u;
        at.dpdv = it.edge_v;
        at.shading = Frame::from_normal_tangent(at.n, it.edge_u);
    }

    void prefetch(std::uint32_t primitive, Batch::Prefetch what) const {
        if (what == Batch::Prefetch::addresses) __builtin_prefetch(&entries_[primitive]);
    }

    std::uint32_t primitive_count() const final {
        return static_cast<std::uint32_t>(entries_.size());
    }

    float area(std::uint32_t primitive) const final { return entries_[primitive].area; }

    SurfaceSample sample_area(std::uint32_t primitive, Vector2 u) const final {
        const Entry& it = entries_[primitive];
        return {
            .p = it.point(u), .n = it.normal, .hit_uv = u, .error = it.error, .pdf = 1 / it.area};
    }

    void sample_area_lanes(std::uint32_t primitive, const Vector2Lanes& u, std::size_t,
                           SurfaceSampleLanes& out) const {
        const Entry it = entries_[primitive];  // which `out` cannot overlap
        const float pdf = 1 / it.area;
        for (std::size_t i = 0; i < lane_count; ++i) {
            out.p.set(i, it.point(u[i]));
            out.n.set(i, it.normal);
            out.error[i] = it.error;
            out.pdf[i] = pdf;
        }
        out.hit_uv = u;
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
        return {entries_[primitive].normal, 1.0f};
    }

    Bounds3 primitive_bounds(std::uint32_t primitive) const final {
        return bounds_of(entries_[primitive]);
    }

protected:
    /// Empty until `assign`.
    explicit Parallelograms(const Params& params) : Shape(params) {}

    /// Takes parallelograms of the world; `flipped`: they face where edge_v × edge_u points.
    void assign(std::vector<Parallelogram> list, bool flipped) {
        entries_.reserve(list.size());
        for (const Parallelogram& it : list) {
            entries_.emplace_back(it, flipped ? -1.0f : 1.0f);
            const Bounds3 bounds = bounds_of(it);
            bounds_.include(bounds.min);
            bounds_.include(bounds.max);
        }
    }

private:
    /// With what hits and samples ask for, computed once: one line of the cache.
    struct alignas(64) Entry : Parallelogram {
        Vector3 normal;  ///< unit length
        float area;
        float error;     ///< of points, for all coordinates alike
        float diagonal;  ///< the longer
        bool rectangle;

        Entry(const Parallelogram& it, float side)
            : Parallelogram(it),
              error(gamma(7) *
                    max_component(absolute(corner) + absolute(edge_u) + absolute(edge_v))),
              diagonal(std::max(glm::length(edge_u + edge_v), glm::length(edge_u - edge_v))) {
            const Vector3d n = glm::cross(Vector3d(edge_u), Vector3d(edge_v));
            const double length = glm::length(n);
            normal = length > 0 ? side * Vector3(n / length) : Vector3(0, 0, side);
            area = static_cast<float>(length);
            // Matrices are written with six digits; a shear below that biases nothing visible.
            const float uv = glm::dot(edge_u, edge_v);
            rectangle = std::abs(uv) < 1e-5f * glm::length(edge_u) * glm::length(edge_v);
        }

        Vector3 point(Vector2 uv) const { return corner + uv.x * edge_u + uv.y * edge_v; }
    };

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
        const Entry& it = entries_[primitive];
        const Vector3 d = it.point(Vector2(0.5f)) - p;
        if (!it.rectangle || sample_by_area(it.diagonal, glm::dot(d, d))) return {};
        const SphericalRectangle seen(p, it.corner, it.edge_u, it.edge_v);
        if (!sample_by_solid_angle(seen.solid_angle())) return {};
        return seen;
    }

    std::vector<Entry, HugePages<Entry>> entries_;
    Bounds3 bounds_;
};

}  // namespace lucerna
