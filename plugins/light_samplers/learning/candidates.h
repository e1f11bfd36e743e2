// SPDX-License-Identifier: Apache-2.0
/// Lights that may matter in a region of the scene, and what shadow rays have told of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace lucerna {

/// What a choice should take for the visibility `v` of a light. Were v certain, P ∝ v would be
/// best; were each light either seen or not, with the probability v, P ∝ √v: the second moment is
/// Σ v u² / P. Measured, the best is between the two.
inline float assumed_visibility(float v, float floor) {
    return std::pow(std::max(v, floor), 0.85f);
}

/// A light, or a cluster of lights.
struct Candidate {
    static constexpr std::uint32_t none = 0xffffffff;

    std::uint32_t light = none;
    std::uint32_t cluster = none;  ///< node of the tree, if it is not a light
    std::uint32_t group = 0;       ///< the group of candidates that it is in
    float mean = 0;                ///< unoccluded contribution, over the points
    float rays = 0;
    float arrived = 0;                      ///< sum over rays of the fraction that arrived
    float lent_rays = 0, lent_arrived = 0;  ///< the same, of the regions around
    float prior = 0;                        ///< of that fraction, for those with few rays

    /// What arrives of its unoccluded contribution.
    float visibility() const {
        constexpr float prior_rays = 0.8f;
        return (arrived + lent_arrived + prior_rays * prior) / (rays + lent_rays + prior_rays);
    }
    float value() const { return mean * visibility(); }
    /// For choices; visibility is never taken for less than `floor`.
    float weight(float floor) const { return mean * assumed_visibility(visibility(), floor); }
    bool is_light() const { return cluster == none; }
    /// In the order of what they are, whatever is known of them.
    bool precedes(const Candidate& o) const {
        return light != o.light ? light < o.light : cluster < o.cluster;
    }
};

/// Candidates in groups of lights that are likely to be hidden together: those below a node of the
/// tree.
struct Candidates {
    std::vector<Candidate> all;
    std::vector<std::uint32_t> parents;  ///< of each group, the one that it is part of
    float usual = 0;                     ///< that fraction, of all lights
    float rest = 0;         ///< unoccluded contribution of lights that are no candidate
    bool complete = false;  ///< every light of the tree is one, or in a cluster

    /// What is not known of a light is taken from its group, and so on up to all of them.
    void learn_priors();
    void sort_by_value() {
        std::stable_sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) {
            return a.value() > b.value();
        });
    }
    /// Takes from the regions around what they know of the same candidates, for no more than
    /// `most_rays` each. All are sorted.
    void borrow(std::span<const Candidates* const> neighbours, float most_rays);
};

inline void Candidates::learn_priors() {
    constexpr float prior_rays = 16;
    struct Sum {
        float rays = 0, arrived = 0;
    };
    std::vector<Sum> sums(parents.size());
    for (const Candidate& c : all) {
        sums[c.group].rays += c.rays + c.lent_rays;
        sums[c.group].arrived += c.arrived + c.lent_arrived;
    }
    for (std::size_t i = sums.size(); i-- > 1;) {
        sums[parents[i]].rays += sums[i].rays;
        sums[parents[i]].arrived += sums[i].arrived;
    }
    std::vector<float> arriving(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const float above = i == 0 ? usual : arriving[parents[i]];
        const float arrived = sums[i].arrived + prior_rays * above;
        arriving[i] = std::min(arrived / (sums[i].rays + prior_rays), 1.0f);
    }
    for (Candidate& c : all) c.prior = arriving[c.group];
}

inline void Candidates::borrow(std::span<const Candidates* const> neighbours, float most_rays) {
    for (const Candidates* other : neighbours) {
        auto theirs = other->all.begin();
        for (Candidate& c : all) {
            while (theirs != other->all.end() && theirs->precedes(c)) ++theirs;
            if (theirs == other->all.end()) break;
            if (c.precedes(*theirs)) continue;
            c.lent_rays += theirs->rays;
            c.lent_arrived += theirs->arrived;
        }
    }
    for (Candidate& c : all) {
        if (!(c.lent_rays > most_rays)) continue;
        c.lent_arrived *= most_rays / c.lent_rays;
        c.lent_rays = most_rays;
    }
    learn_priors();
}

}  // namespace lucerna
