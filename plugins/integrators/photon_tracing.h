// SPDX-License-Identifier: Apache-2.0
/// Photons on their way from the lights through the scene.
///
/// Photon j of a pass is a function of (key of the pass, j) alone: passes can be traced by any
/// number of threads, and any part of one again.
#pragma once

#include "core/base/error.h"
#include "core/interfaces/bsdf.h"
#include "core/render/render_job.h"
#include "core/scene/scene.h"
#include "plugins/integrators/photon.h"
#include "plugins/integrators/photon_lanes.h"
#include "plugins/integrators/photon_numbers.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace lucerna {

/// How light came to a point.
enum class PhotonKind : unsigned {
    direct = 1,    ///< from the light itself: L D
    caustic = 2,   ///< by specular or glossy surfaces only: L S+ D
    indirect = 4,  ///< all else
};
using PhotonKinds = unsigned;

inline PhotonKinds operator|(PhotonKind a, PhotonKind b) {
    return static_cast<unsigned>(a) | static_cast<unsigned>(b);
}
inline bool includes(PhotonKinds kinds, PhotonKind kind) {
    return (kinds & static_cast<unsigned>(kind)) != 0;
}

/// Photons are stored on surfaces that have a diffuse lobe. All others, mirrors or glossy, are
/// followed: density there would have to be enormous.
inline bool stores_photons(const BSDF& bsdf) {
    return any(bsdf.lobes() & (Lobe::diffuse_reflection | Lobe::diffuse_transmission));
}

/// True if some surface can make caustics: then they are worth a map of their own.
inline bool has_caustics(std::span<const Shape* const> shapes) {
    return std::any_of(shapes.begin(), shapes.end(), [](const Shape* shape) {
        if (const BSDF* bsdf = shape->bsdf()) {
            const Lobe lobes = bsdf->lobes();
            return any(lobes & specular_lobes) ||
                   (any(lobes & smooth_lobes) && !stores_photons(*bsdf));
        }
        const Geometry geometry = shape->geometry();
        const auto* instance = std::get_if<InstanceGeometry>(&geometry);
        if (!instance) return false;
        return has_caustics(std::get<GroupGeometry>(instance->group->geometry()).shapes);
    });
}

/// Where all power went, in luminance [W], times the number of photons emitted. Roulette makes
/// `absorbed` a difference of estimates: single terms may be negative.
struct PhotonEnergy {
    double emitted = 0;
    double escaped = 0;   ///< left the scene
    double absorbed = 0;  ///< by surfaces
    double cut = 0;       ///< on paths that reached max_depth
    double stored = 0;    ///< arrived where a photon was stored; may well travel on

    PhotonEnergy& operator+=(const PhotonEnergy& o) {
        emitted += o.emitted;
        escaped += o.escaped;
        absorbed += o.absorbed;
        cut += o.cut;
        stored += o.stored;
        return *this;
    }
};

/// MixtureWeights photons among the lights by systematic sampling: of n photons each light with the
/// fraction p of the power emits ⌊n p⌋ or ⌈n p⌉, n p on average. They are numbered light by light.
class PhotonEmission {
public:
    explicit PhotonEmission(const Scene& scene) {
        double total = 0;
        cdf_.reserve(scene.lights().size() + 1);
        cdf_.push_back(0);
        for (const Light& light : scene.lights()) {
            total += light.emitter->bounds(light).power;
            cdf_.push_back(total);
        }
        for (double& x : cdf_) x = total > 0 ? x / total : 0;
        // Rounding must not give a photon to lights without power that come last.
        while (cdf_.size() > 1 && cdf_[cdf_.size() - 2] == cdf_.back()) cdf_.pop_back();
    }

    /// No light has power.
    bool dark() const { return cdf_.size() == 1; }

    struct Choice {
        std::uint32_t light;
        double pmf;           ///< expected share of the photons
        std::uint64_t index;  ///< of the photon among those of its light
        std::uint64_t left;   ///< photons that the light has still to emit, with this one
    };
    /// For photon j of `count`; `offset` in [0, 1) is the same for all of them.
    Choice choose(std::uint64_t j, std::uint64_t count, double offset) const {
        const auto first = [&](double cdf) {
            const double at = cdf * static_cast<double>(count) - offset;
            return at > 0 ? static_cast<std::uint64_t>(std::ceil(at)) : 0;
        };
        const auto next = std::partition_point(cdf_.begin() + 1, cdf_.end() - 1,
                                               [&](double cdf) { return first(cdf) <= j; });
        const double begin = *(next - 1), end = *next;
        return {.light = static_cast<std::uint32_t>(next - cdf_.begin() - 1),
                .pmf = end - begin,
                .index = j - first(begin),
                .left = (next == cdf_.end() - 1 ? count : first(end)) - j};
    }

private:
    std::vector<double> cdf_;  ///< before each light, and after the last that has power
};

