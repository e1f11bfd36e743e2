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

/// Joins `from.first` to `to.second`, a path to itself without a shadow ray.
inline Junction join(const Scene& scene, const ReusablePath& from, const ReusablePath& to) {
    const LitSurface& x = *from.first;
    const LitSurface& y = *to.second;
    const Vector3 d = y.at.p - x.at.p;
    const float distance2 = glm::dot(d, d);
    const Vector3 wi = d / std::sqrt(distance2);
    Junction result;
    const bool own = &from == &to;
    result.wo_local = own ? y.wo_local : y.at.to_local(-wi);
    const float geometry = std::abs(glm::dot(wi, y.at.n)) / distance2;
    if (own) {
        result.density = to.to_second.pdf * geometry;
        result.transfer = to.to_second.weight * result.density;
        return result;
    }
    const bool same_face = glm::dot(wi, y.receiver.n) < 0 && result.wo_local.z * y.wo_local.z > 0;
    const Vector3 wi_local = x.at.to_local(wi);
    if (!same_face || !same_side(x.at, wi, wi_local)) return result;
    const BSDFValue value = x.bsdf.evaluate(x.at, x.wo_local, wi_local, TransportMode::radiance);
    const float density = value.pdf * geometry;
    if (!is_usable_density(density)) return result;
    const LightSample target{.wi = wi,
                             .distance = std::sqrt(distance2),
                             .p = y.at.p,
                             .n = y.at.n,
                             .error = y.at.error,
                             .target = y.at.source};
    if (scene.occluded(x.receiver, target)) return result;
    result.density = density;
    result.transfer = value.f * (abs_cos_theta(wi_local) * geometry);
    return result;
}

/// All first vertices of the block from which the second vertex of path `j` is seen.
inline void join_block(const Scene& scene, std::span<const ReusablePath> block, std::size_t j,
                       std::vector<Junction>& junctions) {
    const ReusablePath& path = block[j];
    const LitSurface& y = *path.second;
    junctions.clear();
    Junction own = join(scene, path, path);
    const bool shared = is_usable_density(own.density);
    if (!shared) {
        own.transfer = path.to_second.weight;
        own.density = 1;
    }
    own.next_f_cosine = path.next_f_cosine;
    own.next_pdf = path.next_pdf;
    for (std::size_t k = 0; k < block.size(); ++k) {
        if (k == j) {
            own.path = j;
            junctions.push_back(own);
        } else if (shared && block[k].first) {
            Junction junction = join(scene, block[k], path);
            if (!(junction.density > 0)) continue;
            junction.path = k;
            if (path.next_pdf > 0) {
                const BSDFValue next = y.bsdf.evaluate(y.at, junction.wo_local, path.next_local,
                                                       TransportMode::radiance);
                junction.next_f_cosine = next.f * abs_cos_theta(path.next_local);
                junction.next_pdf = next.pdf;
            }
            junctions.push_back(junction);
        }
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
    std::vector<Junction> junctions;
    junctions.reserve(block.size());
    for (std::size_t j = 0; j < block.size(); ++j) {
        const ReusablePath& path = block[j];
        const bool goes_on = path.next_pdf > 0 && !is_black(path.next_radiance);
        if (!path.second || (path.lights.empty() && !goes_on)) continue;
        join_block(scene, block, j, junctions);
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
