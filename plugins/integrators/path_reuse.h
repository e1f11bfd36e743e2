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
///
/// Vertices may be in a medium, or see each other through one that is homogeneous. f is then the
/// phase function, and there is no cosine; where y is in a medium, densities are per volume, and
/// scattering [1/m] is a factor of what it reflects. The transmittance is another, and p_k has the
/// probability to get to y, or the density to collide there (medium_tracking.h). x_k behind another
/// medium take no part.
#pragma once

#include "core/base/vectorized.h"
#include "core/math/select.h"
#include "plugins/integrators/block_edges.h"
#include "plugins/integrators/light_sampling.h"

#include <span>
#include <vector>

namespace lucerna {

/// Light that arrives at a second vertex from a light sample.
struct ReusedLight {
    /// `cosine`: that of ReusableVertex.
    ReusedLight(const LightEstimate& it, float cosine)
        : wi_local(it.wi_local),
          irradiance(it.sample.radiance * (cosine * it.weight)),
          density(it.density),
          delta(it.sample.delta),
          own(it.scattered) {}

    Vector3 wi_local{0};
    Color irradiance{0};  ///< L |cos θ| times the weight of the sample
    float density = 0;    ///< samples · pmf · pdf [1/sr]
    bool delta = false;
    BSDFValue own;  ///< of the path's own directions
};

/// How a path gets from its first vertex to the second.
struct FirstEdge {
    Color weight{0};  ///< what it multiplies the throughput by
    float pdf = 0;    ///< of its direction [1/sr]
    float reach = 1;  ///< probability to get to a surface, or density to collide in a medium [1/m]
};

/// What a path keeps for others: its first two vertices, and what arrives at the second.
struct ReusablePath {
    ReusableVertex first, second;
    Color beta{1};                    ///< throughput up to the first vertex
    FirstEdge to_second;              ///< never by a delta lobe
    std::vector<ReusedLight> lights;  ///< that are not blocked
    Vector3 next_local{0};            ///< direction in which the path leaves the second vertex
    Color next_f_cosine{0};           ///< f |cos θ| there [1/sr]
    float next_pdf = 0;               ///< [1/sr]; 0: by a delta lobe, or nowhere
    Color next_radiance{0};           ///< that arrives from there, but for emission
    Color* radiance = nullptr;        ///< of the camera sample

    /// Something is reflected at the second vertex.
    bool goes_on() const { return next_pdf > 0 && !is_black(next_radiance); }
    bool shines() const { return second.is_set() && (!lights.empty() || goes_on()); }
};

/// Values at the second vertex of a path, whose lights and next direction are the same for all.
class SecondVertex {
public:
    explicit SecondVertex(const ReusableVertex& y) : y_(y) { points_.fill(&y.at); }

    /// For light from `wi` towards each `wo` (local), in the lanes that are wanted.
    void evaluate(const LaneMask& wanted, const Vector3Lanes& wo, Vector3 wi,
                  BSDFValueLanes& out) const {
        Vector3Lanes same;
        for (std::size_t i = 0; i < lane_count; ++i) same.set(i, wi);
        if (y_.bsdf) {
            return y_.bsdf->batch().evaluate(*y_.bsdf, points_, wanted, wo, same,
                                             TransportMode::radiance, out);
        }
        Vector3Lanes p;
        for (std::size_t i = 0; i < lane_count; ++i) p.set(i, y_.at.p);
        y_.phase->batch().evaluate(*y_.phase, p, wanted, wo, same, out);
    }

private:
    const ReusableVertex& y_;
    std::array<const Interaction*, lane_count> points_;
};

/// How sixteen first vertices are joined to one second vertex.
struct Junctions {
    LaneMask joined{};
    Vector3Lanes transfer{};  ///< f |cos θ_x| |cos θ_y| / d² [1/(sr m²)]
    FloatLanes density{};     ///< [1/m²]; 0: not joined
    Vector3Lanes wo_local{};  ///< at the second vertex, to the first
    BSDFValueLanes next{};    ///< there, for the direction in which the path goes on; f |cos θ|

    /// `values`: of the BSDFs at the first vertices.
    LUCERNA_VECTORIZED_INLINE void set_transfer(const BSDFValueLanes& values, const Edges& edges) {
        for (std::size_t i = 0; i < lane_count; ++i) {
            const float geometry = edges.geometry[i];
            const float factor = edges.cosine[i] * geometry;
            // Paths whose throughput is black end before they get to y.
            const float brightest = std::max(values.f.x[i], std::max(values.f.y[i], values.f.z[i]));
            density[i] = select(brightest > 0, values.pdf[i] * geometry, 0.0f);
            transfer.set(i, values.f[i] * factor);
            wo_local.set(i, edges.wo_local[i]);
        }
    }
    void keep_joined(const LaneMask& open) {
        joined = open;
        for (std::size_t i = 0; i < lane_count; ++i) density[i] = open[i] ? density[i] : 0.0f;
    }
};

/// Light that a second vertex reflects to sixteen first ones, divided by the densities.
struct ReflectedLanes {
    Vector3Lanes radiance{};

