// SPDX-License-Identifier: Apache-2.0
/// Light from an environment that reaches a vertex through specular surfaces, as window panes.
///
/// A shadow ray towards the environment that meets a specular surface is not given up: its
/// direction goes on as a path through the chain of specular surfaces. So there are two strategies
/// for a direction that enters a chain, light sampling and sampling of the BSDF, and they are
/// weighted as without the chain (Veach 1997, 9.2), by their densities of the direction at the
/// vertex. These tell nothing about where the chain ends, and need not: for each direction the
/// weights sum to one, whatever arrives from it. A pane does not change directions, so light
/// sampling is as good behind it as in front of it; behind thick glass it is less so.
#pragma once

#include "core/math/sequences.h"
#include "plugins/integrators/light_sampling.h"

#include <algorithm>
#include <bit>
#include <optional>

namespace lucerna {

/// Longest chain that is worth following [vertices]: two panes.
inline constexpr int usual_chain = 4;

/// The only emitter at infinity that rays can meet; empty if there is none or several, whose
/// densities would have to be added.
inline std::optional<std::uint32_t> only_environment(const Scene& scene) {
    std::optional<std::uint32_t> found;
    for (const std::uint32_t first : scene.infinite_lights()) {
        if (scene.lights()[first].emitter->delta()) continue;
        if (found) return {};
        found = first;
    }
    return found;
}

/// Whether there is light that may come through chains.
inline bool may_light_chains(const Scene& scene) {
    return scene.has_specular_surfaces() && only_environment(scene).has_value();
}

inline bool links_chain(const Interaction& at) { return only_specular(at.shape->bsdf()->lobes()); }

/// How many specular vertices a path has passed since a vertex with light sampling, if what it
/// finds behind them could have been found by a light sample, too.
class SpecularChain {
public:
    /// Light samples follow chains of up to `longest` vertices.
    explicit SpecularChain(int longest) : longest_(longest) {}

    int longest() const { return longest_; }
    int vertices() const { return std::max(vertices_, 0); }
    /// The weight of what the path finds now.
    float weight() const { return vertices_ > 0 ? weight_ : 1; }

    /// The path leaves a vertex with light sampling, in a direction of its BSDF.
    void begin() { vertices_ = 0; }
    /// From here on, light samples cannot come along.
    void end() { vertices_ = none; }
    /// The path has gone from `before` in direction `d` to the specular vertex `at`, or from
    /// another link of the chain, and goes on.
    void pass(const Scene& scene, const PathVertex& before, Vector3 d, const Interaction& at) {
        if (vertices_ == none || vertices_ >= longest_ || !links_chain(at)) return end();
        if (vertices_ == 0) weight_ = bsdf_weight(scene, before, d);
        ++vertices_;
    }

private:
    static constexpr int none = -1;

    static float bsdf_weight(const Scene& scene, const PathVertex& before, Vector3 d) {
        const std::uint32_t index = scene.light_along(*only_environment(scene), d);
        const Light& light = scene.lights()[index];
        const float density =
            before.lights.pmf(index) * light.emitter->pdf_li(light, before.receiver, d, nullptr);
        return power_heuristic(before.pdf, before.light_samples * density);
    }

    int longest_;
    int vertices_ = none;
    float weight_ = 1;
};

/// Radiance that arrives along a ray from the end of a chain of at most `longest` vertices: an
/// unbiased estimate. Black if the ray does not begin with a chain.
inline Color radiance_through_chain(const Scene& scene, Ray ray, int longest) {
    const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x)}; };
    Rng rng(hash64({bits(ray.o.x), bits(ray.o.y), bits(ray.o.z)}),
            hash64({bits(ray.d.x), bits(ray.d.y), bits(ray.d.z)}));
    Color beta(1), sum(0);
    for (int vertices = 0;; ++vertices) {
        const std::optional<Interaction> at = scene.intersect(ray);
        if (vertices > 0 && !at) sum += beta * scene.environment(ray.d);
        if (vertices > 0 && at && at->shape->emitter()) {
            sum += beta * at->shape->emitter()->radiance(*at, -ray.d);
        }
        if (!at || vertices == longest || !links_chain(*at)) return sum;
        const float u_lobe = rng.next_float();
        const std::optional<ScatteredRay> next = scatter(*at, -ray.d, u_lobe, rng.next_float2());
        if (!next) return sum;
        beta *= next->sample.weight;
        ray = next->ray;
    }
}

}  // namespace lucerna
