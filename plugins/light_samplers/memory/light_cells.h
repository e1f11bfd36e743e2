// SPDX-License-Identifier: Apache-2.0
/// What a region of the scene remembers of the lights around it.
///
/// Among the candidates that a study (light_study.h) found, the lights that bring most are weighed
/// at each point, at most K, until they bring a given part of what all do; the others, and
/// clusters of lights, are weighed once. What a cell learnt of a candidate with its own few rays is
/// joined with what its neighbours learnt of it. Only lights that can reach none of the points that
/// were studied are left to a draw from the tree.
#pragma once

#include "plugins/light_samplers/memory/kept_lights.h"

#include <numeric>

namespace lucerna {

struct CellOptions {
    std::size_t lights = 64;       ///< K, weighed at each point
    std::size_t clusters = 1024;   ///< and lights, in the cut
    float rays_per_candidate = 1;  ///< shadow rays
    float coverage = 0.9f;         ///< of what the candidates bring, by the lights that are weighed
    float lent_rays = 4;           ///< that what the neighbours learnt counts for
    float tail = 0.01f;            ///< share of draws of the tree
    float floor = 0.003f;          ///< of the learnt visibility
};

/// What is known of a region. No light is in more than one of the lists.
struct LightCell {
    WeighedLights near;
    WeightTable far;
    WeightTable clusters;  ///< nodes of the tree
    WeightTable infinite;  ///< all lights at infinity, by their places in SceneLights::infinite
    float tail = 1;        ///< share of draws that the tree gets

    /// Asks the memory for what a draw will read first: where the lists are, then them.
    enum class Prefetch { addresses, data };
    void prefetch(Prefetch what) const {
        if (what == Prefetch::data) {
            near.prefetch();
            clusters.prefetch();
            infinite.prefetch();
            return;
        }
        const auto* const begin = reinterpret_cast<const char*>(this);
        for (std::size_t i = 0; i < sizeof(*this); i += 64) __builtin_prefetch(begin + i);
    }

    bool is_empty() const { return near.blocks() + far.size() + clusters.size() == 0; }
    /// The cluster that a light of the tree belongs to.
    std::optional<WeightTable::Choice> cluster_of(std::uint32_t light,
                                                  const LightTree8& tree) const {
        const auto cluster = clusters.last_up_to(tree.node_of(light));
        return cluster && tree.is_below(light, cluster->light) ? cluster : std::nullopt;
    }
    bool holds(std::uint32_t light, const LightTree8& tree) const {
        return KeptLights(near, far).holds(light) || cluster_of(light, tree);
    }
    std::size_t bytes() const {
        return sizeof(*this) + near.bytes() + far.bytes() + clusters.bytes() + infinite.bytes();
    }
};

class CellBuilder {
public:
    CellBuilder(const SceneLights& lights, const CellOptions& options)
        : lights_(lights), options_(options) {}

    /// `infinite`: lights at infinity, in their order.
    LightCell build(Candidates candidates, const Candidates& infinite) {
        LightCell cell;
        keep_best(candidates, cell);
        weigh_infinite(infinite, cell);
        if (cell.is_empty() && lights_.infinite.empty()) return cell;
        const std::size_t kept = KeptLights(cell.near, cell.far).count() + cell.clusters.size();
        const bool has_all = kept == (candidates.complete ? candidates.all.size() : lights_.finite);
        cell.tail = has_all ? 0 : options_.tail;
        return cell;
    }

private:
    void keep_best(Candidates& candidates, LightCell& cell) const;
    void weigh_infinite(const Candidates& infinite, LightCell& cell) const;

    const SceneLights& lights_;
    const CellOptions& options_;
};

inline void CellBuilder::keep_best(Candidates& candidates, LightCell& cell) const {
    std::stable_sort(candidates.all.begin(), candidates.all.end(),
                     [](const Candidate& a, const Candidate& b) { return a.value() > b.value(); });
    constexpr double least = 0.01;  // of the light of all candidates, for being near
    double all = 0, sum = 0;
    for (const Candidate& c : candidates.all) all += static_cast<double>(c.value());
    std::vector<Candidate> near;
    std::vector<std::pair<std::uint32_t, float>> far, clusters;
    for (const Candidate& c : candidates.all) {
        const auto value = static_cast<double>(c.value());
        const bool whole = near.size() % LightLanes::width == 0;
        const bool enough =
            near.size() == options_.lights ||
            (whole && (sum >= static_cast<double>(options_.coverage) * all || value < least * all));
        const bool is_near = c.is_light() && !enough;
        const float weight =
            is_near ? 0 : c.mean * assumed_visibility(c.visibility(), options_.floor);
        if (is_near) {
            near.push_back(c);
            sum += value;
        }
        if (c.is_light()) {
            far.emplace_back(c.light, weight);
        } else {
            clusters.emplace_back(c.cluster, weight);
        }
    }
    cell.near = WeighedLights(near, lights_.tree, options_.floor);
    cell.clusters.assign(std::move(clusters));
    cell.far.assign(std::move(far));
}

/// No light at infinity is left to the tail, as a normal that was not studied may face any of them.
/// Together they are never taken for less than a tenth of what they bring to an open place.
inline void CellBuilder::weigh_infinite(const Candidates& infinite, LightCell& cell) const {
    const float least = 0.25f * assumed_visibility(0, options_.floor);
    std::vector<float> weights;
    for (const Candidate& c : infinite.all) {
        const float facing = lights_.facing_irradiance(weights.size());
        const float learnt = c.mean * assumed_visibility(c.visibility(), options_.floor);
        weights.push_back(std::max(learnt, least * facing));
    }
    const auto sum = static_cast<double>(std::accumulate(weights.begin(), weights.end(), 0.0f));
    const double scale = sum > 0 ? 0.1 * lights_.infinite_irradiance / sum : 1.0;
    for (float& w : weights) w *= static_cast<float>(std::max(scale, 1.0));
    cell.infinite.assign(weights);
}

}  // namespace lucerna
