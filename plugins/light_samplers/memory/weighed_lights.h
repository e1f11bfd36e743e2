// SPDX-License-Identifier: Apache-2.0
/// Lights that are weighed anew at each point.
#pragma once

#include "plugins/light_samplers/lights/light_lanes.h"

#include <optional>

namespace lucerna {

/// A light to be weighed: where it is known, and what its contribution is multiplied by.
struct WeighedLight {
    std::uint32_t light;
    std::pair<const LightLanes*, std::size_t> lane;
    float factor = 1;
};

class WeighedLights {
public:
    static constexpr std::uint32_t none = 0xffffffff;

    WeighedLights() = default;
    explicit WeighedLights(std::span<const WeighedLight> lights);

    std::size_t blocks() const { return flat_.size() + others_.size(); }
    /// The light of each lane; none for empty ones.
    std::span<const std::uint32_t> lights() const { return lights_; }
    bool holds(std::uint32_t light) const { return find(light) != lights_.size(); }
    /// Writes the weights of all lanes.
    void weigh(const ReceiverRegion& at, float* weights) const {
        contributions(std::span<const FlatLanes>(flat_), at, weights);
        contributions(std::span<const LightLanes>(others_), at,
                      weights + LightLanes::width * flat_.size());
    }
    /// Writes the weights of one block of lanes, the same numbers.
    void weigh_block(std::size_t block, const ReceiverRegion& at, float* weights) const {
        if (block < flat_.size()) {
            contributions(std::span(&flat_[block], 1), at, weights);
        } else {
            contributions(std::span(&others_[block - flat_.size()], 1), at, weights);
        }
    }
    /// Asks the memory for the first blocks; processors guess the rest.
    void prefetch() const {
        const auto* const begin = reinterpret_cast<const char*>(flat_.data());
        const std::size_t size = std::min(flat_.size() * sizeof(FlatLanes), std::size_t{1024});
        for (std::size_t i = 0; i < size; i += 64) __builtin_prefetch(begin + i);
    }
    /// The lane of a light; their number if there is none.
    std::size_t find(std::uint32_t light) const {
        const auto it = std::find(lights_.begin(), lights_.end(), light);
        return static_cast<std::size_t>(it - lights_.begin());
    }

    std::size_t bytes() const {
        return flat_.capacity() * sizeof(FlatLanes) + others_.capacity() * sizeof(LightLanes) +
               lights_.capacity() * sizeof(std::uint32_t);
    }

private:
    std::vector<FlatLanes> flat_;
    std::vector<LightLanes> others_;
    std::vector<std::uint32_t> lights_;  ///< first the flat ones
};

inline WeighedLights::WeighedLights(std::span<const WeighedLight> lights) {
    constexpr std::size_t width = LightLanes::width;
    const auto fill = [&](bool planar, auto& blocks) {
        std::size_t i = 0;
        for (const WeighedLight& l : lights) {
            const auto [from, lane] = l.lane;
            if (from->is_planar(lane) != planar) continue;
            if (i % width == 0) {
                blocks.emplace_back();
                lights_.resize(lights_.size() + width, none);
            }
            blocks.back().copy(i % width, *from, lane);
            blocks.back().intensity[i % width] *= l.factor;
            lights_[lights_.size() - width + i % width] = l.light;
            ++i;
        }
        blocks.shrink_to_fit();
    };
    fill(true, flat_);
    fill(false, others_);
}

/// The weights of such lights at one point: the sums of blocks are kept, and one block is weighed
/// again when a light of it is asked for.
class WeightsAt {
public:
    static constexpr std::size_t most_lights = 256;

    /// No light.
    WeightsAt() = default;
    WeightsAt(const WeighedLights& lights, const ReceiverRegion& at)
        : lights_(&lights), blocks_(static_cast<std::uint32_t>(lights.blocks())) {
        alignas(32) float weights[width * most_blocks];
        lights.weigh(at, weights);
        for (std::size_t b = 0; b < blocks_; ++b) {
            sums_[b] = LightLanes::sum(weights + width * b);
            total_ += sums_[b];
        }
    }

    float total() const { return total_; }

    struct Choice {
        std::uint32_t light;
        float weight;
    };
    /// The light at a place in [0, total), which must be positive. `at` as in the constructor.
    Choice draw(const ReceiverRegion& at, double place) const {
        std::size_t block = blocks_;  // the last one with light that begins before the place
        double end = 0, start = 0;
        for (std::size_t b = 0; b < blocks_; ++b) {
            if (!(sums_[b] > 0)) continue;
            if (block != blocks_ && place < end) break;
            block = b;
            start = end;
            end += static_cast<double>(sums_[b]);
        }
        alignas(32) float weights[width];
        lights_->weigh_block(block, at, weights);
        std::size_t chosen = width;
        for (std::size_t i = 0; i < width; ++i) {
            if (!(weights[i] > 0)) continue;
            if (chosen != width && place < start) break;
            chosen = i;
            start += static_cast<double>(weights[i]);
        }
        return {lights_->lights()[width * block + chosen], weights[chosen]};
    }
    /// The weight of a light, or nothing if it is none of them.
    std::optional<float> weight_of(const ReceiverRegion& at, std::uint32_t light) const {
        const std::size_t lane = lights_ ? lights_->find(light) : 0;
        if (!lights_ || lane == lights_->lights().size()) return {};
        alignas(32) float weights[width];
        lights_->weigh_block(lane / width, at, weights);
        return weights[lane % width];
    }

private:
    static constexpr std::size_t width = LightLanes::width;
    /// Flat lights and others fill blocks of their own.
    static constexpr std::size_t most_blocks = (most_lights + 2 * (width - 1)) / width;

    const WeighedLights* lights_ = nullptr;
    std::uint32_t blocks_ = 0;
    float total_ = 0;
    float sums_[most_blocks];
};

}  // namespace lucerna
