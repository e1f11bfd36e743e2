// SPDX-License-Identifier: Apache-2.0
/// The part of a camera path that photon mapping leaves to ray tracing: through media, mirrors,
/// glass and glossy surfaces, up to the first one that stores photons.
///
/// Each path of light is found in one way only. Between the camera and that surface it is traced,
/// as by `path`; from there to the light it belongs to the photons, or to light sampling.
#pragma once

#include "plugins/integrators/photon_media.h"
#include "plugins/integrators/photon_storing.h"

namespace lucerna {

/// Edges of the longest path, where a scene says "unlimited".
inline constexpr int unlimited_depth = 1 << 20;

/// What photon integrators have in common with `path`.
struct PathLimits {
    explicit PathLimits(const Params& params)
        : max_depth(params.int32("max_depth", -1, {.min = -1},
                                 "longest path in edges, photon and camera together: 1 shows only "
                                 "emitters, 2 direct light; -1 is unlimited")),
          rr_depth(params.int32("rr_depth", 1, {.min = 1},
                                "edges before Russian roulette may end the path of a photon")) {
        if (max_depth < 0) max_depth = unlimited_depth;
    }

    int max_depth, rr_depth;
};

/// How many lights are sampled at a vertex of a camera path.
inline std::uint32_t emitter_samples(const Params& params) {
    return static_cast<std::uint32_t>(
        params.int32("emitter_samples", 1, {.min = 1, .max = most_light_samples},
                     "samples of lights at each point that the camera sees"));
}

/// Where light is gathered on a path from the camera.
struct GatherPoint {
    const Interaction& at;  ///< stores photons
    Vector3 wo;
    int edges;                  ///< of the path
    const Medium* medium;       ///< through which it has come
    std::optional<Rng>& rng;    ///< for media; empty if the scene has none
    LightDistribution& lights;  ///< filled by light sampling
    float bsdf_samples = 0;     ///< rays of the BSDF that look for direct light, too
};

/// Direct light at a surface towards wo by light sampling, weighted against rays of the BSDF.
inline Color sample_lights(const Scene& scene, const LightSampler& sampler,
                           std::uint32_t light_samples, const GatherPoint& point,
                           SampleStream& stream) {
    const BSDF& bsdf = *point.at.shape->bsdf();
    const float bsdf_samples = point.bsdf_samples;
    if (!point.rng) {
        return sample_lights(scene, sampler, bsdf, point.at, point.wo, light_samples, bsdf_samples,
                             stream, point.lights);
    }
    const LitSurface surface(point.at, bsdf, point.wo);
    if (!surface.samples_lights) return Color(0);
    point.lights = sampler.at(surface.receiver);
    return sample_lights(scene, point.lights, SurfaceInMedium{surface, point.medium},
                         {light_samples, light_samples}, bsdf_samples, *point.rng,
                         [&] { return stream.next_2d(); });
}

class CameraPathTracer {
public:
    struct Settings {
        int max_depth = 0;
        bool hide_emitters = false;       ///< from the camera, not from mirrors
        bool lights = true;               ///< false: returns only what is gathered
        bool direct_light = true;         ///< the callback samples lights
        std::uint32_t light_samples = 1;  ///< at a vertex
        std::uint32_t gather_dimensions =
            0;                              ///< numbers that the callback takes, if not for lights
        const MediumView* media = nullptr;  ///< if the scene has any
    };

    CameraPathTracer(const Scene& scene, const LightSampler& light_sampler,
                     const Settings& settings)
        : scene_(scene),
          light_sampler_(light_sampler),
          settings_(settings),
          environment_(has_environment(scene)),
          dimensions_(bsdf_dimensions + settings.light_samples * light_dimensions +
                      settings.gather_dimensions + (settings.media ? medium_dimensions : 0)) {}

    /// Fills a camera sample. gather(GatherPoint) returns the radiance that leaves the point, which
    /// stores photons, towards `wo`; it may take numbers of the stream.
    template <typename Gather>
    void operator()(const Ray& ray, SampleStream& stream, PixelSample& result,
                    Gather&& gather) const;

private:
    struct Path {
        Ray ray;
        std::optional<Interaction> hit{};
        PathVertex vertex{};         ///< the last one
        LightDistribution lights{};  ///< at the surface, where lights were sampled
        Color beta{1};
        float seen_through = 1;  ///< of what lies before the first vertex
        float eta2 = 1;  ///< undoes the scaling of radiance by refraction, for Russian roulette
        int edges = 1;   ///< from vertex to vertex: what is gone straight through is none
        bool gathered = false;  ///< looks for direct light only, and media emit none
        // In scenes with media alone:
        const Medium* medium = nullptr;  ///< in which the ray starts
        std::optional<Rng> rng{};
        Vector2 u_line{0};  ///< where light is sampled
    };

    void draw_numbers(Path& path, SampleStream& stream) const;
    bool looks_for_light(const BSDF& bsdf) const;
    bool cross_medium(Path& path, PixelSample& result) const;
    bool arrive(Path& path, PixelSample& result) const;

    static constexpr std::uint32_t camera_dimensions = 4;
    static constexpr std::uint32_t bsdf_dimensions = 4;    // direction, lobe and roulette
    static constexpr std::uint32_t medium_dimensions = 4;  // place of direct light and seed

