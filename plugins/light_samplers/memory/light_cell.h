// SPDX-License-Identifier: Apache-2.0
/// What a cell, a region of the scene, remembers of the lights around it.
///
/// Among the candidates that a study (light_study.h) found, the lights that bring most are weighed
/// at each point, at most K, until they bring a given part of what all do; the others, and
/// clusters of lights, are weighed once. What a cell learnt of a candidate with its own few rays is
/// joined with what its neighbours learnt of it. Only lights that can reach none of the points that
/// were studied are left to a draw from the tree.
#pragma once

#include "plugins/light_samplers/lights/light_tree8.h"
#include "plugins/light_samplers/memory/cache_record.h"

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

struct LightCell : CacheRecord<2> {
    static constexpr bool is_disjoint = true;  ///< no light is in more than one list
    static constexpr std::size_t far = 0;
    static constexpr std::size_t clusters = 1;  ///< a list of nodes of the tree

    /// What a unit of weight of each list is worth.
    static std::array<float, 2> factors(const ReceiverRegion&) { return {1, 1}; }
    /// Whether a list holds a light of the tree.
    bool holds(std::uint32_t light, const LightTree8& tree) const {
        if (near.holds(light) || lists[far].weight_of(light) > 0) return true;
        const auto cluster = lists[clusters].last_up_to(tree.node_of(light));
        return cluster && tree.is_below(light, cluster->light);
    }
};

inline LightCell make_cell(Candidates candidates, const Candidates& infinite,
                           const LightTree8& tree, const InfiniteLights& infinite_lights,
                           const CellOptions& options) {
    candidates.sort_by_value();
    constexpr double least = 0.01;  // of the light of all candidates, for being near
    double all = 0, sum = 0;
    for (const Candidate& c : candidates.all) all += static_cast<double>(c.value());
    std::vector<WeighedLight> near;
    std::vector<std::pair<std::uint32_t, float>> far, clusters;
    for (const Candidate& c : candidates.all) {
        const auto value = static_cast<double>(c.value());
        const bool whole = near.size() % LightLanes::width == 0;
        const bool enough =
            near.size() == options.lights ||
            (whole && (sum >= static_cast<double>(options.coverage) * all || value < least * all));
        if (!c.is_light()) {
            clusters.emplace_back(c.cluster, c.weight(options.floor));
        } else if (enough) {
            far.emplace_back(c.light, c.weight(options.floor));
        } else {
            const float factor = assumed_visibility(c.visibility(), options.floor);
            near.push_back({c.light, tree.lane(c.light), factor});
            sum += value;
        }
    }
    LightCell cell;
    cell.near = WeighedLights(near);
    cell.lists[LightCell::far] = WeightTable(std::move(far));
    cell.lists[LightCell::clusters] = WeightTable(std::move(clusters));
    cell.infinite = infinite_weights(infinite, infinite_lights, options.floor);
    const std::size_t kept =
        near.size() + cell.lists[LightCell::far].size() + cell.lists[LightCell::clusters].size();
    if (kept == 0 && infinite_lights.size() == 0) return cell;
    const bool has_all = kept == (candidates.complete ? candidates.all.size() : tree.count());
    cell.tail = has_all ? 0 : options.tail;
    return cell;
}

}  // namespace lucerna
