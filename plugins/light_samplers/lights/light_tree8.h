// SPDX-License-Identifier: Apache-2.0
/// A light tree of eight children to a node, which are weighed together.
///
/// A binary tree (light_tree.h) is collapsed: of the children of a node, the one whose lights are
/// most worth telling apart, power times squared size, is replaced by its own children until there
/// are eight. Leaves are weighed like single lights, with their exact planes.
#pragma once

#include "core/base/huge_pages.h"
#include "plugins/light_samplers/lights/finite_lights.h"

namespace lucerna {

class LightTree8 {
public:
    static constexpr std::uint32_t none = 0xffffffff;

    struct Choice {
        std::uint32_t light;
        float pmf;
    };
    struct Node {
        LightLanes lanes;
        std::uint32_t link[8];    ///< node, or light of the scene if the bit in `leaves` is set
        float strongest[8] = {};  ///< share of the strongest light in the child's intensity
        std::uint32_t parent = none;
        std::uint8_t slot = 0;  ///< of this node in its parent
        std::uint8_t leaves = 0;
        std::uint8_t count = 0;
    };

    /// A draw on its way from a node down to a light.
    class Walk {
    public:
        /// u in [0, 1).
        Walk(const ReceiverRegion& at, double u, std::uint32_t node = 0)
            : at_(at), u_(u), place_(node) {}

        /// The light at which it has ended. Empty: no light of the cluster that it met can reach
        /// the point.
        std::optional<Choice> choice() const {
            return pmf_ > 0 ? std::optional(Choice{place_, pmf_}) : std::nullopt;
        }

    private:
        friend LightTree8;
        ReceiverRegion at_;
        double u_;
        std::uint32_t place_;  ///< the node, at the end the light
        float pmf_ = 1;
    };

    LightTree8() = default;
    /// Of the lights of the scene that are somewhere and shine.
    explicit LightTree8(const Scene& scene);

    bool empty() const { return nodes_.empty(); }
    /// Number of lights.
    std::size_t count() const { return count_; }
    /// FiniteLights::unit.
    double unit() const { return unit_; }
    const Node& operator[](std::uint32_t i) const { return nodes_[i]; }
    /// Goes down by one node; false if the walk has ended. The tree must not be empty.
    bool step(Walk& walk) const;
    /// Ends all of them, step by step together: while one waits for memory, the others go on.
    void finish(std::span<Walk*> walks) const {
        for (const Walk* walk : walks) prefetch(*walk);
        while (!walks.empty()) {
            std::size_t left = 0;
            for (Walk* walk : walks) {
                if (!step(*walk)) continue;
                prefetch(*walk);
                walks[left++] = walk;
            }
            walks = walks.first(left);
        }
    }
    /// Draws one of the lights below a node; u in [0, 1). Empty: no light of the cluster that it
    /// met can reach the point.
    std::optional<Choice> sample(const ReceiverRegion& at, double u, std::uint32_t node = 0) const {
        if (nodes_.empty()) return {};
        Walk walk(at, u, node);
        while (step(walk)) {
        }
        return walk.choice();
    }
    /// The same number that `sample` reports for the light; zero if it is not below the node.
    float pmf(const ReceiverRegion& at, std::uint32_t light, std::uint32_t node = 0) const;
    /// Whether the light is in the tree, and its lane in a node.
    bool holds(std::uint32_t light) const { return place_[light] != none; }
    std::pair<const LightLanes*, std::size_t> lane(std::uint32_t light) const {
        return {&nodes_[place_[light] / 8].lanes, place_[light] % 8};
    }
    /// The lane of a node, which is not the first, in its parent.
    std::pair<const LightLanes*, std::size_t> lane_of_node(std::uint32_t node) const {
        return {&nodes_[nodes_[node].parent].lanes, nodes_[node].slot};
    }
    /// The node that a light of the tree is a child of. Nodes below another have larger indices,
    /// and no others come between them.
    std::uint32_t node_of(std::uint32_t light) const { return place_[light] / 8; }
    /// Whether a light of the tree is below a node.
    bool is_below(std::uint32_t light, std::uint32_t node) const {
        std::uint32_t above = node_of(light);
        while (above != none && above > node) above = nodes_[above].parent;
        return above == node;
    }
    std::size_t bytes() const {
        return nodes_.capacity() * sizeof(Node) + place_.capacity() * sizeof(std::uint32_t);
    }

private:
    using Weights = float[LightLanes::width];
    /// Asks the memory for what the next step will read.
    void prefetch(const Walk& walk) const {
        const auto* const node = reinterpret_cast<const char*>(&nodes_[walk.place_]);
        for (std::size_t i = 0; i < sizeof(Node); i += 64) __builtin_prefetch(node + i);
    }
    std::uint32_t collapse(const LightTree& binary, std::uint32_t root, std::uint32_t parent,
                           std::size_t slot);

