// SPDX-License-Identifier: Apache-2.0
/// Light samplers that draw one light below each node of a cut through a light tree, a cut that
/// follows from the point x.
///
///   point ─▶ cut (light_cut.h) ─▶ draw number i: node i ─▶ down the tree to a light l
///   pmf(l | x) = product of the probabilities from the node of the cut that is above l down to l
///
/// which is exact, since the cut depends on nothing but x. Draws beyond the number of nodes choose
/// no light, and none is needed. Lights at infinity have the first draw.
///
/// A rule is constructed from parameters and prepared with the tree; it tells which nodes are
/// divided, `judge` and `tolerance` (see `cut_tree`), and how a walk goes down: `children`.
#pragma once

#include "plugins/light_samplers/light_cut.h"
#include "plugins/light_samplers/light_groups.h"
#include "plugins/light_samplers/point_memory.h"

namespace lucerna {

template <typename Rule>
class CutLightSampler final : public LightSampler {
public:
    explicit CutLightSampler(const Params& params)
        : most_draws_(static_cast<std::uint32_t>(params.int32(
              "light_samples", 8, {.min = 2, .max = 1024},
              "most lights chosen at a point, one for each part of the cut; one of them is at "
              "infinity if there are such lights"))),
          rule_(params) {}

    void prepare(const Scene& scene) override {
        groups_ = LightGroups(scene);
        tree_ = LightBVH(scene);
        rule_.prepare(tree_);
        cuts_.clear();
        const std::uint32_t leaves = (tree_.size() + 1) / 2;
        most_nodes_ = std::min(most_draws_ - infinite_draws(), leaves);
    }
    std::uint32_t draws() const override { return infinite_draws() + most_nodes_; }
    std::optional<LightChoice> sample(const Receiver& at, std::uint32_t draw,
                                      float u) const override;
    float pmf(const Receiver& at, std::uint32_t light) const override;
    std::size_t bytes() const override { return tree_.bytes() + rule_.bytes(); }

private:
    std::uint32_t infinite_draws() const { return groups_.infinite() > 0 ? 1 : 0; }
    const std::vector<std::uint32_t>& cut(const Receiver& at) const {
        return cuts_.at(at, [&](const Receiver& place, std::vector<std::uint32_t>& nodes) {
            const auto judge = [&](std::uint32_t node) { return rule_.judge(tree_, node, place); };
            cut_tree(tree_, most_nodes_, rule_.tolerance(), judge, nodes);
        });
    }

    std::uint32_t most_draws_, most_nodes_ = 0;
    Rule rule_;
    LightBVH tree_;
    LightGroups groups_;
    PointMemory<std::vector<std::uint32_t>> cuts_;
};

template <typename Rule>
std::optional<LightChoice> CutLightSampler<Rule>::sample(const Receiver& at, std::uint32_t draw,
                                                         float u) const {
    const double place = fine_number(at, 0, 1, u);
    if (draw < infinite_draws()) {
        return groups_.draw_infinite(place * static_cast<double>(groups_.infinite()), 1);
    }
    const std::vector<std::uint32_t>& nodes = cut(at);
    const std::uint32_t index = draw - infinite_draws();
    if (index >= nodes.size()) return {};
    return tree_.descend(nodes[index], place, 1,
                         [&](std::uint32_t node) { return rule_.children(tree_, node, at); });
}

template <typename Rule>
float CutLightSampler<Rule>::pmf(const Receiver& at, std::uint32_t light) const {
    if (groups_.at_infinity(light)) return groups_.infinite_pmf(light, 1);
    if (!tree_.holds(light)) return 0;
    const std::vector<std::uint32_t>& nodes = cut(at);
    return tree_.pmf_of_descent(
        light,
        [&](std::uint32_t node) {
            return std::binary_search(nodes.begin(), nodes.end(), node) ? 1.0f : 0.0f;
        },
        [&](std::uint32_t node) { return rule_.children(tree_, node, at); });
}

}  // namespace lucerna
