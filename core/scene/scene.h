// SPDX-License-Identifier: Apache-2.0
/// The world while it is rendered: immutable, shared by all threads, owner of all objects.
#pragma once

#include "core/base/huge_pages.h"
#include "core/interfaces/emitter.h"
#include "core/interfaces/integrator.h"
#include "core/interfaces/scattering.h"
#include "core/interfaces/sensor.h"
#include "core/interfaces/shape.h"
#include "core/scene/ray_queries.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace lucerna {

class Accelerator;
class Rng;
struct MediumSegment;
struct SceneHit;
class LightSampler;

/// Everything that a scene is made of, as the builder hands it over.
struct SceneParts {
    std::vector<std::unique_ptr<Object>> objects;  ///< all of them, in the order of construction
    std::vector<Shape*> shapes;                    ///< of the world itself, not of groups
    std::vector<const Emitter*> emitters;          ///< without a shape
    const Integrator* integrator = nullptr;
    const Sensor* sensor = nullptr;
    Vector3d origin{0};      ///< the point of the scene file that is world (0, 0, 0) now
    std::uint64_t hash = 0;  ///< of the description and the files it names
    int threads = 0;         ///< that may build; 0: all
};

class Scene {
public:
    /// Builds the accelerator and the table of lights, then prepares all objects.
    explicit Scene(SceneParts parts);
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    /// The nearest surface along the ray. A ray that is not finite is dropped and counted.
    std::optional<Interaction> intersect(const Ray& ray) const;
    /// The same for several rays, whose waits for memory overlap. Best for 16 or more.
    void intersect(std::span<TracedRay* const> rays) const;
    /// True if something lies on the ray, though it may let light through.
    bool occluded(const Ray& ray) const;
    /// True if something lies between the receiver and the sampled point of a light. Both ends
    /// are moved off their surfaces.
    bool occluded(const Receiver& from, const LightSample& to) const;
    /// Closes the rays on which something lies.
    void occluded(ShadowPacket& rays) const;
    /// The fraction of light that gets along the ray past surfaces that let it go straight through
    /// (BSDF::transmittance), and, with `past_emitters`, past those that emit.
    Color transmittance(const Ray& ray, bool past_emitters = false) const;
    /// The same between the receiver and the sampled point of a light.
    Color transmittance(const Receiver& from, const LightSample& to) const;
    /// The same through media, too, of which the first is `from.medium`: an unbiased estimate.
    Color transmittance(const Receiver& from, const LightSample& to, Rng& rng) const;

    /// All lobes that occur on surfaces, those of groups included.
    Lobe surface_lobes() const { return surface_lobes_; }
    /// Whether some surfaces are mirrors or clear glass, and nothing else.
    bool has_specular_surfaces() const { return has_specular_surfaces_; }
    /// Whether there are media and the integrator renders them.
    bool has_media() const { return has_media_; }
    /// Whether there are media at all.
    bool contains_media() const { return contains_media_; }
    /// All media, whether something is in them or not.
    std::span<const Medium* const> media() const { return media_; }

    /// All lights: lights().size() may be millions.
    std::span<const Light> lights() const { return lights_; }
    /// For each emitter at infinity, the index of its first light.
    std::span<const std::uint32_t> infinite_lights() const { return infinite_lights_; }
    /// The light that a point of an emitting surface belongs to.
    static std::uint32_t light_of(const Interaction& at) {
        return at.shape->first_light() + at.primitive;
    }
    /// The light of an emitter at infinity, whose first one is `first`, that rays along `d` meet.
    std::uint32_t light_along(std::uint32_t first, Vector3 d) const {
        return first + lights_[first].emitter->primitive_along(d);
    }
    /// Radiance that arrives from infinity along a ray of direction `d`.
    Color environment(Vector3 d) const;

    /// Bounds of all shapes; a point at the origin if there are none.
    const Bounds3& bounds() const { return bounds_; }
    const Integrator& integrator() const { return *parts_.integrator; }
    const Sensor& sensor() const { return *parts_.sensor; }
    /// That of the integrator, of the first that has one if there are several; null if none has.
    const LightSampler* light_sampler() const { return light_sampler_; }
    std::span<Shape* const> shapes() const { return parts_.shapes; }
    Vector3d origin() const { return parts_.origin; }
    std::uint64_t hash() const { return parts_.hash; }
    /// That may prepare it; 0: all.
    int threads() const { return parts_.threads; }
    /// Memory of the accelerator [bytes].
    std::size_t accelerator_bytes() const;

private:
    /// Whether some surfaces let light straight through.
    bool has_null_surfaces() const { return any(surface_lobes_ & Lobe::null); }
    void collect_lights();
    void find_kinds_of_surfaces();
    void find_media();
    bool occluded(const Ray& ray, PrimitiveId target) const;
    Color transmittance(Ray ray, PrimitiveId target, bool past_emitters,
                        std::vector<MediumSegment>* media = nullptr) const;
    bool fill(const Ray& ray, const SceneHit& met, Interaction& at) const;
    std::optional<Interaction> intersect_from(const Ray& ray, float tmin, int attempt) const;

    SceneParts parts_;
    Bounds3 bounds_;
    std::unique_ptr<Accelerator> accelerator_;
    std::vector<Light, HugePages<Light>> lights_;
    std::vector<std::uint32_t> infinite_lights_;
    std::vector<const Medium*> media_;
    const LightSampler* light_sampler_ = nullptr;
    Lobe surface_lobes_ = Lobe::none;
    bool has_specular_surfaces_ = false;
    bool has_media_ = false, contains_media_ = false;
};

}  // namespace lucerna
