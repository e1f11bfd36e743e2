// SPDX-License-Identifier: Apache-2.0
/// The part of a camera path that photon mapping leaves to ray tracing: through mirrors, glass and
/// glossy surfaces, up to the first one that stores photons.
///
/// Each path of light is found in one way only. Between the camera and that surface it is traced,
/// as by `path`; from there to the light it belongs to the photons, or to light sampling.
#pragma once

#include "plugins/integrators/light_sampling.h"
#include "plugins/integrators/photon_tracing.h"

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

class CameraPathTracer {
public:
    struct Settings {
        int max_depth = 0;
        bool hide_emitters = false;  ///< from the camera, not from mirrors
        bool lights = true;          ///< false: returns only what is gathered
        std::uint32_t gather_dimensions =
            0;  ///< numbers that the callback takes, if not for lights
    };

    CameraPathTracer(const Scene& scene, const LightSampler& light_sampler,
                     const Settings& settings)
        : scene_(scene),
          light_sampler_(light_sampler),
          settings_(settings),
          dimensions_(bsdf_dimensions + light_dimensions(light_sampler) +
                      settings.gather_dimensions) {}

    /// Fills a camera sample. gather(at, wo, edges) returns the radiance that leaves `at`, which
    /// stores photons, towards `wo`, after so many edges; it may take numbers of the stream.
    template <typename Gather>
    void operator()(const Ray& ray, SampleStream& stream, PixelSample& result,
                    Gather&& gather) const;

private:
    struct Path {
        Ray ray;
        std::optional<Interaction> hit{};
        PathVertex vertex{};
        Color beta{1};
        float seen_through = 1;  ///< of what lies before the first vertex
        float eta2 = 1;  ///< undoes the scaling of radiance by refraction, for Russian roulette
        int edges = 1;   ///< from vertex to vertex: what is gone straight through is none
    };

    bool arrive(Path& path, PixelSample& result) const;

    static constexpr std::uint32_t camera_dimensions = 4;
    static constexpr std::uint32_t bsdf_dimensions = 4;  // direction, lobe and roulette

    const Scene& scene_;
    const LightSampler& light_sampler_;
    Settings settings_;
    std::uint32_t dimensions_;
};

/// Follows the ray to the next surface that scatters, adding what is emitted on the way; false if
/// there is none. Emitters that are hidden are none. After the last edge that is allowed, only
/// light that goes straight through counts.
inline bool CameraPathTracer::arrive(Path& path, PixelSample& result) const {
    const bool hidden = path.edges == 1 && settings_.hide_emitters;
    const bool show = settings_.lights && !hidden;
    const Vector3 d = path.ray.d;
    while ((path.hit = scene_.intersect(path.ray))) {
        const Interaction& at = *path.hit;
        if (show) {
            result.radiance +=
                path.beta * found_emission(scene_, light_sampler_, path.vertex, at, -d);
        }
        const bool unseen = hidden && at.shape->emitter();
        if (!unseen && path.edges < settings_.max_depth) return true;
        const Color through = unseen ? Color(1) : straight_transmittance(at, -d);
        if (is_black(through)) return false;
        path.beta *= through;
        path.seen_through *= luminance(through);
        path.ray = at.spawn_ray(d);
    }
    if (show) {
        result.radiance += path.beta * found_environment(scene_, light_sampler_, path.vertex, d);
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
    for (std::uint32_t step = 0; arrive(path, result); ++step) {
        const Interaction& at = *path.hit;
        const Vector3 wo = -path.ray.d;
        stream.jump_to(camera_dimensions + step * dimensions_);
        const Vector2 u_direction = stream.next_2d();
        const Vector2 u_lobe_and_roulette = stream.next_2d();
        const BSDF& bsdf = *at.shape->bsdf();
        const bool gathers = stores_photons(bsdf);
        if (gathers) {
            result.radiance += path.beta * gather(at, wo, path.edges);
            if (!any(bsdf.lobes() & delta_lobes)) return;
        } else if (settings_.lights) {
            result.radiance +=
                path.beta * sample_lights(scene_, light_sampler_, bsdf, at, wo, 1, 1, stream);
        }
        const std::optional<ScatteredRay> next =
            scatter(at, wo, u_lobe_and_roulette.x, u_direction);
        if (!next) return;
        const BSDFSample& sample = next->sample;
        if (gathers && !sample.specular()) return;  // has been gathered
        path.beta *= sample.weight;
        path.eta2 *= sqr(sample.eta);
        path.ray = next->ray;
        if (sample.lobe != Lobe::null) {
            path.vertex = {.receiver = at.receiver(wo, bsdf.sides()),
                           .pdf = sample.pdf,
                           .specular = sample.specular()};
            ++path.edges;
        }
        if (step + 1 >= 5) {
            const float survival = survival_probability(path.beta, path.eta2);
            if (!(u_lobe_and_roulette.y < survival)) return;
            path.beta /= survival;
        }
    }
}

}  // namespace lucerna
