// SPDX-License-Identifier: Apache-2.0
/// uniform: every light with the same probability, P(l) = 1 / n. An environment map counts as one.
///
/// The simplest sampler, best for one light or a few equal ones; its variance grows with the
/// number of lights.
#include "plugins/light_samplers/light_groups.h"

namespace lucerna {

namespace {

class UniformLightSampler final : public LightSampler {
public:
    explicit UniformLightSampler(const Params& params)
        : draws_(static_cast<std::uint32_t>(params.int32(
              "light_samples", 1, {.min = 1, .max = 1024}, "lights chosen at each point"))) {}

    void prepare(const Scene& scene) override { groups_ = LightGroups(scene); }

    std::uint32_t draws() const override { return groups_.size() > 0 ? draws_ : 0; }

    std::optional<LightChoice> sample(const Receiver&, std::uint32_t draw, float u) const override {
        // Stratified over the draws: together they cover [0, 1).
        const auto count = static_cast<double>(groups_.size());
        const double place = (draw + static_cast<double>(u)) / draws_ * count;
        const double group = std::min(std::floor(place), count - 1);
        LightChoice choice = groups_.draw(static_cast<std::size_t>(group), place - group);
        choice.pmf *= draws_per_group();
        return choice;
    }

    float pmf(const Receiver&, std::uint32_t light) const override {
        return draws_per_group() * groups_.pmf(light);
    }

private:
    float draws_per_group() const {
        return static_cast<float>(draws_) / static_cast<float>(groups_.size());
    }

    std::uint32_t draws_;
    LightGroups groups_;
};

}  // namespace

const PluginInfo plugin =
    describe<UniformLightSampler>("chooses every light with the same probability");

}  // namespace lucerna
