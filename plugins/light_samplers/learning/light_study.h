// SPDX-License-Identifier: Apache-2.0
/// Which lights reach a region of the scene, learnt with shadow rays before rendering.
///
/// Candidates are found in the light tree, best first, by bounds over the whole region, so that
/// lights next to it are never missed: single lights, or a cut through the tree (Walter et al.
/// 2005), clusters that together hold every light. Shadow rays from points of the region learn how
/// much of the unoccluded contribution arrives; more rays go to lights that matter and are little
/// known. A study depends on nothing but the points of its region.
#pragma once

#include "core/math/sequences.h"
#include "plugins/light_samplers/learning/candidates.h"
#include "plugins/light_samplers/lights/infinite_lights.h"
#include "plugins/light_samplers/lights/light_tree8.h"

#include <queue>

namespace lucerna {

class LightStudy {
public:
    /// `points` are receivers of the region; others may be as far as `margin` from them.
    /// With `any_normal` a contribution is what arrives at a surface that faces the light.
    LightStudy(const Scene& scene, const LightTree8& tree, std::span<const Receiver> points,
               float margin, bool any_normal, std::uint64_t seed)
        : scene_(scene), tree_(tree), points_(points), any_normal_(any_normal), rng_(seed) {
        for (const Receiver& at : points) {
            lit_.emplace_back(at);
            if (any_normal) lit_.back().spread = facing_spread;
        }
        bound_region(margin);
    }

    /// The lights that may matter most, with what `rays` shadow rays tell of them.
    Candidates candidates(std::size_t count, std::size_t rays) {
        find_candidates(count, false);
        return learn(rays);
    }
    /// About `count` lights and clusters that hold all lights which can reach the region, with
    /// what so many shadow rays for each tell of them.
    Candidates cut(std::size_t count, float rays_per_candidate) {
        find_candidates(count, true);
        const auto found = static_cast<float>(candidates_.all.size());
        return learn(static_cast<std::size_t>(found * rays_per_candidate));
    }

    /// All lights at infinity, with what `rays` shadow rays tell of them.
    Candidates infinite(const InfiniteLights& lights, std::size_t rays);
    /// Stands for all points.
    const ReceiverRegion& region() const { return region_; }

private:
    void bound_region(float margin);
    float nearest(const LightLanes& lanes, std::size_t i) const;
    void find_candidates(std::size_t count, bool cut);
    std::pair<const LightLanes*, std::size_t> lane_of(const Candidate& candidate) const {
        return candidate.is_light() ? tree_.lane(candidate.light)
                                    : tree_.lane_of_node(candidate.cluster);
    }
    Candidates learn(std::size_t rays);
    template <typename Lanes>
    void weigh(std::span<const Lanes> blocks);
    double arriving(std::uint32_t light, std::size_t point);
    void trace(std::size_t candidate);
    void trace_rounds(std::size_t rays);