    /// `values`: of the BSDF there for the light's direction. Weighted by the power heuristic.
    LUCERNA_VECTORIZED_INLINE void add(const ReusedLight& light, const BSDFValueLanes& values,
                                       float density) {
        const Color irradiance = light.irradiance / density;
        const float light_pdf = light.density, bsdf_counts = light.delta ? 0.0f : 1.0f;
        for (std::size_t i = 0; i < lane_count; ++i) {
            const float pdf = values.pdf[i] * bsdf_counts;
            const float ratio = std::min(light_pdf, pdf) / std::max(light_pdf, pdf);
            const float lesser = ratio * ratio / (1 + ratio * ratio);
            const float weight = light_pdf > pdf ? 1 - lesser : lesser;
            radiance.set(i, radiance[i] + values.f[i] * irradiance * weight);
        }
    }

    LUCERNA_VECTORIZED_INLINE void add_next(const BSDFValueLanes& f_cosine, Color arriving,
                                            float density) {
        const Color each = arriving / density;
        for (std::size_t i = 0; i < lane_count; ++i) {
            radiance.set(i, radiance[i] + f_cosine.f[i] * each);
        }
    }
};

/// The paths of one block.
class PathBlock {
public:
    /// `heeds_media`: not if the integrator takes scenes as if they had none.
    PathBlock(const Scene& scene, std::span<const ReusablePath> paths, bool heeds_media);

    /// Counts what path `j` finds behind its second vertex for all of the block.
    void share(std::size_t j);
    /// Adds what all have found to the samples.
    void finish() const;

private:
    /// Sixteen paths.
    struct Group {
        FirstVertices vertices;
        Junctions junctions;
        Vector3Lanes radiance{};
    };

    void join(Group& group, std::size_t j);
    void cross_media(Group& group, const ReusableVertex& y);
    void set_own(Junctions& junctions, const ReusablePath& path, std::size_t lane, float density);
    void collect(Group& group, std::size_t j, float density, float next_density);

    const Scene& scene_;
    std::span<const ReusablePath> paths_;
    bool heeds_media_;
    std::vector<Group> groups_;
    Edges edges_{};
    BSDFValueLanes values_{};
};

inline PathBlock::PathBlock(const Scene& scene, std::span<const ReusablePath> paths,
                            bool heeds_media)
    : scene_(scene),
      paths_(paths),
      heeds_media_(heeds_media),
      groups_((paths.size() + lane_count - 1) / lane_count) {
    for (std::size_t k = 0; k < paths.size(); ++k) {
        if (paths[k].first.is_set())
            groups_[k / lane_count].vertices.set(k % lane_count, paths[k].first);
    }
}

/// Density of the second vertex [1/m²], in a medium [1/m³]; 0 if others cannot go there.
inline float own_density(const ReusablePath& path) {
    const ReusableVertex& y = path.second;
    const Vector3 d = y.at.p - path.first.at.p;
    const float distance2 = glm::dot(d, d);
    const float cosine =
        y.in_medium() ? 1.0f : std::abs(glm::dot(d / std::sqrt(distance2), y.at.n));
    const float density = path.to_second.pdf * cosine / distance2 * path.to_second.reach;
    return is_usable_density(density) ? density : 0;
}

/// Adds what a path finds behind its second vertex to its own sample only.
inline void add_alone(const ReusablePath& path) {
    if (!path.shines()) return;
    Color sum(0);
    for (const ReusedLight& light : path.lights) {
        const float weight = light.delta ? 1 : power_heuristic(light.density, light.own.pdf);
        sum += light.own.f * light.irradiance * weight;
    }
    if (path.goes_on()) sum += path.next_f_cosine * path.next_radiance / path.next_pdf;
    *path.radiance += path.beta * path.to_second.weight * sum;
}

inline void PathBlock::share(std::size_t j) {
    const ReusablePath& path = paths_[j];
    if (!path.shines()) return;
    const float own = own_density(path);
    if (!(own > 0)) return add_alone(path);
    float density = 0, next_density = 0;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        Junctions& junctions = groups_[g].junctions;
        join(groups_[g], j);
        if (g == j / lane_count) set_own(junctions, path, j % lane_count, own);
        for (std::size_t i = 0; i < lane_count; ++i) {
            density += junctions.density[i];
            next_density += junctions.density[i] * junctions.next.pdf[i];
        }
    }
    for (Group& group : groups_) collect(group, j, density, next_density);
}

