// SPDX-License-Identifier: Apache-2.0
/// Photons on their way from the lights through the scene.
///
/// Photon j of a pass is a function of (key of the pass, j) alone: passes can be traced by any
/// number of threads, and any part of one again.
#pragma once

#include "core/interfaces/bsdf.h"
#include "core/math/sequences.h"
#include "core/plugin/error.h"
#include "core/render/render_job.h"
#include "core/scene/scene.h"
#include "plugins/integrators/photon.h"

#include <fmt/format.h>

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
            return !stores_photons(*bsdf) || any(bsdf->lobes() & delta_lobes);
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

/// Shares photons among the lights by systematic sampling: of n photons each light with the
/// fraction p of the power emits ⌊n p⌋ or ⌈n p⌉, n p on average.
class PhotonEmission {
public:
    explicit PhotonEmission(const Scene& scene) {
        cdf_.reserve(scene.lights().size() + 1);
        for (const Light& light : scene.lights()) {
            cdf_.push_back(total_);
            total_ += light.emitter->bounds(light).power;
        }
        cdf_.push_back(total_);
        for (double& x : cdf_) x = total_ > 0 ? x / total_ : 0;
    }

    /// No light has power.
    bool dark() const { return !(total_ > 0); }

    struct Choice {
        std::uint32_t light;
        std::uint64_t index;  ///< of the photon among those of its light
        double pmf;           ///< expected share of the photons
    };
    /// For photon j of `count`; `offset` in [0, 1) is the same for all of them.
    Choice choose(std::uint64_t j, std::uint64_t count, double offset) const {
        const double n = static_cast<double>(count);
        const double place = std::min((static_cast<double>(j) + offset) / n, 1 - 0x1p-53);
        const auto next = std::upper_bound(cdf_.begin(), cdf_.end() - 1, place);
        const auto light = static_cast<std::size_t>(next - cdf_.begin()) - 1;
        const double first = std::max(std::ceil(cdf_[light] * n - offset), 0.0);
        return {.light = static_cast<std::uint32_t>(light),
                .index = j - std::min(j, static_cast<std::uint64_t>(first)),
                .pmf = cdf_[light + 1] - cdf_[light]};
    }

private:
    std::vector<double> cdf_;
    double total_ = 0;
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
    Vector3 w;    ///< unit, back to where it came from
    Color power;  ///< [W], to be divided by PhotonPass::count
    int depth;    ///< edges of its path
    PhotonKind kind;
};

/// Owen-scrambled Sobol' points, padded: number `index` of each pair of dimensions.
class PhotonNumbers {
public:
    PhotonNumbers(std::uint64_t key, std::uint64_t index) : key_(key), index_(index) {}
    Vector2 next_2d() { return sobol_owen_2d(index_, key_ + mix64(dimension_++)); }

private:
    std::uint64_t key_, index_, dimension_ = 0;
};

class PhotonTracer {
public:
    explicit PhotonTracer(const Scene& scene) : scene_(scene), emission_(scene) {}

    bool dark() const { return emission_.dark(); }

    /// Follows photon `j` and calls visit(PhotonHit) wherever it meets a surface, on which it may
    /// or may not be stored, by one of the ways in `pass.kinds`. Throws Error if its power is not
    /// finite.
    template <typename Visit>
    void trace(const PhotonPass& pass, std::uint64_t j, PhotonEnergy& energy, Visit&& visit) const;

private:
    struct Flight {
        Ray ray;
        Color power{0};
        PhotonKind kind = PhotonKind::direct;
    };
    /// The most likely that a path goes on after so many edges. Without a limit, light between
    /// white walls would never end.
    static float most_survival(const PhotonPass& pass, int depth) {
        return depth < pass.rr_depth ? infinity : depth < 64 ? 1.0f : 0.95f;
    }
    bool scatter(const Interaction& at, Vector2 u_choice, Vector2 u_direction, float most_survival,
                 Flight& flight) const;

    const Scene& scene_;
    PhotonEmission emission_;
};

template <typename Visit>
void PhotonTracer::trace(const PhotonPass& pass, std::uint64_t j, PhotonEnergy& energy,
                         Visit&& visit) const {
    const auto choice = emission_.choose(j, pass.count, uint64_to_double(mix64(pass.key)));
    const Light& light = scene_.lights()[choice.light];
    PhotonNumbers numbers(hash_combine(pass.key, choice.light), choice.index);
    const Vector2 u_position = numbers.next_2d();
    const Vector2 u_start = numbers.next_2d();
    const auto emitted = light.emitter->sample_emission(light, u_position, u_start);
    if (!emitted) return;
    Flight flight{.ray = emitted->ray, .power = emitted->power / static_cast<float>(choice.pmf)};
    if (!is_finite(flight.power)) {
        throw Error(fmt::format("light number {} of the scene emits photons of infinite power",
                                choice.light));
    }
    if (is_black(flight.power)) return;
    energy.emitted += static_cast<double>(luminance(flight.power));

    for (int depth = 1; depth <= pass.max_depth; ++depth) {
        const auto before = static_cast<double>(luminance(flight.power));
        const std::optional<Interaction> at = scene_.intersect(flight.ray);
        if (!at) {
            energy.escaped += before;
            return;
        }
        if (includes(pass.kinds, flight.kind)) {
            visit(PhotonHit{.at = *at,
                            .w = -flight.ray.d,
                            .power = flight.power,
                            .depth = depth,
                            .kind = flight.kind});
        }
        const Vector2 u_choice = numbers.next_2d();
        const Vector2 u_direction = numbers.next_2d();
        const bool goes_on =
            scatter(*at, u_choice, u_direction, most_survival(pass, depth), flight);
        const double after = goes_on ? static_cast<double>(luminance(flight.power)) : 0.0;
        energy.absorbed += before - after;
        // From the first diffuse surface on all is indirect: a pass for caustics ends there.
        const bool seen =
            flight.kind != PhotonKind::indirect || includes(pass.kinds, PhotonKind::indirect);
        if (!goes_on) return;
        if (depth == pass.max_depth || !seen) {
            energy.cut += after;
            return;
        }
    }
}

