// SPDX-License-Identifier: Apache-2.0
/// Where light sampling will take place: points on paths from the camera, traced before rendering.
#pragma once

#include "core/base/parallel.h"
#include "core/interfaces/sensor.h"
#include "core/math/sequences.h"
#include "core/plugin/plugin.h"
#include "core/scene/medium_tracking.h"
#include "core/scene/scatter.h"
#include "core/scene/scene.h"

#include <vector>

namespace lucerna {

struct PilotPaths {
    std::uint32_t count = 0;
    int bounces = 2;  ///< off surfaces that are not specular
    std::uint64_t seed = 0;

    /// No more than a scene needs: a path for two pixels, and bounces where lights are sampled.
    PilotPaths within(const Scene& scene) const {
        const Vector2i size = scene.sensor().film().size();
        const std::int64_t pixels = std::int64_t{size.x} * size.y;
        PilotPaths result = *this;
        result.bounces = std::min(bounces, scene.integrator().light_bounces());
        result.count = static_cast<std::uint32_t>(
            std::min<std::int64_t>(count, std::max<std::int64_t>(pixels / 2, 256)));
        return result;
    }
};

/// As the parameters `paths`, by default `count`, and `bounces` say.
inline PilotPaths pilot_paths(const Params& params, int count) {
    PilotPaths result;
    result.count = static_cast<std::uint32_t>(params.int32(
        "paths", count, {.min = 1, .max = 1 << 24},
        "most paths from the camera that find where lights are sampled; one for two pixels"));
    result.bounces =
        params.int32("bounces", 2, {.min = 0, .max = 16}, "after which those paths end");
    return result;
}

/// From where the camera looks.
inline Vector3 eye_of(const Scene& scene) {
    const Vector2 middle = 0.5f * Vector2(scene.sensor().film().size());
    return scene.sensor().sample_ray(middle, Vector2(0.5f)).o;
}

/// Where a path is scattered on its way through a medium, if it is.
inline std::optional<Receiver> pilot_collision(const MediumSegment& way, Rng& rng) {
    MediumPath path;
    const Vector2 u = rng.next_float2();
    if (!sample_collision(way, true, u, rng, path)) return {};
    return Receiver::in_medium(*way.medium, way.o, way.d, path.t);
}

/// Where it goes from there.
inline Vector3 pilot_direction(const Receiver& at, Vector3 wo, Rng& rng) {
    const float u_lobe = rng.next_float();
    const Vector2 u = rng.next_float2();
    return at.medium->phase().sample(at.p, wo, u_lobe, u).wi;
}

/// The vertices of one path at which lights are sampled. It starts anywhere in the whole image: a
/// crop must be a part of it to the bit.
inline std::vector<Receiver> pilot_path(const Scene& scene, const PilotPaths& pilots,
                                        std::uint32_t index) {
    constexpr int longest = 16;  // specular surfaces do not count
    std::vector<Receiver> result;
    Rng rng(pilots.seed, index);
    const Vector2 place = sobol_owen_2d(index, pilots.seed);
    const Vector2 u_lens = rng.next_float2();
    Ray ray = scene.sensor().sample_ray(place * Vector2(scene.sensor().film().size()), u_lens);
    const Medium* medium = scene.has_media() ? scene.sensor().medium() : nullptr;
    int bounces = 0;
    for (int edge = 0; edge < longest && bounces <= pilots.bounces; ++edge) {
        const std::optional<Interaction> at = scene.intersect(ray);
        if (medium) {
            const MediumSegment way{medium, ray.o, ray.d, at ? at->t : infinity};
            if (const auto point = pilot_collision(way, rng)) {
                result.push_back(*point);
                ray = {.o = point->p, .d = pilot_direction(*point, -ray.d, rng)};
                ++bounces;
                continue;
            }
        }
        if (!at) break;
        const Vector3 wo = -ray.d;
        const BSDF& bsdf = *at->shape->bsdf();
        if (any(bsdf.lobes() & smooth_lobes)) {
            result.push_back(at->receiver(wo, bsdf.sides()));
            if (scene.has_media()) result.back().medium = medium_beyond(*at, wo, medium);
        }
        const float u_lobe = rng.next_float();
        const Vector2 u = rng.next_float2();
        const std::optional<ScatteredRay> next = scatter(*at, wo, u_lobe, u);
        if (!next) break;
        if (!next->sample.specular()) ++bounces;
        ray = next->ray;
        if (scene.has_media()) medium = medium_beyond(*at, ray.d, medium);
    }
    return result;
}

/// All of them, in an order that does not depend on the threads.
inline std::vector<Receiver> pilot_receivers(const Scene& scene, const PilotPaths& pilots,
                                             const Workers& workers) {
    constexpr std::uint32_t chunk = 256;
    std::vector<std::vector<Receiver>> chunks((pilots.count + chunk - 1) / chunk);
    workers.run(static_cast<std::int64_t>(chunks.size()), [&](std::int64_t i) {
        std::vector<Receiver>& mine = chunks[static_cast<std::size_t>(i)];
        const auto first = static_cast<std::uint32_t>(i) * chunk;
        for (std::uint32_t k = first; k < std::min(first + chunk, pilots.count); ++k) {
            const std::vector<Receiver> path = pilot_path(scene, pilots, k);
            mine.insert(mine.end(), path.begin(), path.end());
        }
    });
    std::vector<Receiver> result;
    for (const std::vector<Receiver>& c : chunks) result.insert(result.end(), c.begin(), c.end());
    return result;
}

}  // namespace lucerna