    const Scene& scene_;
    const LightSampler& light_sampler_;
    Settings settings_;
    bool environment_;
    std::uint32_t dimensions_;
};

/// Whether a surface that stores photons looks for direct light by a ray of its BSDF, too. A matte
/// one finds most of a sky so, but not lamps, and a glossy one finds the reflections of lamps.
inline bool CameraPathTracer::looks_for_light(const BSDF& bsdf) const {
    constexpr Lobe glossy = Lobe::glossy_reflection | Lobe::glossy_transmission;
    return settings_.lights && settings_.direct_light &&
           (environment_ || any(bsdf.lobes() & glossy));
}

/// Of a step, for media.
inline void CameraPathTracer::draw_numbers(Path& path, SampleStream& stream) const {
    path.u_line = stream.next_2d();
    path.rng.emplace(seeded_by(stream.next_2d()));
}

/// Adds what the medium sends along the ray; false if it lets nothing through.
inline bool CameraPathTracer::cross_medium(Path& path, PixelSample& result) const {
    const MediumSegment way{path.medium, path.ray.o, path.ray.d, path.hit ? path.hit->t : infinity};
    const MediumPath through =
        settings_.media->cross(way, path.beta, path.edges, path.u_line, *path.rng);
    if (!path.gathered) result.radiance += through.radiance;
    if (path.edges == 1) path.seen_through *= luminance(through.beta) / luminance(path.beta);
    path.beta = through.beta;
    path.u_line = path.rng->next_float2();  // for what comes behind a surface that is no vertex
    return !is_black(path.beta);
}

/// Follows the ray to the next surface that scatters, adding what is emitted on the way; false if
/// there is none. Emitters that are hidden are none. After the last edge that is allowed, only
/// light that goes straight through counts.
inline bool CameraPathTracer::arrive(Path& path, PixelSample& result) const {
    const bool hidden = path.edges == 1 && settings_.hide_emitters;
    const bool show = settings_.lights && !hidden;
    const Vector3 d = path.ray.d;
    while (true) {
        path.hit = scene_.intersect(path.ray);
        if (path.medium && !cross_medium(path, result)) return false;
        if (!path.hit) break;
        const Interaction& at = *path.hit;
        if (show) {
            result.radiance += path.beta * found_emission(scene_, path.vertex, at, -d);
        }
        const bool unseen = hidden && at.shape->emitter();
        if (!unseen && path.edges < settings_.max_depth) return true;
        const Color through = unseen ? Color(1) : straight_transmittance(at, -d);
        if (is_black(through)) return false;
        path.beta *= through;
        path.seen_through *= luminance(through);
        path.ray = at.spawn_ray(d);
        if (settings_.media) path.medium = medium_beyond(at, d, path.medium);
    }
    if (show) {
        result.radiance += path.beta * found_environment(scene_, path.vertex, d);
    }
    if (path.edges == 1) {
        const bool sky = show && !scene_.infinite_lights().empty();
        result.alpha = sky ? 1.0f : 1 - path.seen_through;
    }
    return false;
}

template <typename Gather>
void CameraPathTracer::operator()(const Ray& ray, SampleStream& stream, PixelSample& result,
                                  Gather&& gather) const {
    if (settings_.max_depth == 0) return;
    Path path{.ray = ray};
    if (settings_.media) path.medium = scene_.sensor().medium();
    for (std::uint32_t step = 0;; ++step) {
        stream.jump_to(camera_dimensions + step * dimensions_);
        if (settings_.media) draw_numbers(path, stream);
        if (!arrive(path, result)) return;
        const Interaction& at = *path.hit;
        const Vector3 wo = -path.ray.d;
        const Vector2 u_direction = stream.next_2d();
        const Vector2 u_lobe_and_roulette = stream.next_2d();
        const BSDF& bsdf = *at.shape->bsdf();
        const bool gathers = stores_photons(bsdf);
        const bool looks = !gathers || looks_for_light(bsdf);
        const GatherPoint point{at,       wo,          path.edges,         path.medium,
                                path.rng, path.lights, looks ? 1.0f : 0.0f};
        if (gathers) {
            result.radiance += path.beta * gather(point);
            if (!any(bsdf.lobes() & delta_lobes) && !looks) return;
        } else if (settings_.lights) {
            result.radiance += path.beta * sample_lights(scene_, light_sampler_,
                                                         settings_.light_samples, point, stream);
        }
        const std::optional<ScatteredRay> next =
            scatter(at, wo, u_lobe_and_roulette.x, u_direction);
        if (!next) return;
        const BSDFSample& sample = next->sample;
        const bool has_been_gathered = gathers && !sample.specular();
        if (has_been_gathered && !looks) return;
        path.beta *= sample.weight;
        path.eta2 *= sqr(sample.eta);
        path.ray = next->ray;
        if (settings_.media) path.medium = medium_beyond(at, path.ray.d, path.medium);
        if (sample.lobe != Lobe::null) {
            path.vertex = {.receiver = at.receiver(wo, bsdf.sides()),
                           .lights = path.lights,
                           .pdf = sample.pdf,
                           .light_samples = static_cast<float>(settings_.light_samples),
                           .specular = sample.specular()};
            ++path.edges;
        }
        if (has_been_gathered) {
            path.edges = settings_.max_depth;  // but for direct light
            path.gathered = true;
            arrive(path, result);
            return;
        }
        if (step + 1 >= 5) {
            const float survival = survival_probability(path.beta, path.eta2);
            if (!(u_lobe_and_roulette.y < survival)) return;
            path.beta /= survival;
        }
    }
}

}  // namespace lucerna
