// SPDX-License-Identifier: Apache-2.0
/// Which lights matter in a region of the scene, learnt with shadow rays before rendering.
///
/// Candidates are found in the light tree, best first, by bounds over the whole region, so that
/// lights next to it are never missed. Shadow rays from points of the region then learn how much
/// of the unoccluded contribution arrives; more rays go to lights that matter and are little
/// known. The K lights that bring most are kept. All else is left to the tree, and the share of
/// draws that it gets is learnt too. A region depends on nothing but its own points.
#pragma once

#include "core/math/distribution.h"
#include "plugins/light_samplers/light_tree8.h"

#include <queue>

namespace lucerna {

struct CellOptions {
    std::size_t lights = 64;  ///< K, kept in a cell
    std::size_t candidates = 256;
    std::size_t rays = 384;  ///< shadow rays for a cell
    float floor = 0.02f;     ///< of the learnt visibility
};

/// What is known of a region.
struct LightCell {
    std::vector<LightLanes> lanes;      ///< intensities times learnt visibility
    std::vector<std::uint32_t> lights;  ///< of each lane
    float tail = 1;                     ///< share of draws that the tree gets
    float infinite = 0;                 ///< contribution of all lights at infinity together
};

/// What all cells share.
struct CellContext {
    const Scene& scene;
    const LightTree8& tree;
    std::vector<std::uint32_t> infinite;  ///< lights at infinity
    const DiscreteDistribution& infinite_power;
    double infinite_irradiance = 0;  ///< that they are expected to cause together
    double unit = 1;                 ///< irradiance that counts as 1
    std::size_t finite = 0;          ///< lights in the tree
    CellOptions options;
};

class CellBuilder {
public:
    /// `points` are receivers in the cell; others may be as far as `margin` from them.
    CellBuilder(const CellContext& context, std::span<const Receiver> points, float margin,
                std::uint64_t seed)
        : context_(context), points_(points), rng_(seed) {
        for (const Receiver& at : points) lit_.emplace_back(at);
        bound_region(margin);
    }

    LightCell build();

private:
    struct Candidate {
        std::uint32_t light = 0;
        float mean = 0;      ///< unoccluded contribution, over the points
        double arrived = 0;  ///< sum over rays of the fraction that arrived
        double rays = 0;
    };

    /// What arrives of its unoccluded contribution: as measured, or as for other candidates.
    double visibility(const Candidate& c) const {
        return (c.arrived + prior_rays * prior_) / (c.rays + prior_rays);
    }

    void bound_region(float margin);
    float nearest(const LightLanes& lanes, std::size_t i) const;
    void find_candidates();
    void weigh_candidates();
    void trace(std::size_t candidate);
    void trace_rounds();
    double arriving(std::uint32_t light, std::size_t point);
    void keep_best(LightCell& cell);
    void learn_infinite(LightCell& cell);
    void learn_tail(LightCell& cell);

