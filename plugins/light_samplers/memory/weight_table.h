// SPDX-License-Identifier: Apache-2.0
/// Lights, or clusters of lights, that are weighed once for all points around a place.
///
/// Weights are kept as bytes: floats of five bits of exponent, relative to the largest, and three
/// of mantissa. Rounded probabilities are as good as exact ones as long as draws and densities use
/// the same, and a place can then remember thousands of lights.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace lucerna {

class WeightTable {
public:
    struct Choice {
        std::uint32_t light;
        float weight;
        double rest;  ///< how far into the light the place is, in [0, 1)
    };

    WeightTable() = default;
    /// Keeps those of positive weight.
    explicit WeightTable(std::vector<std::pair<std::uint32_t, float>> lights);
    /// The weights of the lights 0, 1, 2, …; those of weight zero are not kept.
    explicit WeightTable(std::span<const float> weights) { encode(weights); }

    /// Number of lights that are kept.
    std::size_t size() const { return kept_; }
    float total() const { return total_; }
    /// Zero if the light is not kept.
    float weight_of(std::uint32_t light) const {
        if (lights_.empty()) return light < codes_.size() ? weight(light) : 0.0f;
        const auto it = std::lower_bound(lights_.begin(), lights_.end(), light);
        if (it == lights_.end() || *it != light) return 0;
        return weight(static_cast<std::size_t>(it - lights_.begin()));
    }
    /// Asks the memory for what a draw reads first.
    void prefetch() const {
        for (std::size_t i = 0; i < until_.size(); i += 8) __builtin_prefetch(&until_[i]);
    }
    /// The light at a place in [0, total); there must be one.
    Choice draw(double place) const;
    /// The last light of the list, which is in the order of numbers, that is not after `light`.
    std::optional<Choice> last_up_to(std::uint32_t light) const {
        const auto it = std::upper_bound(lights_.begin(), lights_.end(), light);
        if (it == lights_.begin()) return {};
        return Choice{it[-1], weight(static_cast<std::size_t>(it - lights_.begin() - 1)), 0};
    }

    std::size_t bytes() const {
        return lights_.capacity() * sizeof(std::uint32_t) + codes_.capacity() +
               until_.capacity() * sizeof(double);
    }

private:
    static constexpr std::size_t block = 16;
    static constexpr double below_one = 1 - 0x1p-53;
    static constexpr int mantissa_shift = 20;  ///< leaves three bits

    float weight(std::size_t i) const {
        return codes_[i] == 0 ? 0.0f : std::bit_cast<float>((base_ + codes_[i]) << mantissa_shift);
    }
    void encode(std::span<const float> weights);

    std::vector<std::uint32_t> lights_;  ///< sorted; empty: all, by their numbers
    std::vector<std::uint8_t> codes_;    ///< of the weights; 0 for weight zero
    std::uint32_t base_ = 0;             ///< what codes count from
    std::vector<double> until_;          ///< sum of the weights up to the end of each block
    std::size_t kept_ = 0;
    float total_ = 0;
};

inline void WeightTable::encode(std::span<const float> weights) {
    const auto rounded = [](float w) {
        return (std::bit_cast<std::uint32_t>(w) + (1u << (mantissa_shift - 1))) >> mantissa_shift;
    };
    float largest = 0;
    for (const float w : weights) largest = std::max(largest, w);
    // Nothing below the normal numbers.
    constexpr std::uint32_t least = 8;
    base_ = std::max(rounded(largest), 255 + least) - 255;
    codes_.assign(weights.size(), 0);
    until_.assign((weights.size() + block - 1) / block, 0.0);
    kept_ = 0;
    double sum = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        if (weights[i] > 0) {
            const std::uint32_t code = std::max(rounded(weights[i]), base_ + 1) - base_;
            codes_[i] = static_cast<std::uint8_t>(std::min(code, 255u));
            ++kept_;
        }
        sum += static_cast<double>(weight(i));
        until_[i / block] = sum;
    }
    total_ = static_cast<float>(sum);
}

inline WeightTable::WeightTable(std::vector<std::pair<std::uint32_t, float>> lights) {
    std::erase_if(lights, [](const auto& l) { return !(l.second > 0); });
    std::sort(lights.begin(), lights.end());
    std::vector<float> weights;
    for (const auto& [light, weight] : lights) {
        lights_.push_back(light);
        weights.push_back(weight);
    }
    lights_.shrink_to_fit();
    encode(weights);
}

inline WeightTable::Choice WeightTable::draw(double place) const {
    const auto it = std::upper_bound(until_.begin(), until_.end(), place);
    // Beyond the end by rounding: the last block that holds a light.
    const auto found =
        it != until_.end() ? it : std::lower_bound(until_.begin(), until_.end(), until_.back());
    const auto b = static_cast<std::size_t>(found - until_.begin());
    if (!lights_.empty()) __builtin_prefetch(&lights_[block * b]);
    double end = b > 0 ? until_[b - 1] : 0.0, start = end;
    Choice choice{0, 0, 0};
    for (std::size_t i = block * b; i < std::min(block * (b + 1), codes_.size()); ++i) {
        const float w = weight(i);
        if (!(w > 0)) continue;
        choice = {lights_.empty() ? static_cast<std::uint32_t>(i) : lights_[i], w, 0};
        start = end;
        end += static_cast<double>(w);
        if (place < end) break;
    }
    choice.rest = std::clamp((place - start) / static_cast<double>(choice.weight), 0.0, below_one);
    return choice;
}

}  // namespace lucerna
