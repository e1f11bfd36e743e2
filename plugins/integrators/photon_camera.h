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

class CameraWalk {
public:
    struct Settings {
        int max_depth = 0;
        bool hide_emitters = false;  ///< from the camera, not from mirrors
        bool lights = true;          ///< false: returns only what is gathered
        std::uint32_t gather_dimensions =
            0;  ///< numbers that the callback takes, if not for lights
    };

    CameraWalk(const Scene& scene, const LightSampler& light_sampler, const Settings& settings)
        : scene_(scene),
          light_sampler_(light_sampler),
          settings_(settings),
          dimensions_(bsdf_dimensions + light_dimensions(light_sampler) +
                      settings.gather_dimensions) {}

    /// Fills a camera sample. gather(at, wo, edges) returns the radiance that leaves `at`, which
    /// stores photons, towards `wo`, after so many edges; it may take numbers of the stream.
    template <typename Gather>
    void operator()(Ray ray, SampleStream& stream, PixelSample& result, Gather&& gather) const;

private:
    static constexpr std::uint32_t camera_dimensions = 4;
    static constexpr std::uint32_t bsdf_dimensions = 4;  // direction, lobe and roulette

    const Scene& scene_;
    const LightSampler& light_sampler_;
    Settings settings_;
    std::uint32_t dimensions_;
};

template <typename Gather>
void CameraWalk::operator()(Ray ray, SampleStream& stream, PixelSample& result,
                            Gather&& gather) const {
    PathVertex vertex;
    Color beta(1);
    float eta2 = 1;  // undoes the scaling of radiance by refraction, for Russian roulette
    for (int edges = 1; edges <= settings_.max_depth; ++edges) {
        const bool show = settings_.lights && (edges > 1 || !settings_.hide_emitters);
        const std::optional<Interaction> hit = scene_.intersect(ray);
        if (!hit) {
            if (show) {
                result.radiance += beta * found_environment(scene_, light_sampler_, vertex, ray.d);
            }
            if (edges == 1) result.alpha = show && !scene_.infinite_lights().empty() ? 1.0f : 0.0f;
            return;
        }
        const Interaction& at = *hit;
        const Vector3 wo = -ray.d;
        if (show) {
            result.radiance += beta * found_emission(scene_, light_sampler_, vertex, at, wo);
        }
        if (edges == settings_.max_depth) return;

        stream.jump_to(camera_dimensions + static_cast<std::uint32_t>(edges - 1) * dimensions_);
        const Vector2 u_direction = stream.next_2d();
        const Vector2 u_lobe_and_roulette = stream.next_2d();
        const BSDF& bsdf = *at.shape->bsdf();
        const bool gathers = stores_photons(bsdf);
        if (gathers) {
            result.radiance += beta * gather(at, wo, edges);
            if (!any(bsdf.lobes() & delta_lobes)) return;
        } else if (settings_.lights) {
            result.radiance +=
                beta * sample_lights(scene_, light_sampler_, bsdf, at, wo, 1, 1, stream);
        }
        const std::optional<ScatteredRay> next =
            scatter(at, wo, u_lobe_and_roulette.x, u_direction);
        if (!next) return;
        const BSDFSample& sample = next->sample;
        if (gathers && !sample.specular()) return;  // has been gathered
        beta *= sample.weight;
        eta2 *= sqr(sample.eta);
        vertex = {.receiver = at.receiver(wo, bsdf.sides()),
                  .pdf = sample.pdf,
                  .specular = sample.specular()};
        ray = next->ray;

        if (edges >= 5) {
            const float survival = survival_probability(beta, eta2);
            if (!(u_lobe_and_roulette.y < survival)) return;
            beta /= survival;
        }
    }
}

}  // namespace lucerna
