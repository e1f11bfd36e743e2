// SPDX-License-Identifier: Apache-2.0
/// Triangle meshes: what `cube` and all mesh files become.
///
/// Vertices are in world space, floats that were rounded once. Counter-clockwise triangles face the
/// viewer from outside; where a file gives vertex normals, they decide instead. Mirroring keeps the
/// outside outside.
///
/// Texture coordinates: (0, 0) is the lower left corner of a picture and v grows upwards, as in
/// most OBJ files. Mitsuba counts v downwards; all shapes turn it over so that pictures lie as they
/// do there: v here is 1 − v there.
#pragma once

#include "core/base/huge_pages.h"
#include "core/interfaces/shape.h"
#include "core/math/four_floats.h"

#include <string>
#include <vector>

namespace lucerna {

/// Numbers that belong to vertices or to triangles, and mean what the scene makes of them.
struct MeshAttribute {
    std::string name;  ///< "vertex_…" or "face_…"
    bool of_faces = false;
    std::uint32_t size = 3;     ///< numbers in one value: 1 or 3
    std::vector<float> values;  ///< `size` of them to a position or a triangle
};

/// A mesh on its way from a file to a shape. Positions and normals are moved to the world in double
/// as they arrive, so that files far from the origin lose nothing.
struct MeshData {
    std::string name;  ///< of the file, for messages
    Transform world_from_file;
    std::vector<Vector3> positions;
    std::vector<Vector3> normals;        ///< none or one for each position; unit length or zero
    std::vector<Vector2> uvs;            ///< none or one for each position
    std::vector<std::uint32_t> indices;  ///< three to a triangle
    std::vector<MeshAttribute> attributes;
    bool face_normals = false;  ///< the file asks for a faceted look
    std::uint64_t crossing_polygons = 0;
    std::vector<std::string> warnings;  ///< what the file holds and the mesh does not

    /// Makes room. The counts must not be larger than the file can hold.
    void reserve(std::size_t vertices, std::size_t triangles);
    void add_position(Vector3d p) { positions.emplace_back(world_from_file.point(p)); }
    void add_normal(Vector3d n);
    /// Adds the triangles of a polygon (polygon.h). Its vertices must be there. False if it is too
    /// large.
    bool add_polygon(std::span<const std::uint32_t> corners);
    /// v → 1 − v.
    void flip_v();
};

/// Position, normal and texture coordinates of a vertex side by side, as far as there are any: a
/// hit reads three vertices, and each should cost one line of the cache.
class MeshVertices {
public:
    MeshVertices() = default;
    explicit MeshVertices(const MeshData& data);

    std::size_t count() const { return count_; }
    bool has_normals() const { return normal_ != 0; }
    bool has_uvs() const { return uv_ != 0; }
    VertexPositions positions() const { return {at(0), count_, stride_}; }

    /// Where vertex `i` begins, and its normal and texture coordinates, if there are any. Of the
    /// normal the fourth number means nothing.
    const float* at(std::uint32_t i) const {
        // Vertices do not end where lines do: all lines are one array of floats.
        return reinterpret_cast<const float*>(lines_.data()) + i * std::size_t{stride_};
    }
    FourFloats normal(const float* v) const { return load_four(v + normal_); }
    Vector2 uv(const float* v) const { return {v[uv_], v[uv_ + 1]}; }

private:
    struct alignas(64) CacheLine {
        float floats[16];
    };
    std::vector<CacheLine, HugePages<CacheLine>> lines_{1};
    std::size_t count_ = 0;
    std::uint32_t stride_ = 3;
    std::uint32_t normal_ = 0, uv_ = 0;  ///< offsets; zero: none
};

class Mesh : public Shape {
public:
    Geometry geometry() const final;
    Bounds3 bounds() const final { return bounds_; }
    void fill(const Ray& ray, const Hit& hit, Interaction& at) const final;
    std::vector<std::string> attributes() const final;
    Color attribute(std::string_view name, const Interaction& at) const final;
    void prefetch(std::uint32_t primitive, Batch::Prefetch what) const;

    std::uint32_t primitive_count() const final;
    float area(std::uint32_t primitive) const final;
    SurfaceSample sample_area(std::uint32_t primitive, Vector2 u) const final;
    Vector2 uv_of(std::uint32_t primitive, const SurfaceSample& sample) const final;
    /// Uniform by solid angle unless the triangle is too small or too near for it (solid_angle.h).
    std::optional<SurfaceSample> sample_solid_angle(std::uint32_t primitive, const Receiver& from,
                                                    Vector2 u) const final;
    float pdf_solid_angle(std::uint32_t primitive, const Receiver& from, Vector3 wi,
                          const Interaction& hit) const final;
    std::pair<Vector3, float> normal_cone(std::uint32_t primitive) const final;
    Bounds3 primitive_bounds(std::uint32_t primitive) const final;

    std::size_t vertex_count() const { return vertices_.count(); }

protected:
    /// Reads what all meshes have: `face_normals`. Empty until `assign`.
    explicit Mesh(const Params& params);
    /// Takes the arrays over and tells the warnings. Throws Error if a vertex is not finite or an
    /// index too large.
    void assign(const Params& params, MeshData data);

private:
    struct Triangle;
    Triangle triangle(std::uint32_t primitive) const;
    SurfaceSample sample_at(std::uint32_t primitive, Vector3 barycentrics) const;
    Vector2 interpolated_uv(const Triangle& triangle, Vector3 barycentrics) const;
    Vector3 shading_normal(const Triangle& triangle, Vector3 barycentrics, Vector3 n) const;
    void fill_derivatives(const Triangle& triangle, Interaction& at) const;

    MeshVertices vertices_;
    std::vector<std::uint32_t, HugePages<std::uint32_t>> indices_;
    std::vector<MeshAttribute> attributes_;
    bool face_normals_ = false;
    Bounds3 bounds_;
};

}  // namespace lucerna
