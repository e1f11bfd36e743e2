// SPDX-License-Identifier: Apache-2.0
/// What shapes share: common parameters, and sampling by solid angle through area.
#include "core/interfaces/shape.h"

#include "core/interfaces/bsdf.h"
#include "core/interfaces/emitter.h"

namespace lucerna {
namespace {

/// The density per solid angle, seen from `from`, of a density per area at the point `p` with the
/// normal `n` (Veach 1997, 8.2.2.2). In double: a cubed distance overflows floats early.
float to_solid_angle(double pdf_area, Vector3 from, Vector3 p, Vector3 n) {
    const Vector3d d = Vector3d(p) - Vector3d(from);
    const double distance2 = glm::dot(d, d);
    const double projected = std::abs(glm::dot(d, Vector3d(n)));
    return static_cast<float>(pdf_area * distance2 * std::sqrt(distance2) / projected);
}

/// A density with which a sample can be weighted.
bool is_usable(float pdf) { return pdf > 0 && std::isfinite(pdf); }

void require_affine(const Params& params, const Transform& transform) {
    const Matrix4d& m = transform.matrix();
    if (m[0][3] == 0 && m[1][3] == 0 && m[2][3] == 0 && m[3][3] == 1) return;
    params.error("to_world",
                 "\"to_world\" of a shape must be affine: the last row of its matrix must be "
                 "0 0 0 1");
}

}  // namespace

Shape::Shape(const Params& params) {
    world_from_object_ = params.transform("to_world", "from the shape's own space to the world");
    bsdf_ = &params.nested_or<BSDF>("diffuse", "how the surface scatters light");
    emitter_ = params.nested<Emitter>("makes the surface a light: an area emitter");
    flip_normals_ = params.boolean("flip_normals", false, "turns the normals inwards");
    require_affine(params, world_from_object_);
    if (emitter_ && !emitter_->on_surface()) {
        params.error("emitter",
                     "this emitter cannot be part of a shape; put it directly into the scene, or "
                     "use an \"area\" emitter here");
    }
}

Shape::Shape(NoSurface) {}

Shape::~Shape() = default;

std::optional<Hit> Shape::intersect(const Ray&) const { return {}; }

std::optional<SurfaceSample> Shape::sample_solid_angle(std::uint32_t primitive,
                                                       const Receiver& from, Vector2 u) const {
    SurfaceSample sample = sample_area(primitive, u);
    sample.pdf = to_solid_angle(sample.pdf, from.p, sample.p, sample.n);
    if (!is_usable(sample.pdf)) return {};
    return sample;
}

float Shape::pdf_solid_angle(std::uint32_t primitive, const Receiver& from, Vector3,
                             const Interaction& hit) const {
    const float pdf = to_solid_angle(1.0 / area(primitive), from.p, hit.p, hit.n);
    return is_usable(pdf) ? pdf : 0.0f;
}

std::pair<Vector3, float> Shape::normal_cone(std::uint32_t) const { return {{0, 0, 1}, -1.0f}; }

Bounds3 Shape::primitive_bounds(std::uint32_t) const { return bounds(); }

}  // namespace lucerna