    const Scene& scene_;
    const LightTree8& tree_;
    std::span<const Receiver> points_;
    bool any_normal_;
    std::vector<ReceiverRegion> lit_;
    ReceiverRegion region_;
    Candidates candidates_;
    std::vector<float> weights_;  ///< of each candidate: contribution at each point
    Rng rng_;
};

inline void LightStudy::bound_region(float margin) {
    Vector3 center(0), normal(0);
    for (const ReceiverRegion& at : lit_) {
        center += at.p / static_cast<float>(lit_.size());
        normal += at.n;
    }
    region_.two_sided = lit_.front().two_sided;
    const float length = glm::length(normal);
    region_.n = region_.ns = length > 0 ? normal / length : lit_.front().n;
    float radius = 0, cosine = 1;
    for (const ReceiverRegion& at : lit_) {
        radius = std::max(radius, glm::length(at.p - center) + at.slack);
        cosine = std::min(cosine, glm::dot(at.n, region_.n));
    }
    region_.p = center;
    region_.slack = radius + margin;
    const bool faces_all = any_normal_ || !points_.front().has_normal();
    region_.spread = faces_all ? facing_spread : cosine > 0 ? safe_sqrt(1 - sqr(cosine)) : 1.0f;
}

/// How much larger the contribution of a light is if it is where the box of its cluster comes
/// nearest to the region, and not in the middle.
inline float LightStudy::nearest(const LightLanes& l, std::size_t i) const {
    const Vector3 d = absolute(Vector3(l.cx[i], l.cy[i], l.cz[i]) - region_.p);
    const Vector3 e(l.ex[i], l.ey[i], l.ez[i]);
    const Vector3 inflated = e + region_.slack, gap = glm::max(d - e, Vector3(0));
    const float middle2 = std::max(glm::dot(d, d), 0.5f * glm::dot(inflated, inflated));
    return middle2 / std::max(glm::dot(gap, gap), std::max(1.5f * sqr(region_.slack), 1e-30f));
}

/// Best first, by a bound of what a cluster contributes anywhere: for a cut all of it, else its
/// strongest light.
inline void LightStudy::find_candidates(std::size_t count, bool cut) {
    struct Entry {
        float bound, contribution;
        std::uint32_t link;
        std::uint32_t group;
        bool leaf;
        bool operator<(const Entry& o) const {
            return bound != o.bound ? bound < o.bound : link > o.link;
        }
    };
    if (tree_.empty()) return;
    candidates_.complete = cut;
    std::priority_queue<Entry> open;
    const auto divide = [&](std::uint32_t index, std::uint32_t group) {
        const auto own = static_cast<std::uint32_t>(candidates_.parents.size());
        candidates_.parents.push_back(group);
        const LightTree8::Node& node = tree_[index];
        float bounds[LightLanes::width];
        contributions(node.lanes, region_, bounds);
        for (std::size_t i = 0; i < node.count; ++i) {
            const bool leaf = node.leaves >> i & 1;
            const float part = cut ? 1 : node.strongest[i];
            const float bound = bounds[i] * part * nearest(node.lanes, i);
            if (bound > 0) {
                open.push({bound, bounds[i], node.link[i], own, leaf});
            } else {
                candidates_.complete = false;
            }
        }
    };
    divide(0, 0);
    while (!open.empty() && (cut || candidates_.all.size() < count)) {
        const Entry entry = open.top();
        open.pop();
        if (entry.leaf) {
            candidates_.all.push_back({.light = entry.link, .group = entry.group});
        } else if (!cut || candidates_.all.size() + open.size() < count) {
            divide(entry.link, entry.group);
        } else {
            candidates_.all.push_back({.cluster = entry.link, .group = entry.group});
        }
    }
    for (; !open.empty(); open.pop()) candidates_.rest += open.top().contribution;
}

/// The candidates, which are in the lanes of the blocks.
template <typename Lanes>
void LightStudy::weigh(std::span<const Lanes> blocks) {
    const std::size_t points = lit_.size();
    std::vector<float> all(LightLanes::width * blocks.size());
    weights_.resize(all.size() * points);
    for (std::size_t p = 0; p < points; ++p) {
        contributions(blocks, lit_[p], all.data());
        for (std::size_t i = 0; i < all.size(); ++i) weights_[i * points + p] = all[i];
    }
    contributions(blocks, region_, all.data());
    for (std::size_t i = 0; i < candidates_.all.size(); ++i) {
        float sum = 0;
        for (std::size_t p = 0; p < points; ++p) sum += weights_[i * points + p];
        // Lights near the region may be brighter where there is no point.
        candidates_.all[i].mean = std::max(sum / static_cast<float>(points), 0.1f * all[i]);
    }
}

inline Candidates LightStudy::learn(std::size_t rays) {
    constexpr std::size_t width = LightLanes::width;
    std::vector<LightLanes> blocks((candidates_.all.size() + width - 1) / width);
    for (std::size_t i = 0; i < candidates_.all.size(); ++i) {
        const auto [from, lane] = lane_of(candidates_.all[i]);
        blocks[i / width].copy(i % width, *from, lane);
    }
    weigh(std::span<const LightLanes>(blocks));
    trace_rounds(rays);
    return std::move(candidates_);
}

inline Candidates LightStudy::infinite(const InfiniteLights& lights, std::size_t rays) {
    candidates_ = {};
    candidates_.parents = {0};
    for (const std::uint32_t light : lights.lights) candidates_.all.push_back({.light = light});
    weigh(std::span<const InfiniteLanes>(lights.lanes));
    trace_rounds(rays);
    return std::move(candidates_);
}

/// Irradiance that one sample of a light brings to a point, in units; zero if it is blocked.
inline double LightStudy::arriving(std::uint32_t index, std::size_t point) {
    const Light& light = scene_.lights()[index];
    const Vector2 u = rng_.next_float2();
    const Receiver& at = points_[point];
    const auto sample = light.emitter->sample_li(light, at, u);
    if (!sample || !(sample->pdf > 0)) return 0;
    const ReceiverRegion& lit = lit_[point];
    float cosine = glm::dot(sample->wi, lit.ns);
    const float side = glm::dot(sample->wi, lit.n) * cosine;
    const bool has_normal = at.has_normal();
    if (has_normal && (!(side > 0) || !(lit.two_sided > 0 || cosine > 0))) return 0;
    if (any_normal_ || !has_normal) cosine = 1;
    const double value = static_cast<double>(luminance(sample->radiance)) *
                         static_cast<double>(std::abs(cosine) / sample->pdf) / tree_.unit();
    if (!(value > 0) || !std::isfinite(value)) return 0;
    return value * static_cast<double>(luminance(scene_.transmittance(at, *sample, rng_)));
}

/// One ray to a candidate, from a point drawn in proportion to the contribution there.
inline void LightStudy::trace(std::size_t i) {
    const float* const weights = &weights_[i * lit_.size()];
    float total = 0;
    for (std::size_t p = 0; p < lit_.size(); ++p) total += weights[p];
    float place = rng_.next_float() * total;
    std::size_t point = lit_.size();
    for (std::size_t p = 0; p < lit_.size(); ++p) {
        const float w = weights[p];
        if (!(w > 0)) continue;
        point = p;
        if (place < w) break;
        place -= w;
    }
    if (point == lit_.size()) return;  // it may yet matter between the points
    Candidate& candidate = candidates_.all[i];
    candidate.rays += 1;
    LightTree8::Choice choice{candidate.light, 1};
    if (!candidate.is_light()) {
        const auto drawn = tree_.sample(lit_[point], rng_.next_double(), candidate.cluster);
        if (!drawn) return;
        choice = *drawn;
    }
    const double fraction = arriving(choice.light, point) / static_cast<double>(choice.pmf) /
                            static_cast<double>(weights[point]);
    candidate.arrived += static_cast<float>(std::min(fraction, 2.0));
}

inline void LightStudy::trace_rounds(std::size_t left) {
    const std::size_t first = std::min(candidates_.all.size(), left / 3);  // best first
    for (std::size_t i = 0; i < first; ++i) trace(i);
    left -= first;
    float arrived = 1, rays_traced = 2;
    for (const Candidate& c : candidates_.all) arrived += c.arrived, rays_traced += c.rays;
    candidates_.usual = std::min(arrived / rays_traced, 1.0f);
    for (std::size_t rounds = 4; rounds > 0 && left > 0; --rounds) {
        candidates_.learn_priors();
        std::vector<double> wanted;
        double total = 0;
        for (const Candidate& c : candidates_.all) {
            wanted.push_back(
                static_cast<double>(c.mean * std::sqrt(c.visibility() / (1 + c.rays))));
            total += wanted.back();
        }
        if (!(total > 0)) break;
        const std::size_t rays = left / rounds;
        double owed = rng_.next_double();
        for (std::size_t i = 0; i < candidates_.all.size(); ++i) {
            owed += static_cast<double>(rays) * wanted[i] / total;
            for (; owed >= 1; owed -= 1) trace(i);
        }
        left -= rays;
    }
    candidates_.learn_priors();
}

}  // namespace lucerna
