// SPDX-License-Identifier: Apache-2.0
/// What shadow rays tell of clusters of lights in a region of the scene.
///
/// Bayesian regression (Vévoda, Kondapaneni and Křivánek 2018) of y, what a sample of a cluster
/// brings relative to what it would without shadows: y is 0 with the probability 1 − p, else
/// normal, with conjugate priors: Beta(½, ½) for p, normal-inverse-gamma for mean and variance. The
/// posterior of E[y²] is never zero, so that no cluster is forgotten.
#pragma once

#include "core/math/sequences.h"
#include "core/scene/scene.h"
#include "plugins/light_samplers/lights/light_cut.h"

namespace lucerna {

/// What the rays to a cluster have told.
struct Observations {
    double rays = 0, arrived = 0, sum = 0, square = 0;  ///< of y, where any light arrives

    void add(double y) {
        ++rays;
        arrived += y > 0 ? 1 : 0;
        sum += y;
        square += y * y;
    }
    /// √E[(unit y)²] by the posterior. The prior of unit y is a normal-inverse-gamma of μ = 1,
    /// κ = 1, α = 2, β = ½: a mean of 1 and a variance of 1.
    double root_mean_square(double unit) const {
        const double n = arrived, mean = n > 0 ? unit * sum / n : 1;
        const double kappa = 1 + n, mu = (1 + n * mean) / kappa, alpha = 2 + n / 2;
        const double deviations = std::max(unit * unit * square - n * mean * mean, 0.0);
        const double beta = 0.5 + 0.5 * deviations + n * sqr(mean - 1) / (2 * kappa);
        const double variance = beta * (kappa + 1) / (kappa * (alpha - 1));
        return std::sqrt((0.5 + n) / (1 + rays) * (mu * mu + variance));
    }
};

struct LightRegion {
    std::vector<std::uint32_t> clusters;  ///< nodes of the tree, in ascending order
    std::vector<float> strengths;         ///< √E[y²] of each
};

class RegionStudy {
public:
    /// `points` are receivers of the region, not all of which are used.
    RegionStudy(const Scene& scene, const LightBVH& tree, std::span<const Receiver> points)
        : scene_(scene), tree_(tree) {
        constexpr std::size_t most = 16;
        const std::size_t count = std::min(points.size(), most);
        for (std::size_t i = 0; i < count; ++i)
            points_.push_back(points[i * points.size() / count]);
    }

    /// At most `count` clusters, which hold all lights, by `rays` shadow rays to each.
    LightRegion learn(std::size_t count, int rays, std::uint64_t seed) const;

private:
    void divide(std::size_t count, std::vector<std::uint32_t>& clusters) const;
    double observe(std::uint32_t cluster, const Receiver& at, float expected, Rng& rng) const;

    const Scene& scene_;
    const LightBVH& tree_;
    std::vector<Receiver> points_;
};

/// Largest bounds of the contribution to all points first.
inline void RegionStudy::divide(std::size_t count, std::vector<std::uint32_t>& clusters) const {
    const auto judge = [&](std::uint32_t node) {
        CutNode sum{.node = node, .contribution = 1e-30f};  // none is left out
        for (const Receiver& at : points_) {
            sum.contribution += contribution(tree_, node, at);
            sum.error += tree_[node].leaf ? 0.0f : largest_contribution(tree_, node, at);
        }
        return sum;
    };
    clusters.resize(count);
    clusters.resize(cut_tree(tree_, count, 0, judge, clusters.data()));
}

/// Irradiance that one sample of a light brings to a point [W/m²].
inline double arriving_irradiance(const Scene& scene, const Light& light, const Receiver& at,
                                  Rng& rng) {
    const auto sample = light.emitter->sample_li(light, at, rng.next_float2());
    if (!sample || !(sample->pdf > 0)) return 0;
    const float cosine = at.has_normal() ? glm::dot(sample->wi, at.n) : 1.0f;
    if (at.sides != Sides::both && (cosine > 0) != (at.sides == Sides::front)) return 0;
    const double value = static_cast<double>(luminance(sample->radiance)) *
                         static_cast<double>(std::abs(cosine) / sample->pdf);
    if (!(value > 0) || !std::isfinite(value)) return 0;
    return value * static_cast<double>(luminance(scene.transmittance(at, *sample, rng)));
}

/// What one ray tells of a cluster that would bring `expected` if nothing were in between.
inline double RegionStudy::observe(std::uint32_t cluster, const Receiver& at, float expected,
                                   Rng& rng) const {
    const auto choice = tree_.descend(cluster, rng.next_double(), 1, [&](std::uint32_t node) {
        return children_by_contribution(tree_, node, at);
    });
    if (!choice) return 0;
    return arriving_irradiance(scene_, scene_.lights()[choice->light], at, rng) /
           (static_cast<double>(choice->pmf) * static_cast<double>(expected));
}

inline LightRegion RegionStudy::learn(std::size_t count, int rays, std::uint64_t seed) const {
    LightRegion region;
    divide(count, region.clusters);
    Rng rng(seed);
    std::vector<Observations> observed(region.clusters.size());
    Observations all;
    for (std::size_t c = 0; c < observed.size(); ++c) {
        for (int ray = 0; ray < rays; ++ray) {
            const Receiver& at = points_[rng.next_uint() % points_.size()];
            const float expected = contribution(tree_, region.clusters[c], at);
            if (!(expected > 0)) continue;
            const double y = observe(region.clusters[c], at, expected, rng);
            observed[c].add(y);
            all.add(y);
        }
    }
    // The unit of y is its mean where light arrives.
    const double unit = all.sum > 0 ? all.arrived / all.sum : 1;
    for (const Observations& o : observed) {
        region.strengths.push_back(static_cast<float>(o.root_mean_square(unit)));
    }
    return region;
}

}  // namespace lucerna
