// SPDX-License-Identifier: Apache-2.0
/// sphere: all points at the distance `radius` from `center`.
///
///   center        point      0 0 0   before to_world
///   radius        float      1       > 0, before to_world
///   to_world      transform          rotation, translation and uniform scale
///   flip_normals  boolean    false   the normals point to the center
///
/// u is the angle around z, v grows from −z to z. Rays are met in double: far and huge spheres stay
/// round. As a light it is sampled by the cone of directions to it (pbrt 4e, 6.2.4), from inside by
/// area. A mirrored sphere keeps its outside; Mitsuba turns it inside out.
#include "core/base/vectorized.h"
#include "core/math/solid_angle.h"
#include "core/math/warp.h"
#include "plugins/shapes/analytic.h"

namespace lucerna {
namespace {

/// What sampled points of a sphere are made of.
struct Ball {
    Vector3d center{0};
    double radius = 1;
    double magnitude = 1;  ///< of coordinates
    float side = 1;        ///< −1: normals point to the center

    /// The point with the outward normal `n`, a unit vector up to floats' rounding, without
    /// density.
    SurfaceSample point(Vector3d n) const {
        n *= 1.5 - 0.5 * glm::dot(n, n);  // one step of Newton's to 1 / |n|: from 1e-6 to 1e-12
        const Vector3 p(center + radius * n);
        return {.p = p, .n = side * Vector3(n), .error = rounding_error(p, magnitude)};
    }
};

/// Points that are uniform by area.
LUCERNA_VECTORIZED void sample_ball(const Ball& __restrict ball, float pdf,
                                    const Vector2Lanes& __restrict u,
                                    SurfaceSampleLanes& __restrict out) {
    for (std::size_t i = 0; i < lane_count; ++i) {
        const SurfaceSample at = ball.point(Vector3d(square_to_uniform_sphere(u[i])));
        out.p.set(i, at.p);
        out.n.set(i, at.n);
        out.hit_uv.set(i, at.hit_uv);
        out.error[i] = at.error;
        out.pdf[i] = pdf;
    }
}

class SphereShape final : public Shape {
public:
    explicit SphereShape(const Params& params) : Shape(params) {
        const Vector3d center = params.point("center", Vector3d(0), "center, before to_world");
        const double radius = params.real("radius", 1, positive, "radius, before to_world");
        const double scale =
            uniform_scale(params, world_from_object(), Matrix3d(world_from_object().matrix()),
                          "scale all axes alike");
        center_ = Vector3(world_from_object().point(center));
        radius_ = static_cast<float>(scale * radius);
        world_from_local_ = Matrix3d(world_from_object().matrix()) / scale;
        ball_ = {.center = Vector3d(center_),
                 .radius = static_cast<double>(radius_),
                 .magnitude = static_cast<double>(max_component(absolute(center_)) + radius_),
                 .side = flip_normals() ? -1.0f : 1.0f};
    }

    Geometry geometry() const override { return AnalyticGeometry{bounds()}; }

    Bounds3 bounds() const override {
        return bounds_around(ball_.center - ball_.radius, ball_.center + ball_.radius);
    }

    std::optional<Hit> intersect(const Ray& ray) const override {
        const std::optional<Roots> roots = meet(ray);
        if (!roots) return {};
        const auto t = static_cast<float>(roots->near >= 0 ? roots->near : roots->far);
        if (!(t >= 0 && t <= ray.tmax)) return {};
        return Hit{.t = t};
    }

    void fill(const Ray& ray, const Hit& hit, Interaction& at) const override {
        const std::optional<Roots> roots = meet(ray);
        const double t = roots ? roots->nearest(hit.t) : hit.t;
        const Vector3d n = glm::normalize(Vector3d(ray.o) + t * Vector3d(ray.d) - ball_.center);
        const SurfaceSample point = ball_.point(n);
        at.p = point.p;
        at.error = point.error;
        at.n = point.n;
        at.uv = uv_at(n);
        const Vector3d local = n * world_from_local_;
        const double rho = std::hypot(local.x, local.y), r = ball_.radius * std::numbers::pi;
        const Vector2d around = rho > 0 ? Vector2d(local) / rho : Vector2d(1, 0);
        at.dpdu = Vector3(world_from_local_ * Vector3d(-2 * r * local.y, 2 * r * local.x, 0));
        at.dpdv = Vector3(world_from_local_ * Vector3d(-r * local.z * around, r * rho));
        at.shading = Frame::from_normal_tangent(at.n, at.dpdu);
    }

    float area(std::uint32_t) const override { return 4 * pi * radius_ * radius_; }

    SurfaceSample sample_area(std::uint32_t, Vector2 u) const override {
        SurfaceSample sample = ball_.point(Vector3d(square_to_uniform_sphere(u)));
        sample.pdf = 1 / area(0);
        return sample;
    }

    void sample_area_lanes(std::uint32_t, const Vector2Lanes& u, std::size_t,
                           SurfaceSampleLanes& out) const {
        sample_ball(ball_, 1 / area(0), u, out);
    }

    std::optional<SurfaceSample> sample_solid_angle(std::uint32_t primitive, const Receiver& from,
                                                    Vector2 u) const override {
        const std::optional<SphereCone> cone = seen_from(from);
        if (!cone) return Shape::sample_solid_angle(primitive, from, u);
        // Rounded, as all normals are.
        SurfaceSample sample = ball_.point(Vector3d(Vector3(cone->sample(Vector2d(u)).normal)));
        sample.pdf = cone->pdf();
        if (!std::isfinite(sample.pdf)) return {};
        return sample;
    }

    Vector2 uv_of(std::uint32_t, const SurfaceSample& sample) const override {
        return uv_at(Vector3d(ball_.side * sample.n));
    }

    float pdf_solid_angle(std::uint32_t primitive, const Receiver& from, Vector3 wi,
                          const Interaction& hit) const override {
        const std::optional<SphereCone> cone = seen_from(from);
        if (!cone) return Shape::pdf_solid_angle(primitive, from, wi, hit);
        return std::isfinite(cone->pdf()) ? cone->pdf() : 0.0f;
    }

private:
    /// Empty if the sphere must be sampled by area: from inside, and from so near its surface that
    /// the side of a rounded point says nothing. Else half of the points on the inside of a sphere
    /// would look for light on the outside.
    std::optional<SphereCone> seen_from(const Receiver& from) const {
        const double distance = glm::length(Vector3d(from.p) - ball_.center);
        if (distance <= ball_.radius + 4 * static_cast<double>(from.error)) {
            return {};
        }
        return SphereCone::from(from.p, center_, radius_);
    }

    std::optional<Roots> meet(const Ray& ray) const {
        return meet_round(Vector3d(ray.o) - ball_.center, Vector3d(ray.d), ball_.radius);
    }

    Vector2 uv_at(Vector3d n) const {
        const Vector3 local(n * world_from_local_);
        const float rho = std::sqrt(sqr(local.x) + sqr(local.y));
        const FourFloats angles =
            angles_of(FourFloats{local.x, -local.z}, FourFloats{local.y, rho});
        return {turn_of(angles[0]), angles[1] * inv_pi};
    }

    Vector3 center_;
    float radius_;
    Ball ball_;                  ///< the same in double
    Matrix3d world_from_local_;  ///< a rotation, perhaps with a mirror: local is the unit sphere
};

}  // namespace

const PluginInfo plugin = describe<SphereShape>("a sphere");

}  // namespace lucerna