/// Lets the surface turn the flight, or ends it: false. Flux is scattered by the adjoint BSDF,
/// which shading normals make differ from f by the ratio of the cosines (Veach 1997, 5.3.2).
inline bool PhotonTracer::scatter(const Interaction& at, Vector2 u_choice, Vector2 u_direction,
                                  float most_survival, Flight& flight) const {
    const BSDF& bsdf = *at.shape->bsdf();
    const Vector3 wo = -flight.ray.d;
    const std::optional<BSDFSample> next =
        bsdf.sample(at, at.to_local(wo), u_choice.x, u_direction, TransportMode::importance);
    if (!next || is_black(next->weight)) return false;
    Color power = flight.power * next->weight;
    Vector3 wi = flight.ray.d;
    if (next->lobe != Lobe::null) {
        wi = at.to_world(next->wi);
        const float wi_n = glm::dot(wi, at.n), wo_n = glm::dot(wo, at.n);
        const float wi_ns = glm::dot(wi, at.shading.n), wo_ns = glm::dot(wo, at.shading.n);
        if (!(wi_n * wi_ns > 0 && wo_n * wo_ns > 0)) return false;
        power *= (wo_ns * wi_n) / (wo_n * wi_ns);
    }
    if (!is_finite(power)) {
        throw Error(
            fmt::format("a photon that is scattered at ({:g}, {:g}, {:g}) has a power that "
                        "is not finite",
                        at.p.x, at.p.y, at.p.z));
    }
    // Survival in proportion to what is left keeps the power of all photons alike.
    if (most_survival <= 1) {
        const float survival =
            std::min(max_component(power) / max_component(flight.power), most_survival);
        if (!(u_choice.y < survival)) return false;
        power /= survival;
    }
    const bool diffuse = !next->specular() && stores_photons(bsdf);
    if (flight.kind != PhotonKind::indirect) {
        flight.kind = diffuse ? PhotonKind::indirect : PhotonKind::caustic;
    }
    flight.power = power;
    flight.ray = at.spawn_ray(wi);
    return true;
}

/// The result of many photons, in their order whatever the number of threads.
struct StoredPhotons {
    std::vector<Photon> photons;
    PhotonEnergy energy;
    double emitted = 0;  ///< number of photons that left the lights
};

/// Traces a pass in parallel and appends its photons to `result`. Ends early if `interrupted`.
inline void store_photons(const PhotonTracer& tracer, const PhotonPass& pass,
                          const Workers& workers, const std::function<bool()>& interrupted,
                          StoredPhotons& result) {
    constexpr std::uint64_t chunk_size = 2048;
    constexpr std::uint64_t batch_size = 256;  // chunks: bounds what is held twice
    const std::uint64_t chunks = (pass.count + chunk_size - 1) / chunk_size;
    struct Chunk {
        std::vector<Photon> photons;
        PhotonEnergy energy;
    };
    for (std::uint64_t first = 0; first < chunks; first += batch_size) {
        std::vector<Chunk> batch(std::min(batch_size, chunks - first));
        workers.run(std::ssize(batch), [&](std::int64_t c) {
            if (interrupted()) return;
            Chunk& chunk = batch[static_cast<std::size_t>(c)];
            const std::uint64_t begin = (first + static_cast<std::uint64_t>(c)) * chunk_size;
            for (std::uint64_t j = begin; j < std::min(begin + chunk_size, pass.count); ++j) {
                tracer.trace(pass, j, chunk.energy, [&](const PhotonHit& hit) {
                    if (!stores_photons(*hit.at.shape->bsdf())) return;
                    const float side = glm::dot(hit.w, hit.at.n) < 0 ? -1.0f : 1.0f;
                    chunk.photons.emplace_back(hit.at.p, hit.power, hit.w, side * hit.at.n,
                                               hit.depth);
                    chunk.energy.stored += static_cast<double>(luminance(hit.power));
                });
            }
        });
        for (const Chunk& chunk : batch) {
            result.photons.insert(result.photons.end(), chunk.photons.begin(), chunk.photons.end());
            result.energy += chunk.energy;
        }
    }
    result.emitted += static_cast<double>(pass.count);
}

}  // namespace lucerna
