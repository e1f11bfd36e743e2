// SPDX-License-Identifier: Apache-2.0
#include "plugins/shapes/mesh.h"

#include "core/math/polygon.h"
#include "core/math/rounding.h"
#include "core/math/solid_angle.h"
#include "core/math/warp.h"

#include <fmt/format.h>

namespace lucerna {
namespace {

/// Embree and load_four read 16 bytes for each vector of 12: the last one needs room behind it.
constexpr std::size_t padding = 1;

/// Embree drops primitives that reach further without a word.
constexpr float coordinate_limit = 1e18f;

Vector3d scaled_normal(Vector3 v0, Vector3 v1, Vector3 v2) {
    return glm::cross(Vector3d(v1) - Vector3d(v0), Vector3d(v2) - Vector3d(v0));
}

void require_vertices(const MeshData& data) {
    for (std::size_t i = 0; i < data.positions.size(); ++i) {
        const Vector3 p = data.positions[i];
        if (max_component(absolute(p)) < coordinate_limit && is_finite(p)) continue;
        throw Error(
            fmt::format("{}: vertex {} is ({:g}, {:g}, {:g}); coordinates must be finite "
                        "and below {:g}",
                        data.name, i, p.x, p.y, p.z, coordinate_limit));
    }
    for (std::size_t i = 0; i < data.normals.size(); ++i) {
        if (is_finite(data.normals[i])) continue;
        throw Error(fmt::format("{}: the normal of vertex {} is not finite", data.name, i));
    }
    for (std::size_t i = 0; i < data.uvs.size(); ++i) {
        if (std::isfinite(data.uvs[i].x) && std::isfinite(data.uvs[i].y)) continue;
        throw Error(
            fmt::format("{}: the texture coordinates of vertex {} are not finite", data.name, i));
    }
}

void require_attributes(const MeshData& data) {
    for (const MeshAttribute& attribute : data.attributes) {
        for (std::size_t i = 0; i < attribute.values.size(); ++i) {
            if (std::isfinite(attribute.values[i])) continue;
            throw Error(fmt::format("{}: \"{}\" of {} {} is not finite", data.name, attribute.name,
                                    attribute.of_faces ? "triangle" : "vertex",
                                    i / attribute.size));
        }
    }
}

void require_indices(const MeshData& data) {
    for (std::size_t i = 0; i < data.indices.size(); ++i) {
        if (data.indices[i] < data.positions.size()) continue;
        throw Error(
            fmt::format("{}: triangle {} uses vertex {}, but there are only {}, counted "
                        "from 0",
                        data.name, i / 3, data.indices[i], data.positions.size()));
    }
}

/// Makes winding tell the outside: it agrees with vertex normals, or was mirrored.
void orient(MeshData& data) {
    const bool mirrored = data.world_from_file.swaps_handedness();
    if (data.normals.empty() && !mirrored) return;
    for (std::size_t i = 0; i + 2 < data.indices.size(); i += 3) {
        std::uint32_t* corner = &data.indices[i];
        bool inside_out = mirrored;
        if (!data.normals.empty()) {
            const Vector3d n = scaled_normal(data.positions[corner[0]], data.positions[corner[1]],
                                             data.positions[corner[2]]);
            const Vector3d mean(data.normals[corner[0]] + data.normals[corner[1]] +
                                data.normals[corner[2]]);
            const double agreement = glm::dot(n, mean);
            if (agreement != 0) inside_out = agreement < 0;
        }
        if (inside_out) std::swap(corner[1], corner[2]);
    }
}

void warn(const Params& params, const MeshData& data) {
    for (const std::string& warning : data.warnings) params.warning("filename", warning);
    if (data.indices.empty()) {
        params.warning("filename",
                       fmt::format("{}: there are no faces: nothing of it is seen", data.name));
    }
    if (data.crossing_polygons > 0) {
        params.warning("filename",
                       fmt::format("{}: {} of its faces cross themselves, or are bent so much that "
                                   "they seem to: what is inside of them is not defined; cut them "
                                   "into triangles",
                                   data.name, data.crossing_polygons));
    }
}

double angle_between(Vector3d a, Vector3d b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// Normals of vertices: those of the faces around, weighted by their angles there
/// (Thürmer and Wüthrich 1998, "Computing Vertex Normals from Polygonal Facets").
std::vector<Vector3> smooth_normals(const MeshData& data) {
    std::vector<Vector3> normals(data.positions.size(), Vector3(0));
    for (std::size_t i = 0; i + 2 < data.indices.size(); i += 3) {
        const std::uint32_t* corner = &data.indices[i];
        Vector3d v[3];
        for (int k = 0; k < 3; ++k) v[k] = Vector3d(data.positions[corner[k]]);
        const Vector3d n = glm::cross(v[1] - v[0], v[2] - v[0]);
        const double length = glm::length(n);
        if (!(length > 0)) continue;
        for (int k = 0; k < 3; ++k) {
            const double angle = angle_between(v[(k + 1) % 3] - v[k], v[(k + 2) % 3] - v[k]);
            normals[corner[k]] += Vector3(n * (angle / length));
        }
    }
    for (Vector3& n : normals) {
        const float length = glm::length(n);
        n = length > 0 ? n / length : Vector3(0);
    }
    return normals;
}

}  // namespace

void MeshData::reserve(std::size_t vertices, std::size_t triangles) {
    positions.reserve(vertices);
    indices.reserve(3 * triangles);
}

void MeshData::add_normal(Vector3d n) {
    const Vector3d moved = world_from_file.normal(n);
    const double length = glm::length(moved);
    normals.emplace_back(length == 0 ? moved : moved / length);
}

bool MeshData::add_polygon(std::span<const std::uint32_t> corners) {
    if (corners.size() == 3) {
        indices.insert(indices.end(), corners.begin(), corners.end());
        return true;
    }
    const PolygonCut cut = cut_polygon(positions, corners, indices);
    if (cut == PolygonCut::crossing) ++crossing_polygons;
    return cut != PolygonCut::too_large;
}

void MeshData::flip_v() {
    for (Vector2& uv : uvs) uv.y = 1 - uv.y;
}

MeshVertices::MeshVertices(const MeshData& data) : count_(data.positions.size()) {
    if (!data.normals.empty()) {
        normal_ = stride_;
        stride_ += 3;
    }
    if (!data.uvs.empty()) {
        uv_ = stride_;
        stride_ += 2;
    }
    lines_.resize((count_ * stride_ + padding + 15) / 16);
    float* v = lines_.data()->floats;
    for (std::size_t i = 0; i < count_; ++i, v += stride_) {
        const auto put = [](float* to, const auto& from, int count) {
            for (int k = 0; k < count; ++k) to[k] = from[k];
        };
        put(v, data.positions[i], 3);
        if (has_normals()) put(v + normal_, data.normals[i], 3);
        if (has_uvs()) put(v + uv_, data.uvs[i], 2);
    }
}

/// The corners of one triangle, and where they are stored.
struct Mesh::Triangle {
    const float *a0, *a1, *a2;
    FourFloats v0 = load_four(a0), v1 = load_four(a1), v2 = load_four(a2);

