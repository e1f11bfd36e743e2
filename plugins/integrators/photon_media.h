// SPDX-License-Identifier: Apache-2.0
/// What is seen of media along a ray by photon mapping.
///
/// Each path of light is found in one way only, as on surfaces (photon_camera.h): a medium is a
/// place where photons are stored. What it scatters towards the viewer is direct light (L M), by
/// light sampling at one point of the ray, or a caustic or indirect light, by the beam radiance
/// estimate.
#pragma once

#include "plugins/integrators/medium_lighting.h"
#include "plugins/integrators/photon_beam.h"

#include <fmt/format.h>

#include <cstdio>

namespace lucerna {

/// Paths are not scattered by media, but go on to the next surface.
class MediumView {
public:
    struct Settings {
        int max_depth = 0;         ///< edges of the longest path, of photon and camera together
        PhotonLookup lookup = {};  ///< but for max_depth
        bool emission = true;      ///< what media emit is seen
        bool direct = true;        ///< direct light is sampled; false: it is in the maps
    };

    MediumView(const Scene& scene, const LightSampler& light_sampler, const Settings& settings)
        : scene_(scene), light_sampler_(light_sampler), settings_(settings) {}

    /// Its photons are seen, too. Must stay where it is.
    void add(const BeamMap& map) {
        if (!map.empty()) maps_.push_back(&map);
    }

    /// Takes a path of throughput `beta` to the end of the segment, which is edge number `edges` of
    /// it. u_line in [0, 1)² chooses where light is sampled.
    MediumPath cross(const MediumSegment& way, Color beta, int edges, Vector2 u_line,
                     Rng& rng) const;

private:
    Color direct_light(const MediumSegment& way, Color beta, Vector2 u_line, Rng& rng) const;
    Color direct_light(const MediumSegment& way, float t, Rng& rng) const;

    const Scene& scene_;
    const LightSampler& light_sampler_;
    Settings settings_;
    std::vector<const BeamMap*> maps_;
};

inline MediumPath MediumView::cross(const MediumSegment& way, Color beta, int edges, Vector2 u_line,
                                    Rng& rng) const {
    MediumPath path{.beta = beta};
    sample_collision(way, false, Vector2(0), rng, path);
    if (!settings_.emission) path.radiance = Color(0);
    if (edges >= settings_.max_depth || !way.medium->may_scatter()) return path;
    if (settings_.direct) path.radiance += direct_light(way, beta, u_line, rng);
    if (maps_.empty()) return path;
    PhotonLookup lookup = settings_.lookup;
    lookup.max_depth = settings_.max_depth - edges;
    const TransmittanceAlong arriving(way, rng);
    for (const BeamMap* map : maps_) {
        path.radiance += beta * beam_radiance(*map, lookup, way, arriving);
    }
    return path;
}

/// At a point that the medium chooses by chance, or that is near a light if the medium is
/// homogeneous.
inline Color MediumView::direct_light(const MediumSegment& way, Color beta, Vector2 u_line,
                                      Rng& rng) const {
    if (scene_.lights().empty()) return Color(0);
    if (!way.medium->homogeneous()) {
        MediumPath collided{.beta = beta};
        const bool scattered = sample_collision(way, true, u_line, rng, collided);
        return scattered ? collided.beta * direct_light(way, collided.t, rng) : Color(0);
    }
    LineScattering line(way, beta);
    if (!line.scatters()) return Color(0);
    aim_at_light(scene_, light_sampler_, way, rng, line);
    const float t = line.sample(u_line.x, static_cast<double>(u_line.y));
    const Color throughput = line.throughput_alone(t);
    if (is_black(throughput) || !is_finite(throughput)) return Color(0);
    return throughput * direct_light(way, t, rng);
}

inline Color MediumView::direct_light(const MediumSegment& way, float t, Rng& rng) const {
    const LitPoint point{.receiver = Receiver::in_medium(*way.medium, way.o, way.d, t),
                         .phase = way.medium->phase(),
                         .wo = -way.d};
    return sample_lights(scene_, light_sampler_.at(point.receiver), point, {1, 1}, 0, rng,
                         [&] { return rng.next_float2(); });
}

/// Whether photons can be scattered by a medium that the integrator renders.
inline bool has_scattering_media(const Scene& scene) {
    const auto scatters = [](const Medium* medium) { return medium->may_scatter(); };
    return scene.has_media() && std::any_of(scene.media().begin(), scene.media().end(), scatters);
}

/// Where photons can be scattered by media: around all shapes that have them inside; around the
/// whole scene if a medium is outside of a shape or around the camera, too.
inline Bounds3 media_bounds(const Scene& scene) {
    const auto scatters = [](const Medium* medium) { return medium && medium->may_scatter(); };
    Bounds3 bounds;
    bool enclosed = !scatters(scene.sensor().medium());
    for (const Shape* shape : scene.shapes()) {
        enclosed &= !scatters(shape->media().exterior);
        if (scatters(shape->media().interior)) bounds.include(shape->bounds());
    }
    return enclosed ? bounds : scene.bounds();
}

/// Media are no lights: nothing leaves them as a photon.
inline void warn_of_emission(const Scene& scene, const char* integrator) {
    const auto emits = [](const Medium* medium) { return medium->emits(); };
    if (!scene.has_media() || std::none_of(scene.media().begin(), scene.media().end(), emits)) {
        return;
    }
    fmt::print(stderr,
               "warning: {}: what media emit is seen, but lights nothing; \"volpath\" "
               "renders their light\n",
               integrator);
}

}  // namespace lucerna