    std::vector<Node, HugePages<Node>> nodes_;
    std::vector<std::uint32_t, HugePages<std::uint32_t>>
        place_;  ///< of each light of the scene: 8 · node + lane
    std::size_t count_ = 0;
    double unit_ = 1;
};

inline LightTree8::LightTree8(const Scene& scene) : place_(scene.lights().size(), none) {
    FiniteLights finite(scene);
    count_ = finite.lights.size();
    unit_ = finite.unit;
    if (finite.lights.empty()) return;
    const LightTree binary(std::move(finite.lights), Workers(scene.threads()));
    nodes_.reserve(binary.size() / 5 + 1);
    collapse(binary, 0, none, 0);
    nodes_.shrink_to_fit();
}

inline std::uint32_t LightTree8::collapse(const LightTree& binary, std::uint32_t root,
                                          std::uint32_t parent, std::size_t slot) {
    std::vector<std::uint32_t> children{root};
    const auto worth = [&](std::uint32_t i) {
        const LightTree::Node& node = binary[i];
        const float r = node.cluster.box.radius();
        return node.leaf ? -1.0f : node.cluster.power * (r * r);
    };
    while (children.size() < LightLanes::width) {
        const auto widest = std::max_element(children.begin(), children.end(),
                                             [&](auto a, auto b) { return worth(a) < worth(b); });
        if (worth(*widest) < 0) break;
        const std::uint32_t node = *widest;
        *widest = node + 1;
        children.push_back(binary[node].link);
    }
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    nodes_[index].parent = parent;
    nodes_[index].slot = static_cast<std::uint8_t>(slot);
    nodes_[index].count = static_cast<std::uint8_t>(children.size());
    for (std::size_t i = 0; i < children.size(); ++i) {
        const LightTree::Node& child = binary[children[i]];
        set_lane(nodes_[index].lanes, i, child.cluster);
        nodes_[index].strongest[i] = child.cluster.strongest / child.cluster.power;
        if (child.leaf) {
            nodes_[index].leaves |= static_cast<std::uint8_t>(1u << i);
            nodes_[index].link[i] = child.link;
            place_[child.link] = 8 * index + static_cast<std::uint32_t>(i);
        } else {
            const std::uint32_t below = collapse(binary, children[i], index, i);
            nodes_[index].link[i] = below;
        }
    }
    return index;
}

inline bool LightTree8::step(Walk& walk) const {
    const Node& node = nodes_[walk.place_];
    Weights w;
    contributions(node.lanes, walk.at_, w);
    const float total = LightLanes::sum(w);
    if (!(total > 0)) {
        walk.pmf_ = 0;
        return false;
    }
    const double place = walk.u_ * static_cast<double>(total);
    double before = 0;
    std::size_t chosen = LightLanes::width;
    double start = 0;
    for (std::size_t i = 0; i < node.count; ++i) {
        if (!(w[i] > 0)) continue;
        if (chosen != LightLanes::width && place < before) break;
        chosen = i;
        start = before;
        before += static_cast<double>(w[i]);
    }
    walk.u_ = std::clamp((place - start) / static_cast<double>(w[chosen]), 0.0, 1 - 0x1p-53);
    walk.pmf_ *= w[chosen] / total;
    walk.place_ = node.link[chosen];
    return walk.pmf_ > 0 && (node.leaves >> chosen & 1) == 0;
}

inline float LightTree8::pmf(const ReceiverRegion& at, std::uint32_t light,
                             std::uint32_t top) const {
    if (!holds(light)) return 0;
    // The path is known from below; the product is taken from above, as when drawing.
    std::array<std::uint32_t, 80> path;
    std::size_t length = 0;
    for (std::uint32_t at_lane = place_[light];;) {
        path[length++] = at_lane;
        if (at_lane / 8 == top) break;
        if (at_lane / 8 < top) return 0;
        const Node& node = nodes_[at_lane / 8];
        at_lane = 8 * node.parent + node.slot;
    }
    float pmf = 1;
    while (length-- > 0 && pmf > 0) {
        Weights w;
        contributions(nodes_[path[length] / 8].lanes, at, w);
        const float total = LightLanes::sum(w);
        if (!(total > 0)) return 0;
        pmf *= w[path[length] % 8] / total;
    }
    return pmf;
}

}  // namespace lucerna
