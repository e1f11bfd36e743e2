// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene.h"

#include "core/interfaces/light_sampler.h"
#include "core/math/rounding.h"
#include "core/scene/accelerator.h"
#include "core/scene/medium_tracking.h"
#include "core/scene/preparation_error.h"
#include "core/scene/ray_statistics.h"
#include "core/scene/scatter.h"

namespace lucerna {

namespace {

constexpr float coordinate_limit = 1e18f;  // beyond it Embree's arithmetic overflows

bool is_traceable(const Ray& ray) {
    const Vector3 sums = absolute(ray.o) + absolute(ray.d);  // NaN and infinity stay
    return sums.x + sums.y + sums.z < coordinate_limit && ray.tmax >= 0 &&
           glm::dot(ray.d, ray.d) > 0;
}

/// Fills the interaction of a hit on a shape of a group: in the space of the group, then moved.
void fill_through_instance(const SceneHit& met, const Ray& ray, Interaction& at) {
    const auto instance = std::get<InstanceGeometry>(met.instance->geometry());
    const Transform& world_from_group = instance.world_from_group;
    const Transform group_from_world = world_from_group.inverse();
    // Shapes may leave them as they are; from an earlier hit they would be transformed once more.
    at.dpdu = Vector3(1, 0, 0), at.dpdv = Vector3(0, 1, 0);
    const Ray local{.o = group_from_world.point(ray.o),
                    .d = group_from_world.direction(ray.d),
                    .tmax = ray.tmax};
    met.shape->fill(local, met.hit, at);
    const Vector3d p = world_from_group.point(Vector3d(at.p));
    const Matrix4d& m = world_from_group.matrix();
    double stretch = 0;
    for (int row = 0; row < 3; ++row) {
        stretch =
            std::max(stretch, std::abs(m[0][row]) + std::abs(m[1][row]) + std::abs(m[2][row]));
    }
    at.p = Vector3(p);
    at.error = static_cast<float>(stretch) * at.error + gamma(4) * max_component(absolute(at.p));
    at.n = Vector3(glm::normalize(world_from_group.normal(Vector3d(at.n))));
    at.dpdu = world_from_group.direction(at.dpdu);
    at.dpdv = world_from_group.direction(at.dpdv);
    const Vector3d ns = glm::normalize(world_from_group.normal(Vector3d(at.shading.n)));
    at.shading = Frame::from_normal_tangent(Vector3(ns), at.dpdu);
    if (world_from_group.swaps_handedness()) at.shading.t = glm::cross(at.shading.n, at.shading.s);
}

/// Its direction has any length.
Ray shadow_ray(const Receiver& from, const LightSample& to) {
    Ray ray{.o = offset_ray_origin(from.p, from.error, from.n, to.wi),
            .d = to.wi,
            .tmax = infinity,
            .source = from.source};
    if (std::isfinite(to.distance)) {
        ray.d = offset_ray_origin(to.p, to.error, to.n, -to.wi) - ray.o;
        ray.tmax = 1 - 1e-5f;
    }
    return ray;
}

/// The same part of space.
Ray with_unit_direction(Ray ray) {
    const float length = glm::length(ray.d);
    ray.d /= length;
    ray.tmax *= length;
    return ray;
}

}  // namespace

Scene::Scene(SceneParts parts) : parts_(std::move(parts)) {
    for (const Shape* shape : parts_.shapes) bounds_.include(shape->bounds());
    if (bounds_.empty()) bounds_ = {.min = Vector3(0), .max = Vector3(0)};
    accelerator_ = std::make_unique<Accelerator>(parts_.shapes, parts_.threads);
    collect_lights();
    find_kinds_of_surfaces();
    find_media();
    // Emitters first: light samplers ask them for their power.
    const auto prepare_if = [&](bool emitters) {
        for (std::size_t i = 0; i < parts_.objects.size(); ++i) {
            Object& object = *parts_.objects[i];
            const bool is_emitter = dynamic_cast<const Emitter*>(&object) != nullptr;
            if (is_emitter != emitters) continue;
            try {
                object.prepare(*this);
            } catch (const Error& e) {
                throw PreparationError(i, e);
            }
        }
    };
    prepare_if(true);
    prepare_if(false);
    // That of the first integrator; objects come after those that are nested in them.
    for (const auto& object : parts_.objects) {
        if (light_sampler_ && dynamic_cast<const Integrator*>(object.get())) break;
        const auto* const sampler = dynamic_cast<const LightSampler*>(object.get());
        if (sampler) light_sampler_ = sampler;
    }
}

Scene::~Scene() = default;

void Scene::collect_lights() {
    for (const Emitter* emitter : parts_.emitters) {
        if (emitter->infinite()) {
            infinite_lights_.push_back(static_cast<std::uint32_t>(lights_.size()));
        }
        for (std::uint32_t i = 0; i < emitter->light_count(); ++i) {
            lights_.push_back({.emitter = emitter, .primitive = i});
        }
    }
    for (std::size_t index = 0; index < parts_.shapes.size(); ++index) {
        Shape* shape = parts_.shapes[index];
        if (!shape->emitter()) continue;
        shape->scene_index_ = static_cast<std::uint32_t>(index);
        shape->first_light_ = static_cast<std::uint32_t>(lights_.size());
        for (std::uint32_t i = 0; i < shape->primitive_count(); ++i) {
            lights_.push_back({.emitter = shape->emitter(), .shape = shape, .primitive = i});
        }
    }
}

void Scene::find_kinds_of_surfaces() {
    for (const auto& object : parts_.objects) {
        const auto* shape = dynamic_cast<const Shape*>(object.get());
        if (!shape || !shape->bsdf()) continue;
        const Lobe lobes = shape->bsdf()->lobes();
        surface_lobes_ = surface_lobes_ | lobes;
        has_specular_surfaces_ = has_specular_surfaces_ || only_specular(lobes);
    }
}

void Scene::find_media() {
    contains_media_ = parts_.sensor && parts_.sensor->medium();
    for (const auto& object : parts_.objects) {
        const auto* shape = dynamic_cast<const Shape*>(object.get());
        contains_media_ = contains_media_ || (shape && shape->media());
        if (const auto* medium = dynamic_cast<const Medium*>(object.get())) {
            media_.push_back(medium);
        }
    }
    has_media_ = contains_media_ && parts_.integrator && parts_.integrator->renders_media();
}

/// False if the hit is to be passed over: it is on the primitive that the ray starts on, or its
/// distance is not where the primitive is (edge-on slivers).
bool Scene::fill(const Ray& ray, const SceneHit& met, Interaction& at) const {
    if (met.flat && met.id == ray.source) return false;
    at.shape = met.shape;
    at.primitive = met.hit.primitive;
    at.hit_uv = met.hit.uv;
    at.source = met.flat ? met.id : PrimitiveId{};
    at.t = met.hit.t;
    if (met.instance) [[unlikely]] {
        fill_through_instance(met, ray, at);
    } else {
        met.shape->fill(ray, met.hit, at);
    }
    const float distance = glm::dot(at.p - ray.o, ray.d);
    const float tolerance = 1e-3f * std::max(std::abs(distance), at.t) + 64 * at.error;
    if (!(std::abs(distance - at.t) <= tolerance)) [[unlikely]] {
        ++thread_ray_statistics().rejected;
        return false;
    }
    return true;
}

/// What passes a hit over is rare; a bound on the number of attempts keeps it finite.
std::optional<Interaction> Scene::intersect_from(const Ray& ray, float tmin, int attempt) const {
    for (; attempt < 8; ++attempt) {
        ++thread_ray_statistics().intersections;
        SceneHit met;
        if (!accelerator_->intersect(ray, tmin, met)) return {};
        std::optional<Interaction> at(std::in_place);
        if (fill(ray, met, *at)) return at;
        tmin = next_float_up(met.hit.t);
    }
    return {};
}

std::optional<Interaction> Scene::intersect(const Ray& ray) const {
    if (!is_traceable(ray)) [[unlikely]] {
        ++thread_ray_statistics().dropped;
        return {};
    }
    return intersect_from(ray, 0, 0);
}

void Scene::intersect(std::span<TracedRay* const> rays) const {
    constexpr std::size_t most = 16;  // what they read stays in the first cache
    for (; rays.size() > most; rays = rays.subspan(most)) intersect(rays.first(most));
    RayStatistics& statistics = thread_ray_statistics();
    const auto prefetch = [](const SceneHit& hit, Shape::Batch::Prefetch what) {
        hit.shape->batch().prefetch(*hit.shape, hit.hit.primitive, what);
    };
    SceneHit met[most];
    std::uint8_t hits[most];  // of the rays, those that met something
    std::size_t hit_count = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray& ray = rays[i]->ray;
        const bool traceable = is_traceable(ray);
        ++(traceable ? statistics.intersections : statistics.dropped);
        if (!traceable || !accelerator_->intersect(ray, 0, met[i])) {
            rays[i]->hit.reset();
            continue;
        }
        if (met[i].large) prefetch(met[i], Shape::Batch::Prefetch::addresses);
        hits[hit_count++] = static_cast<std::uint8_t>(i);
    }
    for (std::size_t k = 0; k < hit_count; ++k) {
        const SceneHit& hit = met[hits[k]];
        if (hit.large) prefetch(hit, Shape::Batch::Prefetch::data);
    }
    for (std::size_t k = 0; k < hit_count; ++k) {
        const std::size_t i = hits[k];
        TracedRay& traced = *rays[i];
        // To construct it anew would clear what is then filled.
        if (!traced.hit) traced.hit.emplace();
        if (fill(traced.ray, met[i], *traced.hit)) continue;
        traced.hit = intersect_from(traced.ray, next_float_up(met[i].hit.t), 1);
    }
}