/// What a pass of photons is.
struct PhotonPass {
    std::uint64_t key = 0;    ///< of its random numbers
    std::uint64_t count = 0;  ///< of photons that are emitted, at least 1
    int max_depth = 0;        ///< edges of the longest path
    int rr_depth = 1;         ///< edges before roulette may end a path
    PhotonKinds kinds = 0;    ///< that are visited
};

/// A photon that arrives at a surface.
struct PhotonHit {
    const Interaction& at;
    Vector3 w;             ///< unit, back to where it came from
    Color power;           ///< [W], to be divided by PhotonPass::count
    std::uint64_t photon;  ///< of the pass
    int depth;             ///< edges of its path
    PhotonKind kind;
    bool stored;  ///< the surface is one that keeps photons
};

/// The fault is the scene's, though only the render shows it.
[[noreturn]] inline void refuse_scene(const std::string& message) {
    Diagnostic diagnostic;
    diagnostic.message = message;
    throw SceneError({diagnostic});
}

class PhotonTracer {
public:
    explicit PhotonTracer(const Scene& scene) : scene_(scene), emission_(scene) {}

    bool dark() const { return emission_.dark(); }

    /// Follows the photons begin … end − 1 and calls visit(PhotonHit) wherever one meets a surface,
    /// on which it may or may not be stored, by one of the ways in `pass.kinds`. Throws SceneError
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
        int surfaces = 0;  ///< that it has met
        int depth = 0;     ///< edges so far: what it goes straight through does not end one
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
    void arrive(const PhotonPass& pass, PhotonPath& path, PhotonEnergy& energy,
                Wavefront& wavefront, Visit& visit) const;
    void scatter(const PhotonPass& pass, MaterialQueue& queue, PhotonEnergy& energy,
                 Wavefront& wavefront) const;
    [[noreturn]] void refuse_emission(std::uint32_t light, Vector3 at) const;
    [[noreturn]] void refuse_scattering(Vector3 at) const;

    const Scene& scene_;
    PhotonEmission emission_;
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
        for (PhotonPath* path : wavefront.landed) arrive(pass, *path, energy, wavefront, visit);
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
        (is_black(path.power) ? wavefront.idle : wavefront.flying).push_back(&path);
    }
    return begin + count;
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

/// The result of many photons, in their order whatever the number of threads.
struct StoredPhotons {
    std::vector<Photon> photons;
    PhotonEnergy energy;
    double emitted = 0;  ///< number of photons that left the lights

    void append(const StoredPhotons& other) {
        photons.insert(photons.end(), other.photons.begin(), other.photons.end());
        energy += other.energy;
    }
};

/// Traces photons begin … end − 1 of a pass and stores those that come to matte surfaces.
inline void store_photons(const PhotonTracer& tracer, const PhotonPass& pass, std::uint64_t begin,
                          std::uint64_t end, StoredPhotons& result) {
    tracer.trace(pass, begin, end, result.energy, [&](const PhotonHit& hit) {
        if (!hit.stored) return;
        const float side = std::copysign(1.0f, glm::dot(hit.w, hit.at.n));
        result.photons.emplace_back(hit.at.p, hit.power, hit.w, side * hit.at.n, hit.depth);
        result.energy.stored += static_cast<double>(luminance(hit.power));
    });
}

/// Traces a pass in parallel and appends its photons to `result`. Ends early if `interrupted`.
///
/// Each task fills a chunk of its own. While a batch of chunks is traced, the batch before is
/// appended, so that no thread waits for it; batches bound what is held twice, and their memory
/// serves again.
inline void store_photons(const PhotonTracer& tracer, const PhotonPass& pass,
                          const Workers& workers, const std::function<bool()>& interrupted,
                          StoredPhotons& result) {
    constexpr std::uint64_t chunk_size = 512, batch_size = 128;
    std::vector<StoredPhotons> batch(batch_size), before(batch_size);
    const auto append = [&] {
        for (StoredPhotons& chunk : before) {
            result.append(chunk);
            chunk.photons.clear();
            chunk.energy = {};
        }
    };
    for (std::uint64_t first = 0; first < pass.count; first += batch_size * chunk_size) {
        const std::uint64_t end = std::min(first + batch_size * chunk_size, pass.count);
        const std::uint64_t chunks = (end - first + chunk_size - 1) / chunk_size;
        workers.run(static_cast<std::int64_t>(1 + chunks), [&](std::int64_t task) {
            if (task == 0) return append();
            if (interrupted()) return;
            const auto c = static_cast<std::uint64_t>(task - 1);
            const std::uint64_t begin = first + c * chunk_size;
            store_photons(tracer, pass, begin, std::min(begin + chunk_size, end), batch[c]);
        });
        std::swap(batch, before);
    }
    append();
    result.emitted += static_cast<double>(pass.count);
}

}  // namespace lucerna
