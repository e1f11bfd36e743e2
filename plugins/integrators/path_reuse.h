// SPDX-License-Identifier: Apache-2.0
/// Paths of neighbouring pixels, each used by all of them (Bekaert, Sbert and Halton 2002,
/// "Accelerating Path Tracing by Re-Using Paths").
///
/// Path k leaves its first vertex x_k, seen by the camera, for a second vertex y_k. From there it
/// collects what y_k reflects. A shadow ray joins y_j to each other x_k of the block, and the light
/// counts there, too. All first vertices could have chosen y, each with some density, so
/// that the balance heuristic weights the samples (Veach 1997, 9.2.2.1):
///
///     p_k(y) = pdf_k(x_k → y) |cos θ_y| / |x_k − y|²                [1/m²], 0 if y is hidden
///     L(x_i) ≈ Σ_j f_i |cos θ_i| |cos θ_y| / |x_i − y_j|² · L(y_j → x_i) / Σ_k p_k(y_j)
///
/// which is unbiased: hidden x_k, those that see the other side of y, and delta lobes take no part.
#pragma once

#include "plugins/integrators/block_edges.h"
#include "plugins/integrators/light_sampling.h"

#include <span>
#include <vector>

namespace lucerna {

/// Light that arrives at a second vertex from a light sample.
struct ReusedLight {
    explicit ReusedLight(const LightEstimate& it)
        : wi_local(it.wi_local),
          irradiance(it.sample.radiance * (abs_cos_theta(it.wi_local) / it.density)),
          density(it.density),
          delta(it.sample.delta),
          own(it.scattered) {}

    Vector3 wi_local{0};
    Color irradiance{0};  ///< L |cos θ| / density
    float density = 0;    ///< draws · pmf · pdf [1/sr]
    bool delta = false;
    BSDFValue own;  ///< of the path's own directions
};

/// What a path keeps for others: its first two vertices, and what arrives at the second.
struct ReusablePath {
    Interaction first_at, second_at;
    std::optional<LitSurface> first, second;  ///< empty: no path gets there
    BSDFSample to_second;                     ///< drawn at the first vertex; never a delta lobe
    std::vector<ReusedLight> lights;          ///< that are not blocked
    Vector3 next_local{0};      ///< direction in which the path leaves the second vertex
    Color next_f_cosine{0};     ///< f |cos θ| there [1/sr]
    float next_pdf = 0;         ///< [1/sr]; 0: by a delta lobe, or nowhere
    Color next_radiance{0};     ///< that arrives from there, but for emission
    Color* radiance = nullptr;  ///< of the camera sample
};

/// How a first vertex is joined to a second one.
struct Junction {
    Color transfer{0};       ///< f |cos θ_x| |cos θ_y| / d² [1/(sr m²)]
    float density = 0;       ///< [1/m²]; 0: not joined
    Vector3 wo_local;        ///< at the second vertex, to the first
    Color next_f_cosine{0};  ///< for the direction in which the path goes on
    float next_pdf = 0;      ///< of that direction [1/sr]
    std::size_t path = 0;    ///< of the block, whose first vertex it is
};

/// The edge that a path went itself; its density is 0 if others cannot go to its second vertex.
inline Junction own_junction(const ReusablePath& path, std::size_t index) {
    const LitSurface& y = *path.second;
    const Vector3 d = y.at.p - path.first->at.p;
    const float distance2 = glm::dot(d, d);
    const float density =
        path.to_second.pdf * std::abs(glm::dot(d / std::sqrt(distance2), y.at.n)) / distance2;
    Junction result;
    result.path = index;
    result.wo_local = y.wo_local;
    if (is_usable_density(density)) result.density = density;
    result.transfer = path.to_second.weight * result.density;
    result.next_f_cosine = path.next_f_cosine;
    result.next_pdf = path.next_pdf;
    return result;
}

/// Finds all first vertices of the block from which the second vertex of a path is seen.
class BlockJoiner {
public:
    BlockJoiner(const Scene& scene, std::span<const ReusablePath> block);

    /// Valid until the next call.
    std::span<const Junction> join_to(std::size_t j);

private:
    void join(std::size_t group, std::size_t j);

