// SPDX-License-Identifier: Apache-2.0
/// What every light of a scene contributes to a point where nothing is in between.
#pragma once

#include "plugins/light_samplers/lights/finite_lights.h"
#include "plugins/light_samplers/lights/infinite_lights.h"

namespace lucerna {

/// All lights of a scene that shine, in lanes of eight: first those at infinity, which count as if
/// they came from everywhere alike.
class SceneLanes {
public:
    static constexpr std::size_t width = LightLanes::width;
    static constexpr std::uint32_t none = 0xffffffff;

    SceneLanes() = default;
    explicit SceneLanes(const Scene& scene) {
        const FiniteLights finite(scene);
        const InfiniteLights infinite(scene, finite.unit);
        lights_ = infinite.lights;
        for (const double e : infinite.irradiance) infinite_.push_back(static_cast<float>(e));
        const std::size_t whole = (infinite_.size() + width - 1) / width * width;
        infinite_.resize(whole);
        lights_.resize(whole, none);
        blocks_.resize((finite.lights.size() + width - 1) / width);
        for (std::size_t i = 0; i < finite.lights.size(); ++i) {
            set_lane(blocks_[i / width], i % width, finite.lights[i].cluster);
            lights_.push_back(finite.lights[i].light);
        }
        lights_.resize(whole + width * blocks_.size(), none);
        lane_of_.assign(scene.lights().size(), none);
        for (std::uint32_t i = 0; i < lights_.size(); ++i) {
            if (lights_[i] != none) lane_of_[lights_[i]] = i;
        }
    }

    /// The light of a lane.
    std::uint32_t light(std::size_t lane) const { return lights_[lane]; }
    /// What a light of the scene contributes, in the unit of light_lanes.h.
    float contribution(std::uint32_t light, const ReceiverRegion& at) const {
        const std::uint32_t lane = lane_of_[light];
        if (lane == none) return 0;
        if (lane < infinite_.size()) return infinite_[lane];
        float weights[width];
        contributions(blocks_[(lane - infinite_.size()) / width], at, weights);
        return weights[lane % width];
    }
    /// Calls `visit(first lane, contributions)` for each block of lanes until it returns false.
    template <typename Visit>
    void for_each_block(const ReceiverRegion& at, const Visit& visit) const {
        for (std::size_t i = 0; i < infinite_.size(); i += width) {
            if (!visit(i, &infinite_[i])) return;
        }
        float weights[width];
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            contributions(blocks_[b], at, weights);
            if (!visit(infinite_.size() + width * b, weights)) return;
        }
    }

    std::size_t bytes() const {
        return blocks_.capacity() * sizeof(LightLanes) + infinite_.capacity() * sizeof(float) +
               (lights_.capacity() + lane_of_.capacity()) * sizeof(std::uint32_t);
    }

private:
    std::vector<LightLanes> blocks_;
    std::vector<float> infinite_;         ///< contributions of the lights at infinity
    std::vector<std::uint32_t> lights_;   ///< of each lane, or none
    std::vector<std::uint32_t> lane_of_;  ///< of each light of the scene, or none
};

}  // namespace lucerna
