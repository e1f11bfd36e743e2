// SPDX-License-Identifier: Apache-2.0
/// Lights that a place remembers, with the visibility learnt there: some are weighed anew at each
/// point, others once for all points around.
#pragma once

#include "plugins/light_samplers/light_study.h"

namespace lucerna {

/// Weighed at each point: intensities are times learnt visibility.
class NearLights {
public:
    NearLights() = default;
    /// The candidates; `floor` is the least visibility.
    NearLights(std::span<const Candidate> kept, const LightTree8& tree, float floor);

    std::size_t blocks() const { return flat_.size() + others_.size(); }
    /// Of each lane; none for empty ones.
    std::span<const std::uint32_t> lights() const { return lights_; }
    /// Writes the weights of all lanes.
    void weigh(const LitPoint& at, float* weights) const {
        contributions(std::span<const FlatLanes>(flat_), at, weights);
        contributions(std::span<const LightLanes>(others_), at,
                      weights + LightLanes::width * flat_.size());
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

/// Weighed once.
class FarLights {
public:
    /// Keeps those of positive weight.
    void assign(std::vector<std::pair<std::uint32_t, float>> lights);

    std::size_t size() const { return lights_.size(); }
    std::uint32_t operator[](std::size_t i) const { return lights_[i]; }
    float total() const { return until_.empty() ? 0.0f : static_cast<float>(until_.back()); }
    float weight(std::size_t i) const {
        return static_cast<float>(until_[i] - (i > 0 ? until_[i - 1] : 0.0));
    }
    float weight_of(std::uint32_t light) const {
        const auto it = std::lower_bound(lights_.begin(), lights_.end(), light);
        if (it == lights_.end() || *it != light) return 0;
        return weight(static_cast<std::size_t>(it - lights_.begin()));
    }
    /// The light at a place in [0, total).
    std::size_t draw(double place) const {
        const auto it = std::upper_bound(until_.begin(), until_.end(), place);
        return std::min(static_cast<std::size_t>(it - until_.begin()), until_.size() - 1);
    }

    std::size_t bytes() const {
        return lights_.capacity() * sizeof(std::uint32_t) + until_.capacity() * sizeof(double);
    }

private:
    std::vector<std::uint32_t> lights_;  ///< sorted
    std::vector<double> until_;          ///< sum of the weights up to each
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
            block.intensity[i % LightLanes::width] *= std::max(c.visibility(), floor);
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

inline void FarLights::assign(std::vector<std::pair<std::uint32_t, float>> lights) {
    std::sort(lights.begin(), lights.end());
    lights_.clear();
    until_.clear();
    lights_.reserve(lights.size());
    until_.reserve(lights.size());
    double sum = 0;
    for (const auto& [light, weight] : lights) {
        if (!(weight > 0) || !(sum + static_cast<double>(weight) > sum)) continue;
        sum += static_cast<double>(weight);
        lights_.push_back(light);
        until_.push_back(sum);
    }
}

/// Lights that are kept, near ones and far ones, as one list.
class KeptLights {
public:
    KeptLights(const NearLights& near, const FarLights& far) : near_(near), far_(far) {}

    bool holds(std::uint32_t light) const {
        return near_.find(light) != near_.lights().size() || far_.weight_of(light) > 0;
    }
    /// Whether they are all the lights of a tree of so many.
    bool are_all(std::size_t count) const {
        const auto near = near_.lights();
        const auto empty = std::count(near.begin(), near.end(), LightTree8::none);
        return near.size() - static_cast<std::size_t>(empty) + far_.size() == count;
    }
    /// The share of draws for the tree that makes the second moment of list and tree together
    /// least; 1 if the list is worth nothing.
    float tail_share(LightStudy& study, const SceneLights& lights) const;

private:
    /// Light and probability, for a place in [0, 1).
    std::optional<LightTree8::Choice> draw(const LitPoint& at, double place) const {
        std::vector<float> w(near_.lights().size());
        near_.weigh(at, w.data());
        const auto near = static_cast<double>(near_.total(w.data()));
        const double total = near + static_cast<double>(far_.total());
        place *= total;
        if (place < near) {
            const std::size_t k = near_.draw(w.data(), place);
            return LightTree8::Choice{near_.lights()[k],
                                      static_cast<float>(static_cast<double>(w[k]) / total)};
        }
        if (far_.size() == 0) return {};
        const std::size_t k = far_.draw(place - near);
        return LightTree8::Choice{far_[k],
                                  static_cast<float>(static_cast<double>(far_.weight(k)) / total)};
    }

    const NearLights& near_;
    const FarLights& far_;
};

inline float KeptLights::tail_share(LightStudy& study, const SceneLights& lights) const {
    constexpr int draws = 32;
    double list2 = 0, tree2 = 0;
    for (int i = 0; i < draws; ++i) {
        const std::size_t point = study.rng().next_uint() % study.points().size();
        const double u_list = study.rng().next_double();
        const double u_tree = study.rng().next_double();
        const LitPoint& at = study.points()[point];
        const auto second_moment = [&](const std::optional<LightTree8::Choice>& choice) {
            if (!choice) return 0.0;
            return sqr(study.arriving(choice->light, point) / static_cast<double>(choice->pmf));
        };
        list2 += second_moment(draw(at, u_list));
        const auto choice = lights.tree.sample(at, u_tree);
        if (choice && !holds(choice->light)) tree2 += second_moment(choice);
    }
    const double a = std::sqrt(list2), b = std::sqrt(tree2);
    const double best = a + b > 0 ? b / (a + b) : 0.3;
    if (best > 0.9) return 1;
    constexpr double prior_draws = 8, prior = 0.3;
    const double share = (draws * best + prior_draws * prior) / (draws + prior_draws);
    return static_cast<float>(std::min(share, 0.9));
}

}  // namespace lucerna
