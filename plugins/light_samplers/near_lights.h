// SPDX-License-Identifier: Apache-2.0
/// Lights that are weighed anew at each point.
#pragma once

#include "plugins/light_samplers/candidates.h"

namespace lucerna {

/// What a choice should take for the visibility `v` of a light. Were v certain, P ∝ v would be
/// best; were each light either seen or not, with the probability v, P ∝ √v: the second moment is
/// Σ v u² / P. Measured, the best is between the two.
inline float assumed_visibility(float v, float floor) {
    return std::pow(std::max(v, floor), 0.85f);
}

/// Weighed at each point: intensities are times learnt visibility.
class NearLights {
public:
    NearLights() = default;
    /// The candidates; visibility is taken to be at least `floor`.
    NearLights(std::span<const Candidate> kept, const LightTree8& tree, float floor);

    std::size_t blocks() const { return flat_.size() + others_.size(); }
    /// The light of each lane; none for empty ones.
    std::span<const std::uint32_t> lights() const { return lights_; }
    /// Writes the weights of all lanes.
    void weigh(const ReceiverRegion& at, float* weights) const {
        contributions(std::span<const FlatLanes>(flat_), at, weights);
        contributions(std::span<const LightLanes>(others_), at,
                      weights + LightLanes::width * flat_.size());
    }
    /// Asks the memory for the first blocks; processors guess the rest.
    void prefetch() const {
        const auto* const begin = reinterpret_cast<const char*>(flat_.data());
        const std::size_t size = std::min(flat_.size() * sizeof(FlatLanes), std::size_t{1024});
        for (std::size_t i = 0; i < size; i += 64) __builtin_prefetch(begin + i);
    }
    float total(const float* weights) const {
        float sum = 0;
        for (std::size_t b = 0; b < blocks(); ++b) {
            sum += LightLanes::sum(weights + LightLanes::width * b);
        }
        return sum;
    }
    /// Draws a lane with positive weight: that at a place in [0, total). Number of lanes: none has.
    std::size_t draw(const float* weights, double place) const;
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

inline NearLights::NearLights(std::span<const Candidate> kept, const LightTree8& tree,
                              float floor) {
    const auto fill = [&](bool planar, auto& blocks) {
        std::size_t i = 0;
        for (const Candidate& c : kept) {
            const auto [from, lane] = tree.lane(c.light);
            if (from->is_planar(lane) != planar) continue;
            if (i % LightLanes::width == 0) {
                blocks.emplace_back();
                lights_.resize(lights_.size() + LightLanes::width, LightTree8::none);
            }
            auto& block = blocks.back();
            block.copy(i % LightLanes::width, *from, lane);
            block.intensity[i % LightLanes::width] *= assumed_visibility(c.visibility(), floor);
            lights_[lights_.size() - LightLanes::width + i % LightLanes::width] = c.light;
            ++i;
        }
        blocks.shrink_to_fit();
    };
    fill(true, flat_);
    fill(false, others_);
}

inline std::size_t NearLights::draw(const float* weights, double place) const {
    std::size_t block = blocks();  // the last one with light that begins before the place
    double end = 0, start = 0;
    for (std::size_t b = 0; b < blocks(); ++b) {
        const auto sum = static_cast<double>(LightLanes::sum(weights + LightLanes::width * b));
        if (!(sum > 0)) continue;
        if (block != blocks() && place < end) break;
        block = b;
        start = end;
        end += sum;
    }
    std::size_t chosen = lights_.size();
    if (block == blocks()) return chosen;
    for (std::size_t i = LightLanes::width * block; i < LightLanes::width * (block + 1); ++i) {
        if (!(weights[i] > 0)) continue;
        if (chosen != lights_.size() && place < start) break;
        chosen = i;
        start += static_cast<double>(weights[i]);
    }
    return chosen;
}

}  // namespace lucerna