bool Scene::occluded(const Ray& ray) const { return occluded(ray, {}); }

bool Scene::occluded(const Receiver& from, const LightSample& to) const {
    return occluded(shadow_ray(from, to), to.target);
}

bool Scene::occluded(const Ray& ray, PrimitiveId target) const {
    RayStatistics& statistics = thread_ray_statistics();
    if (!is_traceable(ray)) [[unlikely]] {
        ++statistics.dropped;
        return true;
    }
    const bool blocked = accelerator_->occluded(ray, target);
    ++statistics.occlusions;
    statistics.blocked += blocked;
    return blocked;
}

void Scene::occluded(ShadowPacket& rays) const {
    RayStatistics& statistics = thread_ray_statistics();
    std::uint64_t traced = 0, open = 0;
    for (std::size_t i = 0; i < lane_count; ++i) {
        if (!rays.open[i]) continue;
        rays.open[i] = is_traceable({.o = rays.o[i], .d = rays.d[i], .tmax = rays.tmax[i]});
        ++(rays.open[i] ? traced : statistics.dropped);
    }
    accelerator_->occluded(rays);
    for (const bool is_open : rays.open) open += is_open;
    statistics.occlusions += traced;
    statistics.blocked += traced - open;
}

Color Scene::transmittance(const Ray& ray, bool past_emitters) const {
    if (!occluded(ray)) return Color(1);
    if (!has_null_surfaces() && !past_emitters) return Color(0);
    return transmittance(ray, {}, past_emitters);
}

