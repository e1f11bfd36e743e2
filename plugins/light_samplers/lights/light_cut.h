// SPDX-License-Identifier: Apache-2.0
/// Cuts through a light tree: sets of nodes that together hold each light once (Walter et al.
/// 2005).
///
/// From the root on, the node of the largest error is divided, until no error is above a part of
/// what all nodes contribute, or there are as many nodes as are allowed.
#pragma once

#include "plugins/light_samplers/lights/light_bvh.h"

#include <algorithm>
#include <array>

namespace lucerna {

/// What is known of a node that may be part of a cut.
struct CutNode {
    std::uint32_t node = 0;
    float contribution = 0;  ///< an estimate; zero: it is left out of the cut
    float error = 0;         ///< in the same unit; zero: it is not divided

    bool operator<(const CutNode& o) const {
        if (error != o.error) return error < o.error;
        return contribution != o.contribution ? contribution < o.contribution : node > o.node;
    }
};

/// Nodes of the largest cut.
inline constexpr std::size_t most_cut_nodes = 64;

/// Writes the nodes of a cut, no more than `most`, in ascending order, and returns how many;
/// `judge(node)` returns a CutNode.
template <typename Judge>
std::size_t cut_tree(const LightBVH& tree, std::size_t most, float tolerance, const Judge& judge,
                     std::uint32_t* nodes) {
    std::array<CutNode, most_cut_nodes> cut;  // a heap
    std::size_t count = 0;
    double total = 0;
    const auto add = [&](std::uint32_t node) {
        const CutNode judged = judge(node);
        if (!(judged.contribution > 0)) return;
        cut[count++] = judged;
        std::push_heap(cut.data(), cut.data() + count);
        total += static_cast<double>(judged.contribution);
    };
    if (!tree.empty()) add(0);
    while (count > 0 && count < std::min(most, most_cut_nodes)) {
        const CutNode widest = cut.front();
        if (!(static_cast<double>(widest.error) > static_cast<double>(tolerance) * total)) break;
        std::pop_heap(cut.data(), cut.data() + count--);
        total -= static_cast<double>(widest.contribution);
        add(widest.node + 1);
        add(tree[widest.node].link);
    }
    for (std::size_t i = 0; i < count; ++i) nodes[i] = cut[i].node;
    std::sort(nodes, nodes + count);
    return count;
}

/// What the lights below a node contribute, about: Φ cos θ' |cos θi'| / d² with the bounds of
/// light_bvh.h, d being no less than half the radius of the node.
inline float contribution(const LightBVH& tree, std::uint32_t node, const Receiver& at) {
    const LightBVH::View seen = tree.view(tree[node], at);
    return seen.power / std::max(seen.distance2, 0.25f * sqr(tree[node].radius));
}

/// An upper bound of it, from the point of the node's sphere that is nearest: infinite inside.
inline float largest_contribution(const LightBVH& tree, std::uint32_t node, const Receiver& at) {
    const LightBVH::View seen = tree.view(tree[node], at);
    const float gap = std::sqrt(seen.distance2) - tree[node].radius;
    return !(seen.power > 0) ? 0.0f : gap > 0 ? seen.power / sqr(gap) : infinity;
}

/// A walk down the tree in proportion to the contributions.
inline LightBVH::Children children_by_contribution(const LightBVH& tree, std::uint32_t node,
                                                   const Receiver& at) {
    return LightBVH::Children::in_proportion(contribution(tree, node + 1, at),
                                             contribution(tree, tree[node].link, at));
}

}  // namespace lucerna
