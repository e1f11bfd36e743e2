// SPDX-License-Identifier: Apache-2.0
/// What a place of a scene remembers of the lights around it.
#pragma once

#include "plugins/light_samplers/learning/candidates.h"
#include "plugins/light_samplers/lights/infinite_lights.h"
#include "plugins/light_samplers/memory/weighed_lights.h"
#include "plugins/light_samplers/memory/weight_table.h"

#include <array>
#include <numeric>

namespace lucerna {

/// A record of a cache: lights near it, and `n` lists of lights further away.
template <std::size_t n>
struct CacheRecord {
    WeighedLights near;                ///< weighed at each point
    std::array<WeightTable, n> lists;  ///< weighed once
    WeightTable infinite;  ///< lights at infinity, by their places in InfiniteLights::lights
    float tail = 1;        ///< share of draws that the tree gets
    bool has_all = false;  ///< every light that is somewhere is near

    /// Asks the memory for the record itself, which tells where its lists are.
    void prefetch() const {
        const auto* const begin = reinterpret_cast<const char*>(this);
        for (std::size_t i = 0; i < sizeof(*this); i += 64) __builtin_prefetch(begin + i);
    }
    std::size_t bytes() const {
        std::size_t sum = sizeof(*this) + near.bytes() + infinite.bytes();
        for (const WeightTable& list : lists) sum += list.bytes();
        return sum;
    }
};

/// The weights of all lights at infinity: none is left to the tail, as a normal that was not
/// studied may face any of them. Together they are never taken for less than a tenth of what they
/// bring to an open place. `floor`: least visibility.
inline WeightTable infinite_weights(const Candidates& learnt, const InfiniteLights& lights,
                                    float floor) {
    const float least = 0.25f * assumed_visibility(0, floor);
    std::vector<float> weights;
    for (const Candidate& c : learnt.all) {
        const float facing = lights.facing_irradiance(weights.size());
        weights.push_back(std::max(c.weight(floor), least * facing));
    }
    const auto sum = static_cast<double>(std::accumulate(weights.begin(), weights.end(), 0.0f));
    const double scale = sum > 0 ? 0.1 * lights.by_irradiance.total() / sum : 1.0;
    for (float& w : weights) w *= static_cast<float>(std::max(scale, 1.0));
    return WeightTable(weights);
}

}  // namespace lucerna