    Vector3 corner(int i) const { return to_vector3(i == 0 ? v0 : i == 1 ? v1 : v2); }
    /// Zero for a degenerate triangle.
    Vector3d scaled_normal() const {
        return lucerna::scaled_normal(corner(0), corner(1), corner(2));
    }
    Vector3 normal() const {
        // In float unless the triangle is so thin that the cross product cancels.
        const FourFloats e1 = v1 - v0, e2 = v2 - v0, c = cross(e1, e2);
        const float length2 = dot(c, c), scale2 = dot(e1, e1) * dot(e2, e2);
        constexpr float smallest = 1e-30f, largest = 1e30f;  // no square over- or underflows
        if (length2 > 0.01f * scale2 && length2 > smallest && scale2 < largest) {
            return to_vector3(c * (1 / std::sqrt(length2)));
        }
        const Vector3d n = scaled_normal();
        const double length = glm::length(n);
        return length > 0 ? Vector3(n / length) : Vector3(0, 0, 1);
    }
    /// Empty if the triangle is to be sampled by area from there.
    std::optional<double> solid_angle_from(Vector3 p) const {
        const FourFloats e1 = v1 - v0, e2 = v2 - v1, e3 = v0 - v2;
        const float diagonal = std::sqrt(std::max({dot(e1, e1), dot(e2, e2), dot(e3, e3)}));
        const Vector3 d = to_vector3((1 / 3.0f) * (v0 + v1 + v2)) - p;
        if (sample_by_area(diagonal, glm::dot(d, d))) return {};
        const double solid_angle = triangle_solid_angle(Vector3d(p), Vector3d(corner(0)),
                                                        Vector3d(corner(1)), Vector3d(corner(2)));
        if (!sample_by_solid_angle(solid_angle)) return {};
        return solid_angle;
    }
    Vector3 point(Vector3 b) const { return to_vector3(b.x * v0 + b.y * v1 + b.z * v2); }
    /// Bounds the rounding error of any `point`, for all coordinates alike: a bound for each would
    /// be zero on walls in a coordinate plane, and rays would not get off them.
    float error() const {
        return gamma(7) *
               max_component(to_vector3(max(absolute(v0), max(absolute(v1), absolute(v2)))));
    }
};

Mesh::Mesh(const Params& params)
    : Shape(params),
      face_normals_(params.boolean("face_normals", false,
                                   "ignores vertex normals, which gives a faceted look")) {
    params.no_effect(
        "max_smooth_angle",
        "normals are smoothed over all edges whose faces share vertices; \"face_normals\" "
        "smooths none");
}

void Mesh::assign(const Params& params, MeshData data) {
    if (data.positions.size() >= PrimitiveId::none ||
        data.indices.size() / 3 >= PrimitiveId::none) {
        throw Error(fmt::format("{}: {} vertices and {} triangles are too many; split the mesh",
                                data.name, data.positions.size(), data.indices.size() / 3));
    }
    require_vertices(data);
    require_indices(data);
    require_attributes(data);
    warn(params, data);
    if (face_normals_ || data.face_normals) data.normals.clear();
    orient(data);
    if (data.normals.empty() && !face_normals_ && !data.face_normals) {
        data.normals = smooth_normals(data);
    }
    for (const std::uint32_t i : data.indices) bounds_.include(data.positions[i]);

    vertices_ = MeshVertices(data);
    indices_.reserve(std::max<std::size_t>(data.indices.size(), 3));  // a place to point at
    indices_.assign(data.indices.begin(), data.indices.end());
    attributes_ = std::move(data.attributes);
}

Geometry Mesh::geometry() const {
    return TriangleGeometry{.positions = vertices_.positions(), .indices = indices_};
}

std::uint32_t Mesh::primitive_count() const {
    return static_cast<std::uint32_t>(indices_.size() / 3);
}

Mesh::Triangle Mesh::triangle(std::uint32_t primitive) const {
    const std::uint32_t* corner = &indices_[3 * std::size_t{primitive}];
    return {vertices_.at(corner[0]), vertices_.at(corner[1]), vertices_.at(corner[2])};
}

Vector2 Mesh::interpolated_uv(const Triangle& t, Vector3 b) const {
    if (!vertices_.has_uvs()) return {b.y, b.z};
    return b.x * vertices_.uv(t.a0) + b.y * vertices_.uv(t.a1) + b.z * vertices_.uv(t.a2);
}

/// The interpolated normal; `n` itself where that is none or points to the other side.
inline Vector3 Mesh::shading_normal(const Triangle& t, Vector3 b, Vector3 n) const {
    if (!vertices_.has_normals()) return n;
    const FourFloats sum =
        b.x * vertices_.normal(t.a0) + b.y * vertices_.normal(t.a1) + b.z * vertices_.normal(t.a2);
    const Vector3 ns = to_vector3(sum * (1 / std::sqrt(dot(sum, sum))));
    return glm::dot(ns, n) > 0 ? ns : n;
}

void Mesh::fill_derivatives(const Triangle& t, Interaction& at) const {
    const Vector3 edge1 = to_vector3(t.v1 - t.v0), edge2 = to_vector3(t.v2 - t.v0);
    at.dpdu = edge1;
    at.dpdv = edge2;
    if (!vertices_.has_uvs()) return;
    const Vector2 uv0 = vertices_.uv(t.a0);
    const Vector2 duv1 = vertices_.uv(t.a1) - uv0, duv2 = vertices_.uv(t.a2) - uv0;
    const float a = duv1.x * duv2.y, b = duv1.y * duv2.x;
    const float determinant = a - b;
    if (std::abs(determinant) > 1e-6f * (std::abs(a) + std::abs(b))) {
        const float scale = 1 / determinant;
        at.dpdu = scale * (duv2.y * edge1 - duv1.y * edge2);
        at.dpdv = scale * (duv1.x * edge2 - duv2.x * edge1);
        if (is_finite(at.dpdu) && is_finite(at.dpdv)) return;
    }
    // The texture is squeezed into a line here: any tangents will do.
    const Frame frame = Frame::from_normal(at.n);
    at.dpdu = frame.s;
    at.dpdv = frame.t;
}

void Mesh::fill(const Ray&, const Hit& hit, Interaction& at) const {
    const Triangle t = triangle(hit.primitive);
    const Vector3 b(1 - hit.uv.x - hit.uv.y, hit.uv.x, hit.uv.y);
    const float side = flip_normals() ? -1.0f : 1.0f;
    const Vector3 n = t.normal();
    at.p = t.point(b);
    at.error = t.error();
    at.n = side * n;
    at.uv = interpolated_uv(t, b);
    const Vector3 ns = side * shading_normal(t, b, n);
    fill_derivatives(t, at);
    at.shading = Frame::from_normal_tangent(ns, at.dpdu);
}

std::vector<std::string> Mesh::attributes() const {
    std::vector<std::string> names;
    for (const MeshAttribute& attribute : attributes_) names.push_back(attribute.name);
    return names;
}

Color Mesh::attribute(std::string_view name, const Interaction& at) const {
    const auto found = std::find_if(attributes_.begin(), attributes_.end(),
                                    [&](const MeshAttribute& a) { return a.name == name; });
    if (found == attributes_.end()) return Color(0);
    const auto value = [&](std::size_t i) {
        const float* const v = &found->values[i * found->size];
        return found->size == 1 ? Color(v[0]) : Color(v[0], v[1], v[2]);
    };
    if (found->of_faces) return value(at.primitive);
    const std::uint32_t* const corner = &indices_[3 * std::size_t{at.primitive}];
    return (1 - at.hit_uv.x - at.hit_uv.y) * value(corner[0]) + at.hit_uv.x * value(corner[1]) +
           at.hit_uv.y * value(corner[2]);
}

void Mesh::prefetch(std::uint32_t primitive, Batch::Prefetch what) const {
    const std::uint32_t* const corner = &indices_[3 * std::size_t{primitive}];
    if (what == Batch::Prefetch::addresses) {
        __builtin_prefetch(corner);
    } else {
        for (int i = 0; i < 3; ++i) __builtin_prefetch(vertices_.at(corner[i]));
    }
}

float Mesh::area(std::uint32_t primitive) const {
    return static_cast<float>(0.5 * glm::length(triangle(primitive).scaled_normal()));
}

SurfaceSample Mesh::sample_at(std::uint32_t primitive, Vector3 b) const {
    const Triangle t = triangle(primitive);
    const Vector3 n = t.normal();
    return {.p = t.point(b),
            .n = flip_normals() ? -n : n,
            .hit_uv = {b.y, b.z},
            .error = t.error(),
            .pdf = 0};
}

Vector2 Mesh::uv_of(std::uint32_t primitive, const SurfaceSample& sample) const {
    const Vector2 b = sample.hit_uv;
    return interpolated_uv(triangle(primitive), {1 - b.x - b.y, b.x, b.y});
}

SurfaceSample Mesh::sample_area(std::uint32_t primitive, Vector2 u) const {
    const Vector2 b = square_to_uniform_triangle(u);
    SurfaceSample sample = sample_at(primitive, {b.x, b.y, 1 - b.x - b.y});
    sample.pdf = 1 / area(primitive);
    return sample;
}

std::optional<SurfaceSample> Mesh::sample_solid_angle(std::uint32_t primitive, const Receiver& from,
                                                      Vector2 u) const {
    const Triangle t = triangle(primitive);
    if (!t.solid_angle_from(from.p)) return Shape::sample_solid_angle(primitive, from, u);
    const SphericalTriangle seen(from.p, t.corner(0), t.corner(1), t.corner(2));
    const Vector2 b = seen.sample(Vector2d(u)).barycentrics;
    SurfaceSample sample = sample_at(primitive, {b.x, b.y, 1 - b.x - b.y});
    sample.pdf = seen.pdf();
    return sample;
}

float Mesh::pdf_solid_angle(std::uint32_t primitive, const Receiver& from, Vector3 wi,
                            const Interaction& hit) const {
    const std::optional<double> solid_angle = triangle(primitive).solid_angle_from(from.p);
    if (solid_angle) return static_cast<float>(1 / *solid_angle);
    return Shape::pdf_solid_angle(primitive, from, wi, hit);
}

std::pair<Vector3, float> Mesh::normal_cone(std::uint32_t primitive) const {
    const Vector3 n = triangle(primitive).normal();
    return {flip_normals() ? -n : n, 1.0f};
}

Bounds3 Mesh::primitive_bounds(std::uint32_t primitive) const {
    const Triangle t = triangle(primitive);
    Bounds3 bounds;
    for (int i = 0; i < 3; ++i) bounds.include(t.corner(i));
    return bounds;
}

}  // namespace lucerna
