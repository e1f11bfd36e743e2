// SPDX-License-Identifier: Apache-2.0
/// What a region of the scene remembers of the lights around it.
///
/// Of the candidates that a study (light_study.h) found, the lights are kept that bring most, at
/// most K, until they bring a given part of what all of them do. What a cell learnt of a light
/// with its own few rays is joined with what its neighbours learnt of it. All other lights are
/// left to the tree, and the share of draws that it gets is learnt too.
#pragma once

#include "plugins/light_samplers/light_study.h"

namespace lucerna {

struct CellOptions {
    std::size_t lights = 64;      ///< K, weighed at each point
    std::size_t far_lights = 512; ///< weighed once for all points
    std::size_t candidates = 256;
    std::size_t rays = 384;    ///< shadow rays for a cell
    float coverage = 0.99f;    ///< of what the candidates bring, by the lights that are weighed
    float lent_rays = 4;       ///< that what the neighbours learnt counts for
    float least_tail = 0.05f;  ///< share of draws of the tree
    float floor = 0.02f;       ///< of the learnt visibility
};

/// What is known of a region: intensities are times learnt visibility.
struct LightCell {
    std::vector<FlatLanes> flat;
    std::vector<LightLanes> others;
    std::vector<std::uint32_t> lights;  ///< of each lane, first the flat ones
    std::vector<std::uint32_t> far;     ///< lights that are weighed once, sorted
    std::vector<float> far_until;       ///< sum of their contributions, up to each
    float tail = 1;                     ///< share of draws that the tree gets
    float infinite = 0;                 ///< contribution of all lights at infinity together

    std::size_t blocks() const { return flat.size() + others.size(); }
    /// Of all lanes.
    void weigh(const LitPoint& at, float* result) const {
        contributions(std::span<const FlatLanes>(flat), at, result);
        contributions(std::span<const LightLanes>(others), at,
                      result + LightLanes::width * flat.size());
    }
    bool holds(std::uint32_t light) const {
        return std::find(lights.begin(), lights.end(), light) != lights.end() ||
               std::binary_search(far.begin(), far.end(), light);
    }
    float far_weight(std::size_t i) const {
        return far_until[i] - (i > 0 ? far_until[i - 1] : 0.0f);
    }
    /// The light at a place in [0, far_total()).
    std::size_t far_at(float place) const {
        const auto it = std::upper_bound(far_until.begin(), far_until.end(), place);
        return std::min(static_cast<std::size_t>(it - far_until.begin()), far.size() - 1);
    }
    float far_total() const { return far.empty() ? 0.0f : far_until.back(); }
};

/// Takes what neighbours know of the same lights for the prior. All are sorted by light.
inline void borrow(std::vector<Candidate>& mine,
                   std::span<const std::vector<Candidate>* const> neighbours, float most_rays) {
    for (const std::vector<Candidate>* other : neighbours) {
        auto theirs = other->begin();
        for (Candidate& c : mine) {
            while (theirs != other->end() && theirs->light < c.light) ++theirs;
            if (theirs == other->end()) break;
            if (theirs->light != c.light) continue;
            const float rays = c.prior_rays + theirs->rays;
            c.prior = (c.prior * c.prior_rays + theirs->arrived) / rays;
            c.prior_rays = rays;
        }
    }
    for (Candidate& c : mine) c.prior_rays = std::min(c.prior_rays, most_rays);
}

class CellBuilder {
public:
    CellBuilder(LightStudy& study, const SceneLights& lights, const CellOptions& options)
        : study_(study), lights_(lights), options_(options) {}

    LightCell build(std::vector<Candidate> candidates) {
        LightCell cell;
        keep_best(candidates, cell);
        learn_infinite(cell);
        learn_tail(cell);
        return cell;
    }

private:
    void keep_best(std::vector<Candidate>& candidates, LightCell& cell) const;
    void keep_far(std::vector<Candidate>& candidates, std::size_t first, LightCell& cell) const;
    void learn_infinite(LightCell& cell);
    void learn_tail(LightCell& cell);

