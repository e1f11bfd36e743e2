// SPDX-License-Identifier: Apache-2.0
/// disk: the unit disk in the plane z = 0, facing +z.
///
///   to_world      transform          any affine transform: the disk may become an ellipse
///   flip_normals  boolean    false   faces −z
///
/// u is the distance from the center, 1 − v the angle (mesh.h tells why). As a light it
/// is sampled by area.
#include "core/base/vectorized.h"
#include "core/math/warp.h"
#include "plugins/shapes/analytic.h"

namespace lucerna {
namespace {

/// What sampled points of a disk are made of.
struct Plate {
    Vector3d center{0}, axis_x{0}, axis_y{0};
    Vector3 n{0};          ///< with its flip
    double magnitude = 1;  ///< of coordinates

    /// From coordinates in the unit disk, without density.
    SurfaceSample point(Vector2 xy) const {
        const Vector2d at(xy);
        const Vector3 p(center + at.x * axis_x + at.y * axis_y);
        return {.p = p, .n = n, .hit_uv = xy, .error = rounding_error(p, magnitude)};
    }
};

/// Points that are uniform by area.
LUCERNA_VECTORIZED void sample_plate(const Plate& __restrict plate, float pdf,
                                     const Vector2Lanes& __restrict u,
                                     SurfaceSampleLanes& __restrict out) {
    for (std::size_t i = 0; i < lane_count; ++i) {
        const SurfaceSample at = plate.point(square_to_uniform_disk(u[i]));
        out.p.set(i, at.p);
        out.n.set(i, at.n);
        out.hit_uv.set(i, at.hit_uv);
        out.error[i] = at.error;
        out.pdf[i] = pdf;
    }
}

class DiskShape final : public Shape {
public:
    explicit DiskShape(const Params& params)
        : Shape(params), n_(glm::normalize(world_from_object().normal(Vector3d(0, 0, 1)))) {
        const Vector3d center = world_from_object().point(Vector3d(0));
        const Vector3d axis_x = world_from_object().direction(Vector3d(1, 0, 0));
        const Vector3d axis_y = world_from_object().direction(Vector3d(0, 1, 0));
        const Vector3d across_x = glm::cross(axis_y, n_), across_y = glm::cross(n_, axis_x);
        dual_x_ = across_x / glm::dot(axis_x, across_x);
        dual_y_ = across_y / glm::dot(axis_y, across_y);
        plate_ = {.center = center,
                  .axis_x = axis_x,
                  .axis_y = axis_y,
                  .n = Vector3(flip_normals() ? -n_ : n_),
                  .magnitude = glm::length(center) + glm::length(axis_x) + glm::length(axis_y)};
    }

    Geometry geometry() const override { return AnalyticGeometry{bounds()}; }

    Bounds3 bounds() const override {
        Vector3d reach;
        for (int i = 0; i < 3; ++i) reach[i] = std::hypot(plate_.axis_x[i], plate_.axis_y[i]);
        return bounds_around(plate_.center - reach, plate_.center + reach);
    }

    /// The hit's uv are the coordinates in the unit disk.
    std::optional<Hit> intersect(const Ray& ray) const override {
        const Vector3d to_center = plate_.center - Vector3d(ray.o), d(ray.d);
        const double t = glm::dot(to_center, n_) / glm::dot(d, n_);
        const auto rounded = static_cast<float>(t);
        if (!(t >= 0 && rounded <= ray.tmax)) return {};
        const Vector3d p = t * d - to_center;
        const Vector2d xy(glm::dot(p, dual_x_), glm::dot(p, dual_y_));
        if (!(glm::dot(xy, xy) <= 1)) return {};
        return Hit{.t = rounded, .uv = Vector2(xy)};
    }

    void fill(const Ray&, const Hit& hit, Interaction& at) const override {
        const SurfaceSample point = plate_.point(hit.uv);
        at.p = point.p;
        at.error = point.error;
        at.n = point.n;
        at.uv = uv_at(hit.uv);
        const double r = std::hypot(hit.uv.x, hit.uv.y);
        const Vector2d around = r > 0 ? Vector2d(hit.uv) / r : Vector2d(1, 0);
        at.dpdu = Vector3(around.x * plate_.axis_x + around.y * plate_.axis_y);
        at.dpdv = Vector3(2 * std::numbers::pi * r *
                          (around.y * plate_.axis_x - around.x * plate_.axis_y));
        at.shading = Frame::from_normal_tangent(at.n, at.dpdu);
    }

    float area(std::uint32_t) const override {
        return static_cast<float>(std::numbers::pi *
                                  glm::length(glm::cross(plate_.axis_x, plate_.axis_y)));
    }

    SurfaceSample sample_area(std::uint32_t, Vector2 u) const override {
        SurfaceSample sample = plate_.point(square_to_uniform_disk(u));
        sample.pdf = 1 / area(0);
        return sample;
    }

    void sample_area_lanes(std::uint32_t, const Vector2Lanes& u, std::size_t,
                           SurfaceSampleLanes& out) const {
        sample_plate(plate_, 1 / area(0), u, out);
    }

    Vector2 uv_of(std::uint32_t, const SurfaceSample& sample) const override {
        return uv_at(sample.hit_uv);
    }

    std::pair<Vector3, float> normal_cone(std::uint32_t) const override { return {plate_.n, 1.0f}; }

private:
    static Vector2 uv_at(Vector2 xy) { return {glm::length(xy), turn_of({xy.x, -xy.y})}; }

    Vector3d n_;  ///< unflipped
    Plate plate_;
    Vector3d dual_x_, dual_y_;  ///< in the plane; dual_x · axis_x = 1, dual_x · axis_y = 0
};

}  // namespace

const PluginInfo plugin = describe<DiskShape>("a disk");

}  // namespace lucerna