    const CellContext& context_;
    std::span<const Receiver> points_;
    std::vector<LitPoint> lit_;
    LitPoint region_;
    std::vector<Candidate> candidates_;
    std::vector<float> weights_;  ///< contribution of each candidate at each point
    static constexpr double prior_rays = 0.8;
    double prior_ = 0.5;
    Rng rng_;
};

inline void CellBuilder::bound_region(float margin) {
    Vector3 center(0), normal(0);
    for (const LitPoint& at : lit_) {
        center += at.p / static_cast<float>(lit_.size());
        normal += at.n;
    }
    region_.two_sided = lit_.front().two_sided;
    const float length = glm::length(normal);
    region_.n = region_.ns = length > 0 ? normal / length : lit_.front().n;
    float radius = 0, cosine = 1;
    for (const LitPoint& at : lit_) {
        radius = std::max(radius, glm::length(at.p - center) + at.slack);
        cosine = std::min(cosine, glm::dot(at.n, region_.n));
    }
    region_.p = center;
    region_.slack = radius + margin;
    region_.spread = cosine > 0 ? safe_sqrt(1 - sqr(cosine)) : 1.0f;
}

/// How much larger the contribution of a light is if it is where the box of its cluster comes
/// nearest to the region, and not in the middle.
inline float CellBuilder::nearest(const LightLanes& l, std::size_t i) const {
    const Vector3 d = glm::abs(Vector3(l.cx[i], l.cy[i], l.cz[i]) - region_.p);
    const Vector3 e(l.ex[i], l.ey[i], l.ez[i]);
    const Vector3 inflated = e + region_.slack, gap = glm::max(d - e, Vector3(0));
    const float middle2 = std::max(glm::dot(d, d), 0.5f * glm::dot(inflated, inflated));
    return middle2 / std::max(glm::dot(gap, gap), std::max(1.5f * sqr(region_.slack), 1e-30f));
}

/// Best first, by a bound of what the strongest light of a cluster contributes anywhere.
inline void CellBuilder::find_candidates() {
    struct Entry {
        float bound;
        std::uint32_t link;
        bool leaf;
        bool operator<(const Entry& o) const {
            return bound != o.bound ? bound < o.bound : link > o.link;
        }
    };
    if (context_.tree.empty()) return;
    std::priority_queue<Entry> open;
    open.push({infinity, 0, false});
    while (!open.empty() && candidates_.size() < context_.options.candidates) {
        const Entry entry = open.top();
        open.pop();
        if (entry.leaf) {
            candidates_.push_back({.light = entry.link});
            continue;
        }
        const LightTree8::Node& node = context_.tree[entry.link];
        float bounds[8];
        contributions(node.lanes, region_, bounds);
        for (std::size_t i = 0; i < node.count; ++i) {
            const bool leaf = node.leaves >> i & 1;
            const float bound = bounds[i] * node.strongest[i] * nearest(node.lanes, i);
            if (bound > 0) open.push({bound, node.link[i], leaf});
        }
    }
}

inline void CellBuilder::weigh_candidates() {
    const std::size_t count = candidates_.size(), stride = (count + 7) / 8 * 8;
    std::vector<LightLanes> lanes(stride / 8);
    for (std::size_t i = 0; i < count; ++i) {
        const auto [from, lane] = context_.tree.lane(candidates_[i].light);
        lanes[i / 8].copy(i % 8, *from, lane);
    }
    weights_.resize(stride * lit_.size());
    for (std::size_t p = 0; p < lit_.size(); ++p) {
        for (std::size_t block = 0; block < lanes.size(); ++block) {
            contributions(lanes[block], lit_[p], &weights_[p * stride + 8 * block]);
        }
    }
    // Lights near the region may be brighter where there is no point.
    for (std::size_t i = 0; i < count; ++i) {
        float sum = 0;
        for (std::size_t p = 0; p < lit_.size(); ++p) sum += weights_[p * stride + i];
        float near[8];
        LightLanes one;
        one.copy(0, lanes[i / 8], i % 8);
        contributions(one, region_, near);
        candidates_[i].mean = std::max(sum / static_cast<float>(lit_.size()), 0.1f * near[0]);
    }
}

/// Irradiance that one sample of a light brings to a point, in units; zero if it is blocked.
inline double CellBuilder::arriving(std::uint32_t index, std::size_t point) {
    const Light& light = context_.scene.lights()[index];
    const Vector2 u = rng_.next_float2();
    const Receiver& at = points_[point];
    const auto sample = light.emitter->sample_li(light, at, u);
    if (!sample || !(sample->pdf > 0)) return 0;
    const LitPoint& lit = lit_[point];
    const float cosine = glm::dot(sample->wi, lit.ns);
    const float side = glm::dot(sample->wi, lit.n) * cosine;
    if (!(side > 0) || !(lit.two_sided > 0 || cosine > 0)) return 0;
    const double value = static_cast<double>(luminance(sample->radiance)) *
                         static_cast<double>(std::abs(cosine) / sample->pdf) / context_.unit;
    if (!(value > 0) || !std::isfinite(value)) return 0;
    return context_.scene.occluded(at, *sample) ? 0.0 : value;
}

/// One ray to a candidate, from a point drawn in proportion to the contribution there.
inline void CellBuilder::trace(std::size_t i) {
    const std::size_t stride = (candidates_.size() + 7) / 8 * 8;
    float total = 0;
    for (std::size_t p = 0; p < lit_.size(); ++p) total += weights_[p * stride + i];
    float place = rng_.next_float() * total;
    std::size_t point = lit_.size();
    for (std::size_t p = 0; p < lit_.size(); ++p) {
        const float w = weights_[p * stride + i];
        if (!(w > 0)) continue;
        point = p;
        if (place < w) break;
        place -= w;
    }
    candidates_[i].rays += 1;
    if (point == lit_.size()) return;
    const double fraction =
        arriving(candidates_[i].light, point) / static_cast<double>(weights_[point * stride + i]);
    candidates_[i].arrived += std::min(fraction, 2.0);
}

inline void CellBuilder::trace_rounds() {
    if (candidates_.empty()) return;
    std::size_t left = context_.options.rays;
    for (std::size_t i = 0; i < candidates_.size() && left > 0; ++i, --left) trace(i);
    double arrived = 1, rays_traced = 2;
    for (const Candidate& c : candidates_) arrived += c.arrived, rays_traced += c.rays;
    prior_ = std::min(arrived / rays_traced, 1.0);
    for (std::size_t rounds = 4; rounds > 0 && left > 0; --rounds) {
        std::vector<double> wanted;
        double total = 0;
        for (const Candidate& c : candidates_) {
            wanted.push_back(static_cast<double>(c.mean) * std::sqrt(visibility(c) / (1 + c.rays)));
            total += wanted.back();
        }
        if (!(total > 0)) return;
        const std::size_t rays = left / rounds;
        double owed = rng_.next_double();
        for (std::size_t i = 0; i < candidates_.size(); ++i) {
            owed += static_cast<double>(rays) * wanted[i] / total;
            for (; owed >= 1; owed -= 1) trace(i);
        }
        left -= rays;
    }
}

inline void CellBuilder::keep_best(LightCell& cell) {
    const auto value = [&](const Candidate& c) {
        return static_cast<double>(c.mean) * visibility(c);
    };
    std::stable_sort(candidates_.begin(), candidates_.end(),
                     [&](const Candidate& a, const Candidate& b) { return value(a) > value(b); });
    const std::size_t count = std::min(candidates_.size(), context_.options.lights);
    cell.lanes.assign((count + 7) / 8, {});
    cell.lights.assign(8 * cell.lanes.size(), LightTree8::none);
    for (std::size_t i = 0; i < count; ++i) {
        const Candidate& c = candidates_[i];
        const auto [from, lane] = context_.tree.lane(c.light);
        LightLanes& lanes = cell.lanes[i / 8];
        lanes.copy(i % 8, *from, lane);
        lanes.intensity[i % 8] *=
            std::max(static_cast<float>(visibility(c)), context_.options.floor);
        cell.lights[i] = c.light;
    }
}

inline void CellBuilder::learn_infinite(LightCell& cell) {
    if (context_.infinite.empty()) return;
    constexpr int samples = 32;
    double sum = 0;
    for (int i = 0; i < samples; ++i) {
        const std::uint32_t chosen = context_.infinite_power.sample(rng_.next_double());
        const std::size_t point = rng_.next_uint() % lit_.size();
        const double share = context_.infinite_power.pmf(chosen);
        if (share > 0) sum += arriving(context_.infinite[chosen], point) / share;
    }
    cell.infinite = static_cast<float>(
        std::max(sum / samples, 0.02 * context_.infinite_irradiance / context_.unit));
}

/// The share of draws that makes the second moment of list and tree together least.
inline void CellBuilder::learn_tail(LightCell& cell) {
    std::size_t kept = 0;
    for (const std::uint32_t light : cell.lights) kept += light != LightTree8::none;
    if (kept == context_.finite) {
        cell.tail = 0;
        return;
    }
    constexpr int draws = 32;
    double list2 = 0, tree2 = 0;
    std::vector<float> w(cell.lights.size());
    for (int i = 0; i < draws; ++i) {
        const std::size_t point = rng_.next_uint() % lit_.size();
        const double u_list = rng_.next_double();
        const double u_tree = rng_.next_double();
        double total = 0;
        for (std::size_t b = 0; b < cell.lanes.size(); ++b) {
            contributions(cell.lanes[b], lit_[point], &w[8 * b]);
            for (std::size_t k = 8 * b; k < 8 * b + 8; ++k) total += static_cast<double>(w[k]);
        }
        double place = u_list * total;
        for (std::size_t k = 0; k < w.size() && total > 0; ++k) {
            place -= static_cast<double>(w[k]);
            if (place >= 0 || !(w[k] > 0)) continue;
            list2 += sqr(arriving(cell.lights[k], point) * total / static_cast<double>(w[k]));
            break;
        }
        const auto choice = context_.tree.sample(lit_[point], u_tree);
        if (!choice) continue;
        if (std::find(cell.lights.begin(), cell.lights.end(), choice->light) != cell.lights.end()) {
            continue;
        }
        tree2 += sqr(arriving(choice->light, point) / static_cast<double>(choice->pmf));
    }
    const double a = std::sqrt(list2), b = std::sqrt(tree2);
    const double best = a + b > 0 ? b / (a + b) : 0.3;
    if (best > 0.97 && context_.infinite.empty()) {  // the list is worth nothing
        cell = {};
        return;
    }
    constexpr double prior_draws = 8, prior = 0.3;
    const double share = (draws * best + prior_draws * prior) / (draws + prior_draws);
    cell.tail = static_cast<float>(std::clamp(share, 0.2, 0.9));
}

inline LightCell CellBuilder::build() {
    LightCell cell;
    find_candidates();
    weigh_candidates();
    trace_rounds();
    keep_best(cell);
    learn_infinite(cell);
    learn_tail(cell);
    return cell;
}

}  // namespace lucerna