    const Scene& scene_;
    std::span<const ReusablePath> block_;
    std::vector<FirstVertices> groups_;
    Edges edges_;
    std::vector<Junction> junctions_;
};

inline BlockJoiner::BlockJoiner(const Scene& scene, std::span<const ReusablePath> block)
    : scene_(scene), block_(block), groups_((block.size() + lane_count - 1) / lane_count) {
    for (std::size_t k = 0; k < block.size(); ++k) {
        if (block[k].first) groups_[k / lane_count].set(k % lane_count, block[k].first->at);
    }
    junctions_.reserve(block.size());
}

inline std::span<const Junction> BlockJoiner::join_to(std::size_t j) {
    junctions_.clear();
    Junction own = own_junction(block_[j], j);
    const bool shared = own.density > 0;
    if (!shared) {
        own.transfer = block_[j].to_second.weight;
        own.density = 1;
    }
    junctions_.push_back(own);
    for (std::size_t group = 0; shared && group < groups_.size(); ++group) join(group, j);
    return junctions_;
}

/// What the second vertex of `path` does with the light of the direction in which the path goes on.
inline void scatter_next(const ReusablePath& path, Junction& junction) {
    const LitSurface& y = *path.second;
    const BSDFValue next =
        y.bsdf.evaluate(y.at, junction.wo_local, path.next_local, TransportMode::radiance);
    junction.next_f_cosine = next.f * abs_cos_theta(path.next_local);
    junction.next_pdf = next.pdf;
}

inline void BlockJoiner::join(std::size_t group, std::size_t j) {
    const ReusablePath& path = block_[j];
    find_edges(groups_[group], *path.second, edges_);
    ShadowPacket& rays = edges_.rays;
    if (group == j / lane_count) rays.open[j % lane_count] = false;
    BSDFValue values[lane_count];
    for (std::size_t i = 0; i < lane_count; ++i) {
        if (!rays.open[i]) continue;
        const LitSurface& x = *block_[group * lane_count + i].first;
        values[i] = x.bsdf.evaluate(x.at, x.wo_local, edges_.wi_local[i], TransportMode::radiance);
        rays.open[i] = is_usable_density(values[i].pdf * edges_.geometry[i]);
    }
    scene_.occluded(rays);
    for (std::size_t i = 0; i < lane_count; ++i) {
        if (!rays.open[i]) continue;
        Junction& junction = junctions_.emplace_back();
        const float geometry = edges_.geometry[i];
        junction.path = group * lane_count + i;
        junction.wo_local = edges_.wo_local[i];
        junction.density = values[i].pdf * geometry;
        junction.transfer = values[i].f * (std::abs(edges_.wi_local.z[i]) * geometry);
        if (path.next_pdf > 0) scatter_next(path, junction);
    }
}

/// Light of the light samples that the second vertex of a path reflects to a first one.
inline Color reflected_lights(const ReusablePath& path, const Junction& junction, bool own) {
    const LitSurface& y = *path.second;
    Color sum(0);
    for (const ReusedLight& light : path.lights) {
        const BSDFValue value =
            own ? light.own
                : y.bsdf.evaluate(y.at, junction.wo_local, light.wi_local, TransportMode::radiance);
        const float weight = light.delta ? 1 : power_heuristic(light.density, value.pdf);
        sum += value.f * light.irradiance * weight;
    }
    return sum;
}

/// Adds to all samples of a block what their paths find behind the second vertices.
inline void reuse_paths(const Scene& scene, std::span<const ReusablePath> block) {
    BlockJoiner joiner(scene, block);
    for (std::size_t j = 0; j < block.size(); ++j) {
        const ReusablePath& path = block[j];
        const bool goes_on = path.next_pdf > 0 && !is_black(path.next_radiance);
        if (!path.second || (path.lights.empty() && !goes_on)) continue;
        const std::span<const Junction> junctions = joiner.join_to(j);
        float density = 0, next_density = 0;
        for (const Junction& junction : junctions) {
            density += junction.density;
            next_density += junction.density * junction.next_pdf;
        }
        for (const Junction& junction : junctions) {
            Color sum = reflected_lights(path, junction, junction.path == j) / density;
            if (goes_on && next_density > 0) {
                sum += junction.next_f_cosine * path.next_radiance / next_density;
            }
            *block[junction.path].radiance += junction.transfer * sum;
        }
    }
}

}  // namespace lucerna
