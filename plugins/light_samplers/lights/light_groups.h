// SPDX-License-Identifier: Apache-2.0
/// The lights of a scene, those of an emitter at infinity as one: an environment map is as many
/// lights as it has patches, but samplers that count lights should count it once.
#pragma once

#include "core/interfaces/light_sampler.h"
#include "core/math/distribution.h"
#include "core/scene/scene.h"

#include <vector>

namespace lucerna {

/// Groups of lights: first each emitter at infinity, then each other light alone. In a group lights
/// are drawn in proportion to their power.
class LightGroups {
public:
    LightGroups() = default;
    explicit LightGroups(const Scene& scene);

    std::size_t size() const { return infinite_.size() + finite_; }
    /// Number of groups at infinity.
    std::size_t infinite() const { return infinite_.size(); }
    bool at_infinity(std::uint32_t light) const { return group_of(light) != nullptr; }

    /// Draws from a group, which is drawn with probability `scale`, for u in [0, 1).
    LightChoice draw(std::size_t group, double u, float scale) const {
        if (group < infinite_.size()) {
            const Infinite& g = infinite_[group];
            const std::uint32_t i = g.choice.sample(u);
            return {g.first + i, scale * static_cast<float>(g.choice.pmf(i))};
        }
        auto light = static_cast<std::uint32_t>(group - infinite_.size());
        for (const Infinite& g : infinite_) {
            if (light >= g.first) light += g.count();
        }
        return {light, scale};
    }
    /// Draws from one of the groups at infinity, all alike and `share` together, for u in [0, 1).
    LightChoice draw_infinite(double u, float share) const {
        const auto count = static_cast<double>(infinite());
        const double group = std::min(std::floor(u * count), count - 1);
        return draw(static_cast<std::size_t>(group), std::min(u * count - group, 1 - 0x1p-53),
                    share / static_cast<float>(infinite()));
    }
    /// The number that `draw_infinite` reports for a light.
    float infinite_pmf(std::uint32_t light, float share) const {
        return share / static_cast<float>(infinite()) * pmf(light);
    }
    /// The probability of a light within its group.
    float pmf(std::uint32_t light) const {
        const Infinite* const g = group_of(light);
        return g ? static_cast<float>(g->choice.pmf(light - g->first)) : 1.0f;
    }

private:
    struct Infinite {
        std::uint32_t first = 0;  ///< light
        DiscreteDistribution choice;

        std::uint32_t count() const { return static_cast<std::uint32_t>(choice.size()); }
    };

    const Infinite* group_of(std::uint32_t light) const {
        for (const Infinite& g : infinite_) {
            if (light >= g.first && light - g.first < g.count()) return &g;
        }
        return nullptr;
    }

    std::vector<Infinite> infinite_;  ///< by their first lights
    std::size_t finite_ = 0;
};

inline LightGroups::LightGroups(const Scene& scene) {
    const std::span<const Light> lights = scene.lights();
    finite_ = lights.size();
    for (const std::uint32_t first : scene.infinite_lights()) {
        std::vector<double> power(lights[first].emitter->light_count());
        for (std::uint32_t i = 0; i < power.size(); ++i) {
            power[i] = lights[first].emitter->bounds(lights[first + i]).power;
        }
        DiscreteDistribution choice(power);
        if (choice.empty()) choice = DiscreteDistribution(std::vector(power.size(), 1.0));
        infinite_.push_back({.first = first, .choice = std::move(choice)});
        finite_ -= power.size();
    }
}

}  // namespace lucerna