Color Scene::transmittance(const Receiver& from, const LightSample& to) const {
    const Ray ray = shadow_ray(from, to);
    if (!occluded(ray, to.target)) return Color(1);
    if (!has_null_surfaces()) return Color(0);
    return transmittance(with_unit_direction(ray), to.target, false);
}

Color Scene::transmittance(const Receiver& from, const LightSample& to, Rng& rng) const {
    if (!has_media_) return transmittance(from, to);
    Ray ray = shadow_ray(from, to);
    const bool blocked = occluded(ray, to.target);
    if (blocked && !has_null_surfaces()) return Color(0);
    ray = with_unit_direction(ray);
    const MediumSegment whole{.medium = from.medium, .o = ray.o, .d = ray.d, .length = ray.tmax};
    if (!blocked) return lucerna::transmittance(whole, rng);
    // Surfaces first: they are cheaper than media, and may let nothing through.
    std::vector<MediumSegment> media{whole};
    Color result = transmittance(ray, to.target, false, &media);
    for (const MediumSegment& segment : media) {
        if (is_black(result)) break;
        result *= lucerna::transmittance(segment, rng);
    }
    return result;
}

/// Along a ray on which something lies, surface by surface; `target` does not block it. The first
/// of `media` tells in which medium it starts; gets the parts of the ray between the surfaces.
Color Scene::transmittance(Ray ray, PrimitiveId target, bool past_emitters,
                           std::vector<MediumSegment>* media) const {
    const Vector3 end = ray.o + ray.tmax * ray.d;
    Color result(1);
    while (is_traceable(ray)) {
        const std::optional<Interaction> at = intersect_from(ray, 0, 0);
        if (!at || (at->source == target && target != PrimitiveId{})) {
            --thread_ray_statistics().blocked;
            return result;
        }
        if (!past_emitters || !at->shape->emitter()) {
            result *= straight_transmittance(*at, -ray.d);
            if (is_black(result)) return result;
        }
        if (media) media->back().length = at->t;
        Ray next = at->spawn_ray(ray.d);
        if (std::isfinite(ray.tmax)) {
            // Aimed anew, since the origin has been moved off the surface: a ray that grazes a
            // small lamp would miss the point on it.
            const Vector3 rest = end - next.o;
            next.tmax = glm::dot(rest, ray.d) > 0 ? glm::length(rest) : 0;
            if (next.tmax > 0) next.d = rest / next.tmax;
        }
        if (media) {
            const Medium* const medium = medium_beyond(*at, ray.d, media->back().medium);
            media->push_back({medium, next.o, next.d, next.tmax});
        }
        ray = next;
    }
    return Color(0);  // not finite
}

Color Scene::environment(Vector3 d) const {
    Color sum(0);
    for (const std::uint32_t i : infinite_lights_) sum += lights_[i].emitter->environment(d);
    return sum;
}

std::size_t Scene::accelerator_bytes() const { return accelerator_->bytes(); }

}  // namespace lucerna
