// SPDX-License-Identifier: Apache-2.0
/// Photons on their way from the lights through the scene.
///
/// Photon j of a pass is a function of (key of the pass, j) alone: passes can be traced by any
/// number of threads, and any part of one again.
#pragma once

#include "core/base/error.h"
#include "core/render/render_job.h"
#include "core/scene/medium_tracking.h"
#include "core/scene/scene.h"
#include "plugins/integrators/medium_around.h"
#include "plugins/integrators/photon_emission.h"
#include "plugins/integrators/photon_lanes.h"
#include "plugins/integrators/photon_numbers.h"
#include "plugins/integrators/photon_pass.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <optional>
#include <type_traits>
#include <vector>

namespace lucerna {

/// The fault is the scene's, though only the render shows it.
[[noreturn]] inline void refuse_scene(const std::string& message) {
    Diagnostic diagnostic;
    diagnostic.message = message;
    throw SceneError({diagnostic});
}

class PhotonTracer {
public:
    explicit PhotonTracer(const Scene& scene) : scene_(scene), emission_(scene) {
        if (scene.has_media()) media_.emplace(scene);
    }

    bool dark() const { return emission_.dark(); }

    /// Follows the photons begin … end − 1 and calls visit(PhotonHit) wherever one meets a surface,
    /// on which it may or may not be stored, by one of the ways in `pass.kinds`; and
    /// visit(MediumHit), if that can be called, wherever a medium scatters one. Throws SceneError
    /// if a power is not finite.
    template <typename Visit>
    void trace(const PhotonPass& pass, std::uint64_t begin, std::uint64_t end, PhotonEnergy& energy,
               Visit&& visit) const;

private:
    /// A photon under way.
    struct PhotonPath : TracedRay {
        std::uint64_t photon = 0;
        PhotonNumbers numbers;
        Color power{0};
        PhotonKind kind = PhotonKind::direct;
        int surfaces = 0;  ///< that it has met; scattering by a medium is counted, too
        int depth = 0;     ///< edges so far: what it goes straight through does not end one
        const Medium* medium = nullptr;  ///< in which it is; unknown before the first surface
    };
    /// Photons at surfaces of the same material, which scatters them together.
    struct MaterialQueue {
        explicit MaterialQueue(const BSDF* material)
            : bsdf(material), stored(stores_photons(*material)) {}

        const BSDF* bsdf;
        bool stored;
        std::size_t count = 0;
        std::array<PhotonPath*, lane_count> paths;
    };
    /// Photons that fly side by side: while one waits for memory, the others go on.
    struct Wavefront {
        static constexpr std::size_t size = 96;

        Wavefront() {
            for (auto* list : {&idle, &flying, &landed}) list->reserve(size);
            for (PhotonPath& path : paths) idle.push_back(&path);
        }
        MaterialQueue& queue(const BSDF* bsdf) {
            for (MaterialQueue& known : queues) {
                if (known.bsdf == bsdf) return known;
            }
            return queues.emplace_back(bsdf);
        }

        std::array<PhotonPath, size> paths;
        std::vector<PhotonPath*> idle, flying, landed;
        std::vector<MaterialQueue> queues;
        std::vector<TracedRay*> rays;
        // Kept, so that lanes without a photon hold what others left there.
        Vector2Lanes u_position{}, u_direction{};
        ScatteringLanes scattering{};
    };
    /// The most likely that a path goes on after so many surfaces. Without a limit, light between
    /// white walls would never end.
    static float most_survival(const PhotonPass& pass, int surfaces) {
        return surfaces < pass.rr_depth ? infinity : surfaces < 64 ? 1.0f : 0.95f;
    }
    std::uint64_t emit(const PhotonPass& pass, std::uint64_t begin, std::uint64_t end,
                       PhotonEnergy& energy, Wavefront& wavefront) const;
    template <typename Visit>
    bool cross_medium(const PhotonPass& pass, PhotonPath& path, PhotonEnergy& energy,
                      Wavefront& wavefront, Visit& visit) const;
    void arrive_from_infinity(PhotonPath& path, PhotonEnergy& energy) const;
    void scatter_in_medium(const PhotonPass& pass, PhotonPath& path, const MediumHit& hit, Rng& rng,
                           Color arriving, PhotonEnergy& energy, Wavefront& wavefront) const;
    template <typename Visit>
    void arrive(const PhotonPass& pass, PhotonPath& path, PhotonEnergy& energy,
                Wavefront& wavefront, Visit& visit) const;
    void scatter(const PhotonPass& pass, MaterialQueue& queue, PhotonEnergy& energy,
                 Wavefront& wavefront) const;
    [[noreturn]] void refuse_emission(std::uint32_t light, Vector3 at) const;
    [[noreturn]] void refuse_scattering(Vector3 at) const;