/// Finds the first vertices from which the second vertex of a path is seen, but for its own.
inline void PathBlock::join(Group& group, std::size_t j) {
    const ReusablePath& path = paths_[j];
    Junctions& junctions = group.junctions;
    find_edges(group.vertices, path.second, edges_);
    ShadowPacket& rays = edges_.rays;
    if (&group == &groups_[j / lane_count]) rays.open[j % lane_count] = false;
    group.vertices.evaluate(rays.open, edges_.wi_local, values_);
    junctions.set_transfer(values_, edges_);
    if (heeds_media_) cross_media(group, path.second);
    for (std::size_t i = 0; i < lane_count; ++i) {
        rays.open[i] &= is_usable_density(junctions.density[i]);
    }
    scene_.occluded(rays);
    junctions.keep_joined(rays.open);
    if (!path.goes_on()) return;
    SecondVertex(path.second)
        .evaluate(junctions.joined, junctions.wo_local, path.next_local, junctions.next);
    const float cosine = path.second.cosine(path.next_local);
    for (std::size_t i = 0; i < lane_count; ++i) {
        junctions.next.f.set(i, junctions.next.f[i] * cosine);
        if (is_black(junctions.next.f[i])) junctions.next.pdf[i] = 0;
    }
}

/// Closes edges that do not run in the medium in which y was reached, and lets the others through.
inline void PathBlock::cross_media(Group& group, const ReusableVertex& y) {
    Junctions& junctions = group.junctions;
    ShadowPacket& rays = edges_.rays;
    for (std::size_t i = 0; i < lane_count; ++i) {
        if (!rays.open[i]) continue;
        const ReusableVertex& x = group.vertices[i];
        const Vector3 d = y.at.p - x.at.p;
        const float distance = glm::length(d);
        rays.open[i] = x.medium_towards(d) == y.medium;
        if (!rays.open[i] || !y.medium || !(junctions.density[i] > 0)) continue;
        const HomogeneousEdge edge(*y.medium, x.at.p, d / distance, distance,
                                   junctions.transfer[i]);
        junctions.transfer.set(i, junctions.transfer[i] * edge.weight(y.in_medium()));
        junctions.density[i] *= edge.reach(y.in_medium());
    }
}

inline void PathBlock::set_own(Junctions& junctions, const ReusablePath& path, std::size_t lane,
                               float density) {
    junctions.joined[lane] = true;
    junctions.density[lane] = density;
    junctions.transfer.set(lane, path.to_second.weight * density);
    junctions.wo_local.set(lane, path.second.wo_local);
    junctions.next.set(lane, {.f = path.next_f_cosine, .pdf = path.next_pdf});
}

inline void PathBlock::collect(Group& group, std::size_t j, float density, float next_density) {
    const ReusablePath& path = paths_[j];
    const Junctions& junctions = group.junctions;
    const SecondVertex second(path.second);
    ReflectedLanes reflected;
    for (const ReusedLight& light : path.lights) {
        second.evaluate(junctions.joined, junctions.wo_local, light.wi_local, values_);
        if (&group == &groups_[j / lane_count]) values_.set(j % lane_count, light.own);
        reflected.add(light, values_, density);
    }
    if (path.goes_on() && next_density > 0) {
        reflected.add_next(junctions.next, path.next_radiance, next_density);
    }
    for (std::size_t i = 0; i < lane_count; ++i) {
        if (!junctions.joined[i]) continue;
        const Color found = junctions.transfer[i] * reflected.radiance[i];
        group.radiance.set(i, group.radiance[i] + found);
    }
}

inline void PathBlock::finish() const {
    for (std::size_t k = 0; k < paths_.size(); ++k) {
        if (paths_[k].radiance) {
            *paths_[k].radiance +=
                paths_[k].beta * groups_[k / lane_count].radiance[k % lane_count];
        }
    }
}

/// Adds to all samples what the paths of their blocks find behind the second vertices.
inline void reuse_paths(const Scene& scene, std::span<const CameraSample> samples,
                        std::span<const ReusablePath> paths, bool heeds_media) {
    for (std::size_t begin = 0, end = 0; begin < paths.size(); begin = end) {
        while (end < paths.size() && samples[end].block == samples[begin].block) ++end;
        PathBlock block(scene, paths.subspan(begin, end - begin), heeds_media);
        for (std::size_t j = 0; j < end - begin; ++j) block.share(j);
        block.finish();
    }
}

/// The parameter of all integrators that share paths.
inline void check_block_size(const Params& params, int size) {
    if ((size & (size - 1)) != 0) {
        params.error("reuse", "\"reuse\" must be 0, 1, 2, 4, 8 or 16");
    }
}

}  // namespace lucerna
