// SPDX-License-Identifier: Apache-2.0
/// Geometry: what rays hit, and where emitters are.
///
/// A shape is placed in world space by its constructor (`to_world` is applied in double precision,
/// results are float). Triangles, parallelograms and instances are traced by Embree itself;
/// analytic shapes bring a function that knows no Embree.
#pragma once

#include "core/interfaces/batch/shape_batch.h"
#include "core/interfaces/geometry.h"
#include "core/interfaces/medium.h"
#include "core/math/solid_angle.h"
#include "core/plugin/plugin.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

class BSDF;
class Emitter;

class Shape : public Object {
public:
    static constexpr const char* kind = "shape";
    /// Reads what all shapes have: `to_world`, `flip_normals`, nested BSDF, emitter and media.
    explicit Shape(const Params& params);
    ~Shape() override;

    virtual Geometry geometry() const = 0;
    virtual Bounds3 bounds() const = 0;

    /// For analytic shapes: the nearest hit with 0 <= t <= ray.tmax, computed in double.
    virtual std::optional<Hit> intersect(const Ray& ray) const;
    /// Fills p, error, n, uv, shading, dpdu, dpdv; n and shading.n honour `flip_normals`, and
    /// shading.s follows dpdu.
    virtual void fill(const Ray& ray, const Hit& hit, Interaction& at) const = 0;
    /// Values that its file gives to vertices or faces, as `vertex_color`: their names, and the
    /// value of one of them at a point (shape, primitive and hit_uv of `at`).
    virtual std::vector<std::string> attributes() const { return {}; }
    virtual Color attribute(std::string_view /*name*/, const Interaction& /*at*/) const {
        return Color(0);
    }

    /// Number of primitives that can be sampled, each a light if the shape emits.
    virtual std::uint32_t primitive_count() const { return 1; }
    virtual float area(std::uint32_t primitive) const = 0;
    /// Uniform by area: pdf is 1 / area(primitive). u in [0, 1)².
    virtual SurfaceSample sample_area(std::uint32_t primitive, Vector2 u) const = 0;
    /// A point seen from `from`, with its density per solid angle. By area unless overridden.
    /// Empty: the primitive cannot be seen from there, or its density is not finite.
    virtual std::optional<SurfaceSample> sample_solid_angle(std::uint32_t primitive,
                                                            const Receiver& from, Vector2 u) const;
    /// Density [1/sr] with which `sample_solid_angle` chooses the direction `wi` that meets `hit`.
    virtual float pdf_solid_angle(std::uint32_t primitive, const Receiver& from, Vector3 wi,
                                  const Interaction& hit) const;
    /// The surface parameters of a sampled point: what `fill` has for the uv of hits there.
    virtual Vector2 uv_of(std::uint32_t /*primitive*/, const SurfaceSample& sample) const {
        return sample.hit_uv;
    }
    /// Cone around the normals of a primitive: axis, and cosine of its half angle.
    virtual std::pair<Vector3, float> normal_cone(std::uint32_t primitive) const;
    virtual Bounds3 primitive_bounds(std::uint32_t primitive) const;

    /// Null only for shapes that are never hit themselves (shapegroup, instance).
    const BSDF* bsdf() const { return bsdf_; }
    const Emitter* emitter() const { return emitter_; }
    /// What fills the space on both of its sides.
    const MediumInterface& media() const { return media_; }
    /// Index of the light of primitive 0 in the scene's table, if the shape emits.
    std::uint32_t first_light() const { return first_light_; }
    /// Names a primitive of a shape that emits, for rays that start or end on it.
    PrimitiveId primitive_id(std::uint32_t primitive) const {
        return {.geometry = scene_index_, .primitive = primitive};
    }

    /// The functions above for many at once: made by `describe`.
    using Batch = ShapeBatch;
    const Batch& batch() const { return *batch_; }

protected:
    /// A point chosen by area, with its density per solid angle seen from `from`. Empty if that is
    /// not a density.
    static std::optional<SurfaceSample> seen_from(Vector3 from, SurfaceSample sample) {
        sample.pdf = solid_angle_density(sample.pdf, from, sample.p, sample.n);
        if (!is_usable_density(sample.pdf)) return {};
        return sample;
    }

    /// For shapes that are never hit themselves (shapegroup, instance): reads nothing.
    struct NoSurface {};
    explicit Shape(NoSurface);

    const Transform& world_from_object() const { return world_from_object_; }
    bool flip_normals() const { return flip_normals_; }

private:
    friend class Scene;
    friend Batch;
    // What every hit reads comes first.
    const BSDF* bsdf_ = nullptr;
    const Emitter* emitter_ = nullptr;
    std::uint32_t first_light_ = 0;
    std::uint32_t scene_index_ = PrimitiveId::none;
    const Batch* batch_ = nullptr;
    bool flip_normals_ = false;
    Transform world_from_object_;
    MediumInterface media_;
};

}  // namespace lucerna
