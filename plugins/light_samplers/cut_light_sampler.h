// SPDX-License-Identifier: Apache-2.0
/// Light samplers that draw a light below a node of a cut through a light tree, a cut that follows
/// from the point x.
///
///   point ─▶ cut (light_cut.h) ─▶ one of its m nodes, all alike ─▶ down the tree to a light l
///   pmf(l | x) = product of the probabilities from the node of the cut that is above l down to l,
///                over m
///
/// which is exact, since the cut depends on nothing but x. Lights at infinity are a part like those
/// of the cut. Integrators that draw m lights at a point draw one of each part.
///
/// A rule is constructed from parameters and prepared with the tree; it tells which nodes are
/// divided, `judge` and `tolerance` (see `cut_tree`), and how a walk goes down: `children`.
#pragma once

#include "plugins/light_samplers/lights/light_cut.h"
#include "plugins/light_samplers/lights/light_groups.h"

namespace lucerna {

template <typename Rule>
class CutLightSampler final : public LightSampler {
public:
    explicit CutLightSampler(const Params& params)
        : parts_(static_cast<std::size_t>(params.int32(
              "parts", 8, {.min = 2, .max = static_cast<double>(most_cut_nodes)},
              "most parts of the lights at a point; one of them is at infinity if there are such "
              "lights"))),
          rule_(params) {}

    void prepare(const Scene& scene) override {
        groups_ = LightGroups(scene);
        tree_ = LightBVH(scene);
        rule_.prepare(tree_);
    }

    struct Distribution {
        std::optional<LightChoice> sample(double u) const;
        float pmf(std::uint32_t light) const;
        std::size_t parts() const { return count + (sampler->groups_.infinite() > 0 ? 1 : 0); }
        float share() const { return 1 / static_cast<float>(parts()); }

        const CutLightSampler* sampler;
        Receiver receiver;
        std::size_t count;                    ///< of the nodes of the cut
        std::uint32_t nodes[most_cut_nodes];  ///< in ascending order
    };
    Distribution at(const Receiver& receiver) const {
        Distribution result{this, receiver, 0, {}};
        const auto judge = [&](std::uint32_t node) { return rule_.judge(tree_, node, receiver); };
        const std::size_t infinite = groups_.infinite() > 0 ? 1 : 0;
        result.count = cut_tree(tree_, parts_ - infinite, rule_.tolerance(), judge, result.nodes);
        return result;
    }
    std::size_t bytes() const override { return tree_.bytes() + rule_.bytes(); }

private:
    std::size_t parts_;
    Rule rule_;
    LightBVH tree_;
    LightGroups groups_;
};

template <typename Rule>
std::optional<LightChoice> CutLightSampler<Rule>::Distribution::sample(double u) const {
    if (parts() == 0) return {};
    const double place = u * static_cast<double>(parts());
    const std::size_t part = std::min(static_cast<std::size_t>(place), parts() - 1);
    const double rest = std::min(place - static_cast<double>(part), 1 - 0x1p-53);
    if (part == count) return sampler->groups_.draw_infinite(rest, share());
    const LightBVH& tree = sampler->tree_;
    return tree.descend(nodes[part], rest, share(), [&](std::uint32_t node) {
        return sampler->rule_.children(tree, node, receiver);
    });
}

template <typename Rule>
float CutLightSampler<Rule>::Distribution::pmf(std::uint32_t light) const {
    if (sampler->groups_.at_infinity(light)) return sampler->groups_.infinite_pmf(light, share());
    const LightBVH& tree = sampler->tree_;
    if (!tree.holds(light)) return 0;
    const auto in_cut = [&](std::uint32_t node) {
        return std::binary_search(nodes, nodes + count, node) ? share() : 0.0f;
    };
    return tree.pmf_of_descent(light, in_cut, [&](std::uint32_t node) {
        return sampler->rule_.children(tree, node, receiver);
    });
}

}  // namespace lucerna