    const Scene& scene_;
    PhotonEmission emission_;
    std::optional<MediumAround> media_;  ///< if the scene has any
};

/// As soon as a path has ended the next one starts.
template <typename Visit>
void PhotonTracer::trace(const PhotonPass& pass, std::uint64_t begin, std::uint64_t end,
                         PhotonEnergy& energy, Visit&& visit) const {
    Wavefront wavefront;
    while (begin < end || !wavefront.flying.empty()) {
        while (begin < end && !wavefront.idle.empty())
            begin = emit(pass, begin, end, energy, wavefront);
        wavefront.rays.assign(wavefront.flying.begin(), wavefront.flying.end());
        scene_.intersect(wavefront.rays);
        std::swap(wavefront.flying, wavefront.landed);
        wavefront.flying.clear();
        for (PhotonPath* path : wavefront.landed) {
            if (media_ && cross_medium(pass, *path, energy, wavefront, visit)) continue;
            arrive(pass, *path, energy, wavefront, visit);
        }
        for (MaterialQueue& queue : wavefront.queues) scatter(pass, queue, energy, wavefront);
        wavefront.queues.clear();
    }
}

/// Lets photon `begin` and as many after it leave as one light sends together, as there are idle
/// paths, and before `end`. Returns the first that has still to leave.
inline std::uint64_t PhotonTracer::emit(const PhotonPass& pass, std::uint64_t begin,
                                        std::uint64_t end, PhotonEnergy& energy,
                                        Wavefront& wavefront) const {
    if (pass.max_depth < 1) return end;
    const auto choice = emission_.choose(begin, pass.count, uint64_to_double(mix64(pass.key)));
    const auto count = static_cast<std::size_t>(
        std::min({end - begin, choice.left, std::uint64_t{wavefront.idle.size()},
                  std::uint64_t{lane_count}}));
    const Light& light = scene_.lights()[choice.light];
    PhotonSequence sequence(hash_combine(pass.key, choice.light));
    std::array<PhotonPath*, lane_count> paths;
    std::copy_n(wavefront.idle.end() - static_cast<std::ptrdiff_t>(count), count, paths.begin());
    wavefront.idle.resize(wavefront.idle.size() - count);
    for (std::size_t i = 0; i < count; ++i) {
        const PhotonNumbers numbers = paths[i]->numbers = sequence.photon(choice.index + i);
        wavefront.u_position.set(i, numbers.position());
        wavefront.u_direction.set(i, numbers.direction());
    }
    EmissionLanes emitted;
    light.emitter->batch().sample_emission(*light.emitter, light, wavefront.u_position,
                                           wavefront.u_direction, count, emitted);
    const float scale = 1 / static_cast<float>(choice.pmf);
    for (std::size_t i = 0; i < count; ++i) {
        PhotonPath& path = *paths[i];
        path.photon = begin + i;
        path.ray = {.o = emitted.o[i], .d = emitted.d[i]};
        path.power = emitted.power[i] * scale;
        path.kind = PhotonKind::direct;
        path.surfaces = path.depth = 0;
        if (!is_finite(path.power)) refuse_emission(choice.light, path.ray.o);
        energy.emitted += static_cast<double>(luminance(path.power));
        if (media_ && light.emitter->infinite()) arrive_from_infinity(path, energy);
        (is_black(path.power) ? wavefront.idle : wavefront.flying).push_back(&path);
    }
    return begin + count;
}

/// A medium without end lets no light through from infinity, unless it thins out.
inline void PhotonTracer::arrive_from_infinity(PhotonPath& path, PhotonEnergy& energy) const {
    const Color before = path.power;
    Rng rng(path.numbers.seed());
    path.power *= transmittance({media_->outermost(), path.ray.o, -path.ray.d, infinity}, rng);
    energy.absorbed += static_cast<double>(luminance(before) - luminance(path.power));
}

/// Up to where the ray ends, or to where a medium scatters the photon: true, and it goes on from
/// there. True as well if it is absorbed. Roulette takes part of the photons instead of part of
/// their power, as at surfaces.
template <typename Visit>
bool PhotonTracer::cross_medium(const PhotonPass& pass, PhotonPath& path, PhotonEnergy& energy,
                                Wavefront& wavefront, Visit& visit) const {
    if (path.surfaces == 0) path.medium = media_->find(path.ray, path.hit);
    if (!path.medium) return false;
    Rng rng(path.numbers.seed());
    const Color before = path.power;
    MediumPath through{.beta = before};
    const Vector2 u = rng.next_float2();
    const bool scattered =
        sample_collision({path.medium, path.ray.o, path.ray.d, path.hit ? path.hit->t : infinity},
                         true, u, rng, through);
    const Vector3 p = path.ray.o + through.t * path.ray.d;
    if (!is_finite(through.beta)) refuse_scattering(p);
    if (scattered) {
        ++path.surfaces;
        ++path.depth;
        const MediumHit hit{.p = p,
                            .medium = *path.medium,
                            .w = -path.ray.d,
                            .power = through.beta,
                            .depth = path.depth,
                            .kind = path.kind};
        if constexpr (std::is_invocable_v<Visit&, const MediumHit&>) {
            if (includes(pass.kinds, path.kind)) visit(hit);
        }
        scatter_in_medium(pass, path, hit, rng, before, energy, wavefront);
        return true;
    }
    const bool roulette = path.surfaces + 1 >= pass.rr_depth;
    const float ratio = max_component(through.beta) / max_component(before);
    const float survival = roulette ? std::min(ratio, 1.0f) : 1.0f;
    const bool survives = rng.next_float() < survival && !is_black(through.beta);
    path.power = survives ? through.beta / survival : Color(0);
    energy.absorbed += static_cast<double>(luminance(before) - luminance(path.power));
    if (!survives) wavefront.idle.push_back(&path);
    return !survives;
}

/// Lets the medium turn a photon, or end it. `arriving` is its power before the flight.
inline void PhotonTracer::scatter_in_medium(const PhotonPass& pass, PhotonPath& path,
                                            const MediumHit& hit, Rng& rng, Color arriving,
                                            PhotonEnergy& energy, Wavefront& wavefront) const {
    const float u_lobe = rng.next_float();
    const PhaseSample next = hit.medium.phase().sample(hit.p, hit.w, u_lobe, rng.next_float2());
    const Color after = hit.power * next.weight;
    if (!is_finite(after)) refuse_scattering(hit.p);
    const float most = most_survival(pass, path.surfaces);
    const float ratio = max_component(after) / max_component(arriving);
    const float survival = most > 1 ? 1.0f : std::min(ratio, most);
    const bool survives = rng.next_float() < survival && !is_black(after);
    path.power = survives ? after / survival : Color(0);
    const double leaving = static_cast<double>(luminance(path.power));
    energy.absorbed += static_cast<double>(luminance(arriving)) - leaving;
    path.kind = PhotonKind::indirect;
    path.ray = {.o = hit.p, .d = next.wi};
    const bool goes_on = survives && includes(pass.kinds, path.kind) && path.depth < pass.max_depth;
    if (!goes_on) energy.cut += leaving;
    (goes_on ? wavefront.flying : wavefront.idle).push_back(&path);
}

/// What happens where the ray ends. If that is on a surface, the path waits there for others.
template <typename Visit>
void PhotonTracer::arrive(const PhotonPass& pass, PhotonPath& path, PhotonEnergy& energy,
                          Wavefront& wavefront, Visit& visit) const {
    ++path.surfaces;
    ++path.depth;
    if (!path.hit) {
        energy.escaped += static_cast<double>(luminance(path.power));
        wavefront.idle.push_back(&path);
        return;
    }
    const Interaction& at = *path.hit;
    MaterialQueue& queue = wavefront.queue(at.shape->bsdf());
    if (includes(pass.kinds, path.kind)) {
        visit(PhotonHit{.at = at,
                        .w = -path.ray.d,
                        .power = path.power,
                        .photon = path.photon,
                        .depth = path.depth,
                        .kind = path.kind,
                        .stored = queue.stored});
    }
    queue.paths[queue.count++] = &path;
    if (queue.count == lane_count) scatter(pass, queue, energy, wavefront);
}

/// Lets the material turn all paths that have met there, or end them.
inline void PhotonTracer::scatter(const PhotonPass& pass, MaterialQueue& queue,
                                  PhotonEnergy& energy, Wavefront& wavefront) const {
    std::array<const Interaction*, lane_count> at;
    ScatteringLanes& lanes = wavefront.scattering;
    for (std::size_t i = 0; i < queue.count; ++i) {
        PhotonPath& path = *queue.paths[i];
        at[i] = &*path.hit;
        const PhotonNumbers::Scattering u = path.numbers.scattering(path.surfaces == 1);
        lanes.u_lobe[i] = u.lobe;
        lanes.u_direction.set(i, u.direction);
        lanes.u_survival[i] = u.survival;
        lanes.most_survival[i] = most_survival(pass, path.surfaces);
        lanes.set(i, *at[i], path.ray.d, path.power);
    }
    lanes.look_back(queue.count);
    queue.bsdf->batch().sample(*queue.bsdf, {at.data(), queue.count}, lanes.wo, lanes.u_lobe,
                               lanes.u_direction, TransportMode::importance, lanes.next);
    lanes.scatter(queue.count);
    for (std::size_t i = 0; i < queue.count; ++i) {
        PhotonPath& path = *queue.paths[i];
        if (lanes.broken[i] != 0) refuse_scattering(at[i]->p);
        energy.absorbed +=
            static_cast<double>(lanes.arriving[i]) - static_cast<double>(lanes.leaving[i]);
        if (lanes.next.lobe[i] == Lobe::null) {
            --path.depth;  // the edge goes on
        } else if (path.kind != PhotonKind::indirect) {
            const bool diffuse = queue.stored && !any(lanes.next.lobe[i] & delta_lobes);
            path.kind = diffuse ? PhotonKind::indirect : PhotonKind::caustic;
        }
        // From the first diffuse surface on all is indirect: a pass for caustics ends there.
        const bool seen =
            path.kind != PhotonKind::indirect || includes(pass.kinds, PhotonKind::indirect);
        const bool goes_on = (lanes.leaving[i] > 0) & seen & (path.depth < pass.max_depth);
        energy.cut += static_cast<double>(select(goes_on, 0, lanes.leaving[i]));
        path.power = lanes.left[i];
        path.ray = {.o = lanes.o[i], .d = lanes.wi[i], .source = at[i]->source};
        if (media_) path.medium = medium_beyond(*at[i], path.ray.d, path.medium);
        (goes_on ? wavefront.flying : wavefront.idle).push_back(&path);
    }
    queue.count = 0;
}

inline void PhotonTracer::refuse_emission(std::uint32_t light, Vector3 at) const {
    const Vector3d p = scene_.origin() + Vector3d(at);
    refuse_scene(
        fmt::format("light number {} of the scene, at ({:g}, {:g}, {:g}), emits "
                    "photons of a power that is not finite",
                    light, p.x, p.y, p.z));
}

inline void PhotonTracer::refuse_scattering(Vector3 at) const {
    const Vector3d p = scene_.origin() + Vector3d(at);
    refuse_scene(
        fmt::format("a photon that is scattered at ({:g}, {:g}, {:g}) has a power that is "
                    "not finite",
                    p.x, p.y, p.z));
}

}  // namespace lucerna