    LightStudy& study_;
    const SceneLights& lights_;
    const CellOptions& options_;
};

inline void CellBuilder::keep_best(std::vector<Candidate>& candidates, LightCell& cell) const {
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.value() > b.value(); });
    double all = 0, sum = 0;
    for (const Candidate& c : candidates) all += static_cast<double>(c.value());
    std::size_t count = 0;
    std::vector<Candidate> flat, others;
    for (const Candidate& c : candidates) {
        const bool whole = count % LightLanes::width == 0;
        const bool enough = sum >= static_cast<double>(options_.coverage) * all;
        if (count == options_.lights || (whole && enough && count > 0)) break;
        const auto [from, lane] = lights_.tree.lane(c.light);
        (from->is_planar(lane) ? flat : others).push_back(c);
        sum += static_cast<double>(c.value());
        ++count;
    }
    const auto fill = [&](const std::vector<Candidate>& kept, auto& lanes) {
        lanes.resize((kept.size() + LightLanes::width - 1) / LightLanes::width);
        for (std::size_t i = 0; i < kept.size(); ++i) {
            const auto [from, lane] = lights_.tree.lane(kept[i].light);
            auto& block = lanes[i / LightLanes::width];
            block.copy(i % LightLanes::width, *from, lane);
            block.intensity[i % LightLanes::width] *=
                std::max(kept[i].visibility(), options_.floor);
            cell.lights.push_back(kept[i].light);
        }
        const std::size_t whole = (cell.lights.size() + LightLanes::width - 1) / LightLanes::width;
        cell.lights.resize(whole * LightLanes::width, LightTree8::none);
    };
    fill(flat, cell.flat);
    fill(others, cell.others);
    keep_far(candidates, count, cell);
}

inline void CellBuilder::keep_far(std::vector<Candidate>& candidates, std::size_t first,
                                  LightCell& cell) const {
    candidates.resize(std::min(candidates.size(), first + options_.far_lights));
    std::sort(candidates.begin() + static_cast<std::ptrdiff_t>(first), candidates.end(),
              [](const Candidate& a, const Candidate& b) { return a.light < b.light; });
    float sum = 0;
    for (std::size_t i = first; i < candidates.size(); ++i) {
        const Candidate& c = candidates[i];
        const float before = sum;
        sum += c.mean * std::max(c.visibility(), options_.floor);
        if (!(sum > before)) continue;
        cell.far.push_back(c.light);
        cell.far_until.push_back(sum);
    }
}

inline void CellBuilder::learn_infinite(LightCell& cell) {
    if (lights_.infinite.empty()) return;
    constexpr int samples = 32;
    double sum = 0;
    for (int i = 0; i < samples; ++i) {
        const std::uint32_t chosen = lights_.infinite_power.sample(study_.rng().next_double());
        const std::size_t point = study_.rng().next_uint() % study_.points().size();
        const double share = lights_.infinite_power.pmf(chosen);
        if (share > 0) sum += study_.arriving(lights_.infinite[chosen], point) / share;
    }
    cell.infinite = static_cast<float>(
        std::max(sum / samples, 0.02 * lights_.infinite_irradiance));
}

/// The share of draws that makes the second moment of list and tree together least.
inline void CellBuilder::learn_tail(LightCell& cell) {
    std::size_t kept = 0;
    for (const std::uint32_t light : cell.lights) kept += light != LightTree8::none;
    if (kept + cell.far.size() == lights_.finite) {
        cell.tail = 0;
        return;
    }
    constexpr int draws = 32;
    double list2 = 0, tree2 = 0;
    std::vector<float> w(cell.lights.size());
    for (int i = 0; i < draws; ++i) {
        const std::size_t point = study_.rng().next_uint() % study_.points().size();
        const double u_list = study_.rng().next_double();
        const double u_tree = study_.rng().next_double();
        const LitPoint& at = study_.points()[point];
        cell.weigh(at, w.data());
        auto total = static_cast<double>(cell.far_total());
        for (const float x : w) total += static_cast<double>(x);
        double place = u_list * total;
        for (std::size_t k = 0; k < w.size() && total > 0; ++k) {
            place -= static_cast<double>(w[k]);
            if (place >= 0 || !(w[k] > 0)) continue;
            list2 += sqr(study_.arriving(cell.lights[k], point) * total / static_cast<double>(w[k]));
            break;
        }
        if (place >= 0 && !cell.far.empty()) {
            const std::size_t k = cell.far_at(static_cast<float>(place));
            list2 += sqr(study_.arriving(cell.far[k], point) * total /
                         static_cast<double>(cell.far_weight(k)));
        }
        const auto choice = lights_.tree.sample(at, u_tree);
        if (!choice || cell.holds(choice->light)) continue;
        tree2 += sqr(study_.arriving(choice->light, point) / static_cast<double>(choice->pmf));
    }
    const double a = std::sqrt(list2), b = std::sqrt(tree2);
    const double best = a + b > 0 ? b / (a + b) : 0.3;
    if (best > 0.97 && lights_.infinite.empty()) {  // the list is worth nothing
        cell = {};
        return;
    }
    constexpr double prior_draws = 8, prior = 0.3;
    const double share = (draws * best + prior_draws * prior) / (draws + prior_draws);
    cell.tail = static_cast<float>(std::clamp(share, static_cast<double>(options_.least_tail), 0.9));
}

}  // namespace lucerna
