// SPDX-License-Identifier: Apache-2.0
/// The lights of a scene: a tree of those that are somewhere, a distribution of those at infinity.
#pragma once

#include "core/math/distribution.h"
#include "core/scene/scene.h"
#include "plugins/light_samplers/lights/light_tree8.h"

namespace lucerna {

struct SceneLights {
    LightTree8 tree;
    std::size_t finite = 0;                     ///< lights in the tree
    std::vector<std::uint32_t> infinite;        ///< lights at infinity
    std::vector<InfiniteLanes> infinite_lanes;  ///< of `infinite`
    std::size_t infinite_emitters = 0;          ///< whose lights they are
    DiscreteDistribution infinite_power;
    double infinite_irradiance = 0;  ///< that they are expected to cause together
    double unit = 1;                 ///< irradiance that counts as 1

    SceneLights() = default;
    explicit SceneLights(const Scene& scene) {
        LightList list(scene);
        finite = list.finite.size();
        infinite = list.infinite;
        infinite_lanes = list.infinite_lanes;
        for (std::size_t i = 0; i < infinite.size(); ++i) {
            infinite_emitters += i == 0 || scene.lights()[infinite[i]].emitter !=
                                               scene.lights()[infinite[i - 1]].emitter;
        }
        infinite_power = DiscreteDistribution(list.irradiance);
        for (const double e : list.irradiance) infinite_irradiance += e;
        unit = list.unit;
        tree = LightTree8(std::move(list), scene.lights().size(), Workers(scene.threads()));
    }

    std::size_t count() const { return finite + infinite.size(); }
    /// What a light at infinity causes on a surface that faces it, in units.
    float facing_irradiance(std::size_t i) const {
        constexpr std::size_t width = InfiniteLanes::width;
        return infinite_lanes[i / width].irradiance[i % width];
    }
    /// The place of a light in `infinite`, if it is there.
    std::optional<std::uint32_t> place_at_infinity(std::uint32_t light) const {
        const auto found = std::lower_bound(infinite.begin(), infinite.end(), light);
        if (found == infinite.end() || *found != light) return {};
        return static_cast<std::uint32_t>(found - infinite.begin());
    }
    std::optional<std::uint32_t> only_light() const {
        if (count() != 1) return {};
        return finite == 1 ? tree[0].link[0] : infinite.front();
    }
    /// Share of those at infinity where nothing else is known, after pbrt-v4.
    float infinite_share() const {
        const auto n = static_cast<float>(infinite_emitters);
        return n > 0 ? n / (n + (finite > 0 ? 1.0f : 0.0f)) : 0.0f;
    }
};

}  // namespace lucerna
