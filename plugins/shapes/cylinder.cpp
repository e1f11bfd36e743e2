// SPDX-License-Identifier: Apache-2.0
/// cylinder: a tube from p0 to p1, without end caps.
///
///   p0, p1        point      0 0 0, 0 0 1   ends of the axis, before to_world
///   radius        float      1              > 0, before to_world
///   to_world      transform                 rotation, translation and scale, the same in all
///                                           directions across the axis
///   flip_normals  boolean    false          the normals point to the axis
///
/// u is the angle around the axis, v runs from p1 to p0 (mesh.h tells why). Rays are met
/// in double. As a light it is sampled by area.
#include "plugins/shapes/analytic.h"

namespace lucerna {
namespace {

class CylinderShape final : public Shape {
public:
    explicit CylinderShape(const Params& params) : Shape(params) {
        const Vector3d p0 = params.point("p0", {0, 0, 0}, "start of the axis, before to_world");
        const Vector3d p1 = params.point("p1", {0, 0, 1}, "end of the axis, before to_world");
        const double radius = params.real("radius", 1, positive, "radius, before to_world");
        const Vector3d axis = p1 - p0;
        if (axis == Vector3d(0)) {
            params.error("p1", "\"p0\" and \"p1\" are the same point: the cylinder has no length");
            return;
        }
        const Frame frame = Frame::from_normal(Vector3(glm::normalize(axis)));
        const Vector3d z = glm::normalize(axis),
                       y = glm::normalize(glm::cross(z, Vector3d(frame.s)));
        const Matrix3d object_from_local(glm::cross(y, z), y, z);
        // Along the axis, any scale is another length; across it, the circle must stay round.
        Matrix3d m = Matrix3d(world_from_object().matrix()) * object_from_local;
        const double stretch = glm::length(m[2]),
                     across = std::sqrt(glm::length(m[0]) * glm::length(m[1]));
        m[2] *= across / stretch;
        const double scale = uniform_scale(params, world_from_object(), m,
                                           "scale all directions across its axis alike");
        base_ = world_from_object().point(p0);
        length_ = stretch * glm::length(axis);
        radius_ = scale * radius;
        world_from_local_ = m / scale;
    }

    Geometry geometry() const override { return AnalyticGeometry{bounds()}; }

    Bounds3 bounds() const override {
        const Vector3d end = base_ + length_ * world_from_local_[2];
        Vector3d r;
        for (int i = 0; i < 3; ++i) {
            r[i] = radius_ * std::hypot(world_from_local_[0][i], world_from_local_[1][i]);
        }
        return bounds_around(glm::min(base_, end) - r, glm::max(base_, end) + r);
    }

    std::optional<Hit> intersect(const Ray& ray) const override {
        const Line line = to_local(ray);
        const std::optional<Roots> roots = meet_round(Vector2d(line.o), Vector2d(line.d), radius_);
        if (!roots) return {};
        for (const double root : {roots->near, roots->far}) {
            const double z = line.o.z + root * line.d.z;
            const auto t = static_cast<float>(root);
            if (root >= 0 && t <= ray.tmax && z >= 0 && z <= length_) return Hit{.t = t};
        }
        return {};
    }

    void fill(const Ray& ray, const Hit& hit, Interaction& at) const override {
        const Line line = to_local(ray);
        const std::optional<Roots> roots = meet_round(Vector2d(line.o), Vector2d(line.d), radius_);
        const Vector3d local = line.o + (roots ? roots->nearest(hit.t) : hit.t) * line.d;
        const Vector2d n = glm::normalize(Vector2d(local));
        const SurfaceSample point = point_at(n, local.z);
        at.p = point.p;
        at.error = point.error;
        at.n = point.n;
        at.uv = uv_at(n, local.z);
        const double circumference = 2 * std::numbers::pi * radius_;
        at.dpdu =
            Vector3(world_from_local_ * Vector3d(-circumference * n.y, circumference * n.x, 0));
        at.dpdv = Vector3(world_from_local_ * Vector3d(0, 0, -length_));
        at.shading = Frame::from_normal_tangent(at.n, at.dpdu);
    }

    float area(std::uint32_t) const override {
        return static_cast<float>(2 * std::numbers::pi * radius_ * length_);
    }

    SurfaceSample sample_area(std::uint32_t, Vector2 u) const override {
        const double phi = 2 * std::numbers::pi * static_cast<double>(u.y);
        SurfaceSample sample =
            point_at({std::cos(phi), std::sin(phi)}, static_cast<double>(u.x) * length_);
        sample.pdf = 1 / area(0);
        return sample;
    }

    Vector2 uv_of(std::uint32_t, const SurfaceSample& sample) const override {
        const Vector3d local = (Vector3d(sample.p) - base_) * world_from_local_;
        return uv_at(Vector2d(local), local.z);
    }

    /// All normals are perpendicular to the axis.
    std::pair<Vector3, float> normal_cone(std::uint32_t) const override {
        return {Vector3(world_from_local_[2]), 0.0f};
    }

private:
    struct Line {
        Vector3d o, d;
    };

    Line to_local(const Ray& ray) const {
        return {(Vector3d(ray.o) - base_) * world_from_local_, Vector3d(ray.d) * world_from_local_};
    }

    Vector2 uv_at(Vector2d n, double z) const {
        return {turn_of(Vector2(n)), static_cast<float>(1 - z / length_)};
    }

    /// The point at height z whose outward normal is (n, 0), without a density.
    SurfaceSample point_at(Vector2d n, double z) const {
        const Vector3 p(base_ + world_from_local_ * Vector3d(radius_ * n, z));
        const Vector3d normal = world_from_local_ * Vector3d(n, 0);
        const double magnitude = glm::length(base_) + length_ + radius_;
        return {.p = p,
                .n = Vector3(flip_normals() ? -normal : normal),
                .error = rounding_error(p, magnitude),
                .pdf = 0};
    }

    Vector3d base_{0};
    double length_ = 1, radius_ = 1;
    Matrix3d world_from_local_{1};  ///< orthonormal; z is the axis
};

}  // namespace

const PluginInfo plugin = describe<CylinderShape>("a cylinder without end caps");

}  // namespace lucerna
