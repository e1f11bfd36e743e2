// SPDX-License-Identifier: Apache-2.0
/// Where light comes from.
///
/// An emitter is a law of emission. A light (light.h) is one place where it holds: a primitive of
/// a shape for `area`, a part of the picture for `envmap`, the emitter itself for all others. The
/// scene keeps all lights in one flat table; light samplers speak of indices into it. World space;
/// radiance in W/(m² sr).
#pragma once

#include "core/interfaces/batch/emitter_batch.h"
#include "core/interfaces/light.h"
#include "core/interfaces/texture.h"
#include "core/math/bounds.h"
#include "core/plugin/plugin.h"

#include <optional>

namespace lucerna {

/// Where a light is and where it shines, as light trees need it (Conty Estevez and Kulla 2018;
/// pbrt 4e, 12.6.3). Conservative: nothing is emitted outside.
struct LightBounds {
    Bounds3 box;              ///< of the emitting points; empty for lights at infinity
    Bounds3 directions{};     ///< unit vectors towards a light at infinity; empty for others
    Vector3 axis{0, 0, 1};    ///< of the cone of normals
    float cos_normals = -1;   ///< cosine of the largest angle between axis and a normal
    float cos_emission = -1;  ///< cosine of the largest angle between a normal and emission
    double power = 0;         ///< luminance of the emitted flux [W]; for lights at infinity, of the
                              ///< flux through the bounding sphere of the scene
    bool two_sided = false;   ///< emits to both sides of its normals
};

class Emitter : public Object {
public:
    static constexpr const char* kind = "emitter";
    ~Emitter() override;

    /// A shape carries it (`area`).
    virtual bool on_surface() const { return false; }
    /// At infinity: met by rays that hit nothing, and lit from all over the scene.
    virtual bool infinite() const { return false; }
    /// Number of lights that an emitter without a shape makes; their `primitive` is 0, 1, 2, …
    virtual std::uint32_t light_count() const { return 1; }
    /// Which of them rays of direction `d` meet that hit nothing.
    virtual std::uint32_t primitive_along(Vector3) const { return 0; }
    /// Cannot be hit by chance (point, spot, directional): multiple importance sampling leaves
    /// it to light sampling alone.
    virtual bool delta() const { return false; }

    /// Radiance that leaves the surface point `at` along the world direction `w`.
    virtual Color radiance(const Interaction& at, Vector3 w) const;
    /// Radiance that arrives from infinity along a ray of world direction `d`.
    virtual Color environment(Vector3 d) const;

    /// Light that arrives at `from`, u in [0, 1)². Empty: none can arrive.
    virtual std::optional<LightSample> sample_li(const Light& light, const Receiver& from,
                                                 Vector2 u) const = 0;
    /// Density with which `sample_li` chooses the world direction `wi` [1/sr]. `hit` is what lies
    /// there: on the light's primitive, or null for lights at infinity. Zero for delta lights.
    virtual float pdf_li(const Light& light, const Receiver& from, Vector3 wi,
                         const Interaction* hit) const = 0;

    /// A particle that leaves the light; u_position and u_direction in [0, 1)².
    virtual std::optional<EmissionSample> sample_emission(const Light& light, Vector2 u_position,
                                                          Vector2 u_direction) const = 0;

    virtual LightBounds bounds(const Light& light) const = 0;

    /// The functions above for many at once: made by `describe`.
    using Batch = EmitterBatch;
    const Batch& batch() const { return *batch_; }

private:
    friend Batch;
    const Batch* batch_ = nullptr;
};

}  // namespace lucerna
