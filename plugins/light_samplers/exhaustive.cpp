// SPDX-License-Identifier: Apache-2.0
/// exhaustive: every light in proportion to what it would contribute without shadows.
///
/// P(l | x) = u_l(x) / Σ u, with the bounds u of light_lanes.h evaluated for all lights at each
/// point: slow, and the best that can be done without knowing what is visible. A reference for
/// other samplers. The light of an environment counts as if it came from everywhere alike.
#include "core/interfaces/light_sampler.h"
#include "plugins/light_samplers/fine_bits.h"
#include "plugins/light_samplers/light_list.h"
#include "plugins/light_samplers/point_memory.h"

namespace lucerna {

namespace {

/// Contributions at a point.
struct PointWeights {
    std::vector<float> weights;     ///< eight for each block
    std::vector<double> sum_until;  ///< of each block, including it

    double total() const { return sum_until.empty() ? 0.0 : sum_until.back(); }
};

class ExhaustiveLightSampler final : public LightSampler {
public:
    explicit ExhaustiveLightSampler(const Params& params)
        : draws_(static_cast<std::uint32_t>(params.int32(
              "light_samples", 1, {.min = 1, .max = 1024}, "lights chosen at each point"))) {}

    void prepare(const Scene& scene) override;
    std::uint32_t draws() const override { return lights_.empty() ? 0 : draws_; }
    std::optional<LightChoice> sample(const Receiver& at, std::uint32_t draw,
                                      float u) const override;
    float pmf(const Receiver& at, std::uint32_t light) const override;

private:
    static constexpr std::uint32_t none = 0xffffffff;

    const PointWeights& weights(const Receiver& at) const;
    float probability(const PointWeights& point, std::size_t lane) const {
        const double p = static_cast<double>(point.weights[lane]) / point.total();
        return static_cast<float>(draws_ * p);
    }

    std::uint32_t draws_;
    PointMemory<PointWeights, 1> memory_;
    std::vector<LightLanes> blocks_;
    std::vector<float> infinite_;         ///< contributions of the lights at infinity
    std::vector<std::uint32_t> lights_;   ///< of each lane; first those at infinity
    std::vector<std::uint32_t> lane_of_;  ///< of each light of the scene
};

void ExhaustiveLightSampler::prepare(const Scene& scene) {
    memory_.clear();
    const LightList all(scene);
    lights_ = all.infinite;
    infinite_.clear();
    for (const double e : all.irradiance) infinite_.push_back(static_cast<float>(e));
    const std::size_t whole = (infinite_.size() + 7) / 8 * 8;
    infinite_.resize(whole);
    lights_.resize(whole, none);
    blocks_.assign((all.finite.size() + 7) / 8, {});
    for (std::size_t i = 0; i < all.finite.size(); ++i) {
        blocks_[i / 8].set(i % 8, all.finite[i].cluster, all.facing[i]);
        lights_.push_back(all.finite[i].light);
    }
    lights_.resize(whole + 8 * blocks_.size(), none);
    lane_of_.assign(scene.lights().size(), none);
    for (std::uint32_t i = 0; i < lights_.size(); ++i) {
        if (lights_[i] != none) lane_of_[lights_[i]] = i;
    }
}

const PointWeights& ExhaustiveLightSampler::weights(const Receiver& at) const {
    return memory_.at(at, [&](const Receiver& place, PointWeights& point) {
        point.weights = infinite_;
        point.weights.resize(lights_.size());
        point.sum_until.clear();
        const ReceiverRegion lit(place);
        double sum = 0;
        for (std::size_t i = 0; i < lights_.size(); i += 8) {
            float* const block = point.weights.data() + i;
            if (i >= infinite_.size()) {
                contributions(blocks_[(i - infinite_.size()) / 8], lit, block);
            }
            for (std::size_t k = 0; k < 8; ++k) sum += static_cast<double>(block[k]);
            point.sum_until.push_back(sum);
        }
    });
}

std::optional<LightChoice> ExhaustiveLightSampler::sample(const Receiver& at, std::uint32_t draw,
                                                          float u) const {
    const PointWeights& point = weights(at);
    if (!(point.total() > 0)) return {};
    const double place = fine_number(at, draw, draws_, u) * point.total();
    const auto block = std::upper_bound(point.sum_until.begin(), point.sum_until.end(), place);
    const auto index = std::min<std::size_t>(
        static_cast<std::size_t>(block - point.sum_until.begin()), point.sum_until.size() - 1);
    double before = index > 0 ? point.sum_until[index - 1] : 0;
    std::size_t chosen = lights_.size();
    for (std::size_t i = 8 * index; i < 8 * index + 8; ++i) {
        if (!(point.weights[i] > 0)) continue;
        if (chosen != lights_.size() && place < before) break;
        chosen = i;
        before += static_cast<double>(point.weights[i]);
    }
    if (chosen == lights_.size()) return {};
    return LightChoice{lights_[chosen], probability(point, chosen)};
}

float ExhaustiveLightSampler::pmf(const Receiver& at, std::uint32_t light) const {
    if (lane_of_[light] == none) return 0;
    const PointWeights& point = weights(at);
    return point.total() > 0 ? probability(point, lane_of_[light]) : 0.0f;
}

}  // namespace

const PluginInfo plugin = describe<ExhaustiveLightSampler>(
    "weighs all lights at each point by their contribution without shadows");

}  // namespace lucerna
