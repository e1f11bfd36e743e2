// SPDX-License-Identifier: Apache-2.0
/// All lights that a place remembers, and how far they should be trusted.
#pragma once

#include "plugins/light_samplers/learning/light_study.h"
#include "plugins/light_samplers/memory/weighed_lights.h"
#include "plugins/light_samplers/memory/weight_table.h"

namespace lucerna {

/// Lights that are kept, near ones and far ones, as one list.
class KeptLights {
public:
    KeptLights(const WeighedLights& near, const WeightTable& far) : near_(near), far_(far) {}

    bool holds(std::uint32_t light) const {
        return near_.find(light) != near_.lights().size() || far_.weight_of(light) > 0;
    }
    std::size_t count() const {
        const auto near = near_.lights();
        const auto empty = std::count(near.begin(), near.end(), LightTree8::none);
        return near.size() - static_cast<std::size_t>(empty) + far_.size();
    }
    /// The share of draws for the tree that makes the second moment of list and tree together
    /// least; 1 if the list is worth nothing.
    float tail_share(LightStudy& study, const SceneLights& lights) const;

private:
    /// Light and probability, for a place in [0, 1).
    std::optional<LightTree8::Choice> draw(const ReceiverRegion& at, double place) const {
        const WeightsAt weights(near_, at);
        const auto near = static_cast<double>(weights.total());
        const double total = near + static_cast<double>(far_.total());
        const auto chosen = [&](std::uint32_t light, float weight) {
            return LightTree8::Choice{light,
                                      static_cast<float>(static_cast<double>(weight) / total)};
        };
        place *= total;
        if (place < near) {
            const WeightsAt::Choice light = weights.draw(at, place);
            return chosen(light.light, light.weight);
        }
        if (far_.size() == 0) return {};
        const WeightTable::Choice far = far_.draw(place - near);
        return chosen(far.light, far.weight);
    }

    const WeighedLights& near_;
    const WeightTable& far_;
};

inline float KeptLights::tail_share(LightStudy& study, const SceneLights& lights) const {
    constexpr int draws = 32;
    double list2 = 0, tree2 = 0;
    for (int i = 0; i < draws; ++i) {
        const std::size_t point = study.rng().next_uint() % study.points().size();
        const double u_list = study.rng().next_double();
        const double u_tree = study.rng().next_double();
        const ReceiverRegion& at = study.points()[point];
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
