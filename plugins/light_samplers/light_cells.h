// SPDX-License-Identifier: Apache-2.0
/// What a region of the scene remembers of the lights around it.
///
/// Of the candidates that a study (light_study.h) found, those that bring most are weighed at each
/// point, at most K, until they bring a given part of what all of them do; the others are weighed
/// once. What a cell learnt of a light with its own few rays is joined with what its neighbours
/// learnt of it. In scenes of some thousand lights a cell remembers all of them, those without a
/// ray at the visibility that is usual around. The lights that are left are drawn by the tree, and
/// the share of draws that it gets is learnt too.
#pragma once

#include "plugins/light_samplers/kept_lights.h"

namespace lucerna {

struct CellOptions {
    std::size_t lights = 64;       ///< K, weighed at each point
    std::size_t far_lights = 512;  ///< weighed once for all points
    std::size_t candidates = 256;
    std::size_t rays = 384;    ///< shadow rays for a cell
    float coverage = 0.99f;    ///< of what the candidates bring, by the lights that are weighed
    float lent_rays = 4;       ///< that what the neighbours learnt counts for
    float least_tail = 0.05f;  ///< share of draws of the tree
    float floor = 0.05f;       ///< of the learnt visibility
};

/// What is known of a region.
struct LightCell {
    NearLights near;
    FarLights far;
    float tail = 1;      ///< share of draws that the tree gets
    float infinite = 0;  ///< contribution of all lights at infinity together

    bool holds(std::uint32_t light) const { return KeptLights(near, far).holds(light); }
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

    /// `others`: weights of the other lights, as a study that knew every light found them.
    LightCell build(std::vector<Candidate> candidates, const FarLights& others) {
        LightCell cell;
        keep_best(candidates, others, cell);
        cell.infinite = study_.infinite_contribution();
        learn_tail(cell);
        return cell;
    }

private:
    void keep_best(std::vector<Candidate>& candidates, const FarLights& others,
                   LightCell& cell) const;
    void learn_tail(LightCell& cell);

    LightStudy& study_;
    const SceneLights& lights_;
    const CellOptions& options_;
};

inline void CellBuilder::keep_best(std::vector<Candidate>& candidates, const FarLights& others,
                                   LightCell& cell) const {
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.value() > b.value(); });
    double all = 0, sum = 0;
    for (const Candidate& c : candidates) all += static_cast<double>(c.value());
    std::size_t count = 0;
    for (; count < std::min(candidates.size(), options_.lights); ++count) {
        const bool whole = count > 0 && count % LightLanes::width == 0;
        if (whole && sum >= static_cast<double>(options_.coverage) * all) break;
        sum += static_cast<double>(candidates[count].value());
    }
    const std::span<const Candidate> kept = candidates;
    cell.near = NearLights(kept.first(count), lights_.tree, options_.floor);
    const auto weight = [&](const Candidate& c) {
        return c.mean * std::max(c.visibility(), options_.floor);
    };
    if (others.size() > 0) {
        std::vector<float> far(lights_.lights);
        for (std::uint32_t i = 0; i < far.size(); ++i) far[i] = others.weight_of(i);
        for (const Candidate& c : kept.first(count)) far[c.light] = 0;
        for (const Candidate& c : kept.subspan(count)) far[c.light] = weight(c);
        cell.far.assign(far);
        return;
    }
    std::vector<std::pair<std::uint32_t, float>> far;
    for (const Candidate& c : kept.subspan(count)) {
        if (far.size() == options_.far_lights) break;
        far.emplace_back(c.light, weight(c));
    }
    cell.far.assign(std::move(far));
}

/// The weights of all lights for which the lights of a study stand.
inline FarLights weights_of_all(const LightStudy& study, const SceneLights& lights, float floor) {
    std::vector<float> weights(lights.lights);
    const std::span<const std::uint32_t> of_lanes = lights.every.lights();
    const float visibility = std::max(study.prior(), floor);
    for (std::size_t i = 0; i < study.means().size(); ++i) {
        if (of_lanes[i] != LightTree8::none) weights[of_lanes[i]] = study.means()[i] * visibility;
    }
    FarLights result;
    result.assign(weights);
    return result;
}

inline void CellBuilder::learn_tail(LightCell& cell) {
    const KeptLights kept(cell.near, cell.far);
    if (kept.are_all(lights_.finite)) {
        cell.tail = 0;
        return;
    }
    if (lights_.every.blocks() > 0 && cell.far.size() + cell.near.blocks() > 0) {
        // What is left can reach none of the points that were studied.
        cell.tail = options_.least_tail;
        return;
    }
    const float share = kept.tail_share(study_, lights_);
    if (share == 1 && lights_.infinite.empty()) {  // the list is worth nothing
        cell = {};
        return;
    }
    cell.tail = std::clamp(share, options_.least_tail, 0.9f);
}

}  // namespace lucerna
