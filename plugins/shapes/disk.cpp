// SPDX-License-Identifier: Apache-2.0
/// disk: the unit disk in the plane z = 0, facing +z.
///
///   to_world      transform          any affine transform: the disk may become an ellipse
///   flip_normals  boolean    false   faces −z
///
/// u is the distance from the center, 1 − v the angle (core/scene/mesh.h tells why). As a light it
/// is sampled by area.
#include "core/math/warp.h"
#include "plugins/shapes/analytic.h"

namespace lucerna {
namespace {

class DiskShape final : public Shape {
public:
    explicit DiskShape(const Params& params)
        : Shape(params),
          center_(world_from_object().point(Vector3d(0))),
          axis_x_(world_from_object().direction(Vector3d(1, 0, 0))),
          axis_y_(world_from_object().direction(Vector3d(0, 1, 0))),
          n_(glm::normalize(world_from_object().normal(Vector3d(0, 0, 1)))) {
        const Vector3d across_x = glm::cross(axis_y_, n_), across_y = glm::cross(n_, axis_x_);
        dual_x_ = across_x / glm::dot(axis_x_, across_x);
        dual_y_ = across_y / glm::dot(axis_y_, across_y);
    }

    Geometry geometry() const override { return AnalyticGeometry{bounds()}; }

    Bounds3 bounds() const override {
        Vector3d reach;
        for (int i = 0; i < 3; ++i) reach[i] = std::hypot(axis_x_[i], axis_y_[i]);
        return bounds_around(center_ - reach, center_ + reach);
    }

    /// The hit's uv are the coordinates in the unit disk.
    std::optional<Hit> intersect(const Ray& ray) const override {
        const Vector3d to_center = center_ - Vector3d(ray.o), d(ray.d);
        const double t = glm::dot(to_center, n_) / glm::dot(d, n_);
        const auto rounded = static_cast<float>(t);
        if (!(t >= 0 && rounded <= ray.tmax)) return {};
        const Vector3d p = t * d - to_center;
        const Vector2d xy(glm::dot(p, dual_x_), glm::dot(p, dual_y_));
        if (!(glm::dot(xy, xy) <= 1)) return {};
        return Hit{.t = rounded, .uv = Vector2(xy)};
    }

    void fill(const Ray&, const Hit& hit, Interaction& at) const override {
        const SurfaceSample point = point_at(hit.uv);
        at.p = point.p;
        at.error = point.error;
        at.n = point.n;
        at.uv = point.uv;
        if (!needs_tangents()) {
            at.shading = Frame::from_normal(at.n);
            return;
        }
        const double r = std::hypot(hit.uv.x, hit.uv.y);
        const Vector2d around = r > 0 ? Vector2d(hit.uv) / r : Vector2d(1, 0);
        at.dpdu = Vector3(around.x * axis_x_ + around.y * axis_y_);
        at.dpdv = Vector3(2 * std::numbers::pi * r * (around.y * axis_x_ - around.x * axis_y_));
        at.shading = Frame::from_normal_tangent(at.n, at.dpdu);
    }

    float area(std::uint32_t) const override {
        return static_cast<float>(std::numbers::pi * glm::length(glm::cross(axis_x_, axis_y_)));
    }

    SurfaceSample sample_area(std::uint32_t, Vector2 u) const override {
        SurfaceSample sample = point_at(square_to_uniform_disk(u));
        sample.pdf = 1 / area(0);
        return sample;
    }

    std::pair<Vector3, float> normal_cone(std::uint32_t) const override {
        return {Vector3(flip_normals() ? -n_ : n_), 1.0f};
    }

private:
    SurfaceSample point_at(Vector2 xy) const {
        const Vector2d at(xy);
        const Vector3 p(center_ + at.x * axis_x_ + at.y * axis_y_);
        const double magnitude = glm::length(center_) + glm::length(axis_x_) + glm::length(axis_y_);
        return {.p = p,
                .n = Vector3(flip_normals() ? -n_ : n_),
                .uv = {glm::length(xy), turn_of({xy.x, -xy.y})},
                .error = rounding_error(p, magnitude),
                .pdf = 0};
    }

    Vector3d center_, axis_x_, axis_y_, n_;
    Vector3d dual_x_, dual_y_;  ///< in the plane; dual_x · axis_x = 1, dual_x · axis_y = 0
};

}  // namespace

const PluginInfo plugin = describe<DiskShape>("a disk");

}  // namespace lucerna
