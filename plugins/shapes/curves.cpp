// SPDX-License-Identifier: Apache-2.0
#include "plugins/shapes/curves.h"

#include "core/base/file_bytes.h"
#include "plugins/shapes/text_cursor.h"

namespace lucerna {

namespace {

constexpr double tau = 2 * std::numbers::pi;

/// Control points of one curve after another: in the file's own space.
std::vector<std::vector<glm::dvec4>> read_curves(std::span<const std::uint8_t> file,
                                                 const std::string& name, std::size_t fewest) {
    std::vector<std::vector<glm::dvec4>> curves;
    TextCursor at(file, name);
    bool open = false;
    const auto close = [&] {
        if (open && curves.back().size() < fewest) {
            at.fail(fmt::format("a curve ends after {} control points; it needs {} or more",
                                curves.back().size(), fewest));
        }
        open = false;
    };
    for (; !at.at_end(); at.next_line()) {
        at.skip_blanks();
        if (at.at_line_end()) {
            close();
            continue;
        }
        if (!open) curves.emplace_back();
        open = true;
        glm::dvec4 p;
        p.x = at.number("x of a control point");
        p.y = at.number("y of a control point");
        p.z = at.number("z of a control point");
        p.w = at.number("the radius of a control point");
        if (p.w < 0) at.fail("a radius must not be negative");
        at.skip_blanks();
        if (!at.at_line_end()) at.fail("a control point is four numbers: x y z radius");
        curves.back().push_back(p);
    }
    close();
    return curves;
}

}  // namespace

CurveShape::CurveShape(const Params& params, CurveGeometry::Basis basis)
    : Shape(params), basis_(basis) {
    params.no_effect("silhouette_sampling_weight", "rendering is not differentiated");
    const std::filesystem::path path =
        params.file("filename", "text: a control point on each line, as x y z radius");
    if (emitter()) params.error("emitter", "curves cannot emit light; use a mesh or a cylinder");
    if (!path.empty()) take_file(path);
}

void CurveShape::take_file(const std::filesystem::path& path) {
    const bool linear = basis_ == CurveGeometry::Basis::linear;
    const std::size_t fewest = linear ? 2 : 4;
    const std::string name = path.filename().string();
    for (const auto& curve : read_curves(read_file_bytes(path), name, fewest)) {
        const std::size_t begin = points_.size(), segments = curve.size() - fewest + 1;
        for (const glm::dvec4& p : curve) {
            const Vector3 q(world_from_object().point(Vector3d(p)));
            const auto radius = static_cast<float>(p.w);
            if (!(max_component(absolute(q)) < 1e18f && radius < 1e18f)) {
                throw Error(fmt::format("{}: control points must lie below 1e18", name));
            }
            points_.emplace_back(q, radius);
            bounds_.include(q - Vector3(radius));
            bounds_.include(q + Vector3(radius));
        }
        for (std::size_t i = 0; i < segments; ++i) {
            first_.push_back(static_cast<std::uint32_t>(begin + i));
            neighbours_.push_back(
                static_cast<std::uint8_t>((i > 0 ? 1 : 0) + (i + 1 < segments ? 2 : 0)));
        }
    }
    if (points_.size() >= PrimitiveId::none) {
        throw Error(fmt::format("{}: {} control points are too many", name, points_.size()));
    }
    if (first_.empty()) throw Error(fmt::format("{}: there are no curves in it", name));
}

Geometry CurveShape::geometry() const {
    return CurveGeometry{
        .basis = basis_, .points = points_, .first = first_, .neighbours = neighbours_};
}

/// The axis at a hit: with derivatives by the parameter u of its segment.
struct CurveShape::Place {
    Vector3d center, d1{0}, d2{0};
    double radius, radius_d1 = 0;
};

CurveShape::Place CurveShape::place(const Hit& hit) const {
    const glm::vec4* const p = &points_[first_[hit.primitive]];
    const auto u = static_cast<double>(hit.uv.x);
    const auto sum = [&](std::initializer_list<double> weights) {
        glm::dvec4 result(0);
        const glm::vec4* point = p;
        for (const double w : weights) result += w * glm::dvec4(*point++);
        return result;
    };
    glm::dvec4 c, d1, d2(0);
    if (basis_ == CurveGeometry::Basis::linear) {
        c = sum({1 - u, u});
        d1 = sum({-1, 1});
    } else {
        const double s = 1 - u;
        c = sum({s * s * s / 6, (4 - 6 * u * u + 3 * u * u * u) / 6,
                 (4 - 6 * s * s + 3 * s * s * s) / 6, u * u * u / 6});
        d1 = sum({-s * s / 2, u * (1.5 * u - 2), s * (2 - 1.5 * s), u * u / 2});
        d2 = sum({s, 3 * u - 2, 3 * s - 2, u});
    }
    return {Vector3d(c), Vector3d(d1), Vector3d(d2), c.w, d1.w};
}

/// A point of the surface is c + r e, with e perpendicular to the axis. Along the axis it moves by
/// c' (1 − κ) + r' e, κ = r e · c'' / |c'|². Joints and ends of linear curves are spheres, whose
/// points lie beside the plane of c.
void CurveShape::fill(const Ray& ray, const Hit& hit, Interaction& at) const {
    const Place c = place(hit);
    const Vector3d met = Vector3d(ray.o) + static_cast<double>(hit.t) * Vector3d(ray.d);
    const double length = glm::length(c.d1);
    const Vector3d tangent = length > 0 ? c.d1 / length : Vector3d(0, 0, 1);
    Vector3d out = met - c.center;
    const bool linear = basis_ == CurveGeometry::Basis::linear;
    if (!linear) out -= tangent * glm::dot(out, tangent);
    const double distance = glm::length(out);
    const Vector3d n0 =
        distance > 0 ? out / distance : Vector3d(Frame::from_normal(Vector3(tangent)).s);
    const Vector3d p = c.center + c.radius * n0;
    const Vector3d across = n0 - tangent * glm::dot(n0, tangent);
    const double across_length = glm::length(across);
    const Vector3d e = across_length > 1e-6 ? across / across_length
                                            : Vector3d(Frame::from_normal(Vector3(tangent)).s);
    const double along =
        length * (1 - c.radius * glm::dot(e, c.d2) / std::max(sqr(length), 1e-300));
    Vector3d n = n0;
    if (!linear && along > 0) n = glm::normalize(e - tangent * (c.radius_d1 / along));

    const float side = flip_normals() ? -1.0f : 1.0f;
    at.p = Vector3(p);
    // Embree finds the surface by iteration, to some roundings of its own coordinates.
    at.error = gamma(32) * max_component(absolute(at.p)) + 1e-3f * static_cast<float>(c.radius);
    at.n = side * Vector3(n);

    // The angle is measured from an axis across z, so that it is continuous along the curve.
    Vector3d up = Vector3d(0, 0, 1) - tangent * tangent.z;
    up = glm::length(up) > 1e-6 ? glm::normalize(up) : Vector3d(0, 1, 0);
    const Vector3d beside = glm::cross(up, tangent);
    const double angle = std::atan2(glm::dot(e, up), glm::dot(e, beside));
    const auto segments = static_cast<double>(first_.size());
    const double v = 1 - (hit.primitive + static_cast<double>(hit.uv.x)) / segments;
    at.uv = Vector2(Vector2d(angle < 0 ? angle / tau + 1 : angle / tau, v));
    at.dpdu = Vector3(tau * c.radius * glm::cross(tangent, e));
    at.dpdv = Vector3(-segments * (tangent * along + e * c.radius_d1));
    at.shading = Frame::from_normal_tangent(at.n, Vector3(glm::cross(tangent, e)));
}

}  // namespace lucerna
