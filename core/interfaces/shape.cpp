// SPDX-License-Identifier: Apache-2.0
/// What shapes share: common parameters, and sampling by solid angle through area.
#include "core/interfaces/shape.h"

#include "core/interfaces/bsdf.h"
#include "core/interfaces/emitter.h"
#include "core/math/solid_angle.h"

namespace lucerna {
namespace {

void require_affine(const Params& params, const Transform& transform) {
    const Matrix4d& m = transform.matrix();
    if (m[0][3] == 0 && m[1][3] == 0 && m[2][3] == 0 && m[3][3] == 1) return;
    params.error("to_world",
                 "\"to_world\" of a shape must be affine: the last row of its matrix must be "
                 "0 0 0 1");
}

/// What an emitter is that has no BSDF: it reflects nothing.
class BlackSurface final : public BSDF {
public:
    BlackSurface() { BSDFBatch::attach(*this); }  // no plugin: `describe` has not seen it
    Lobe lobes() const override { return Lobe::none; }
    BSDFValue evaluate(const Interaction&, Vector3, Vector3, TransportMode) const override {
        return {};
    }
    std::optional<BSDFSample> sample(const Interaction&, Vector3, float, Vector2,
                                     TransportMode) const override {
        return {};
    }
    Color albedo(const Interaction&, Vector3) const override { return Color(0); }
};

const BSDF& black_surface() {
    static const BlackSurface surface;
    return surface;
}

}  // namespace

Shape::Shape(const Params& params) {
    world_from_object_ = params.transform("to_world", "from the shape's own space to the world");
    media_.interior = params.child<Medium>("interior", "fills the shape");
    media_.exterior = params.child<Medium>("exterior", "is around the shape");
    const bool black = !media_ && !params.child_names(Emitter::kind).empty() &&
                       params.child_names(BSDF::kind).empty();
    bsdf_ = black ? &black_surface()
                  : &params.nested_or<BSDF>(media_ ? "null" : "diffuse",
                                            "how the surface scatters light; if there is none, a "
                                            "shape with media is \"null\", an emitter is black");
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
    return seen_from(from.p, sample_area(primitive, u));
}

float Shape::pdf_solid_angle(std::uint32_t primitive, const Receiver& from, Vector3,
                             const Interaction& hit) const {
    const float pdf = solid_angle_density(1 / area(primitive), from.p, hit.p, hit.n);
    return is_usable_density(pdf) ? pdf : 0.0f;
}

std::pair<Vector3, float> Shape::normal_cone(std::uint32_t) const { return {{0, 0, 1}, -1.0f}; }

Bounds3 Shape::primitive_bounds(std::uint32_t) const { return bounds(); }

}  // namespace lucerna
