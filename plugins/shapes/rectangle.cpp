// SPDX-License-Identifier: Apache-2.0
/// rectangle: the square [−1, 1]² in the plane z = 0, facing +z.
///
///   to_world      transform          any affine transform: it may become a parallelogram
///   flip_normals  boolean    false   faces −z
///
/// u runs along x, v against y (core/scene/mesh.h tells why). As a light it is sampled by solid
/// angle (Ureña, Fajardo and King 2013); where it is no longer a rectangle, or is far or very near,
/// by area.
#include "core/interfaces/shape.h"
#include "core/math/rounding.h"
#include "core/math/solid_angle.h"

namespace lucerna {
namespace {

class RectangleShape final : public Shape {
public:
    explicit RectangleShape(const Params& params) : Shape(params) {
        const Vector3d edge_u = world_from_object().direction(Vector3d(2, 0, 0));
        const Vector3d edge_v = world_from_object().direction(Vector3d(0, -2, 0));
        corner_ = Vector3(world_from_object().point(Vector3d(-1, 1, 0)));
        edge_u_ = Vector3(edge_u);
        edge_v_ = Vector3(edge_v);
        center_ = corner_ + 0.5f * (edge_u_ + edge_v_);
        diagonal_ = std::max(glm::length(edge_u_ + edge_v_), glm::length(edge_u_ - edge_v_));
        n_ = Vector3(glm::normalize(world_from_object().normal(Vector3d(0, 0, 1))));
        if (flip_normals()) n_ = -n_;
        area_ = static_cast<float>(glm::length(glm::cross(edge_u, edge_v)));
        error_ =
            gamma(7) * max_component(glm::abs(corner_) + glm::abs(edge_u_) + glm::abs(edge_v_));
        // Matrices are written with six digits; a shear below that biases nothing visible.
        perpendicular_ = std::abs(glm::dot(glm::normalize(edge_u), glm::normalize(edge_v))) < 1e-5;
    }

    Geometry geometry() const override { return ParallelogramGeometry{corner_, edge_u_, edge_v_}; }

    Bounds3 bounds() const override {
        Bounds3 bounds;
        bounds.include(corner_);
        bounds.include(corner_ + edge_u_);
        bounds.include(corner_ + edge_v_);
        bounds.include(corner_ + edge_u_ + edge_v_);
        return bounds;
    }

    void fill(const Ray&, const Hit& hit, Interaction& at) const override {
        at.p = corner_ + hit.uv.x * edge_u_ + hit.uv.y * edge_v_;
        at.error = error_;
        at.n = n_;
        at.uv = hit.uv;
        at.dpdu = edge_u_;
        at.dpdv = edge_v_;
        at.shading = Frame::from_normal_tangent(n_, edge_u_);
    }

    float area(std::uint32_t) const override { return area_; }

    SurfaceSample sample_area(std::uint32_t, Vector2 u) const override {
        return {.p = corner_ + u.x * edge_u_ + u.y * edge_v_,
                .n = n_,
                .uv = u,
                .error = error_,
                .pdf = 1 / area_};
    }

    std::optional<SurfaceSample> sample_solid_angle(std::uint32_t primitive, const Receiver& from,
                                                    Vector2 u) const override {
        const std::optional<SphericalRectangle> seen = seen_from(from.p);
        if (!seen) return Shape::sample_solid_angle(primitive, from, u);
        SurfaceSample sample = sample_area(primitive, seen->sample(Vector2d(u)));
        sample.pdf = seen->pdf();
        return sample;
    }

    float pdf_solid_angle(std::uint32_t primitive, const Receiver& from, Vector3 wi,
                          const Interaction& hit) const override {
        const std::optional<SphericalRectangle> seen = seen_from(from.p);
        return seen ? seen->pdf() : Shape::pdf_solid_angle(primitive, from, wi, hit);
    }

    std::pair<Vector3, float> normal_cone(std::uint32_t) const override { return {n_, 1.0f}; }

private:
    /// Empty if the rectangle must be sampled by area from there.
    std::optional<SphericalRectangle> seen_from(Vector3 p) const {
        const Vector3 d = center_ - p;
        if (!perpendicular_ || sample_by_area(diagonal_, glm::dot(d, d))) return {};
        const SphericalRectangle seen(p, corner_, edge_u_, edge_v_);
        if (!sample_by_solid_angle(seen.solid_angle())) return {};
        return seen;
    }

    Vector3 corner_, edge_u_, edge_v_, center_, n_;
    float area_, diagonal_, error_;
    bool perpendicular_;
};

}  // namespace

const PluginInfo plugin = describe<RectangleShape>("a rectangle or parallelogram");

}  // namespace lucerna
