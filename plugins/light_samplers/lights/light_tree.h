// SPDX-License-Identifier: Apache-2.0
/// A binary tree over lights that are somewhere: what light trees of any width are made from.
///
/// Top down, the split of least cost among 12 buckets along each axis, where a cluster of power Φ
/// costs Φ M_Ω K A (Conty Estevez and Kulla 2018; pbrt 4e, 12.6.3). At depth 40 and below clusters
/// are halved by number, so that a path fits into 64 bits. `pbrt_rules` make pbrt's tree.
#pragma once

#include "core/base/parallel.h"
#include "core/interfaces/emitter.h"

#include <array>
#include <bit>
#include <vector>

namespace lucerna {

/// Lights, as far as their sum can be bounded: where they are, where they shine, how strongly.
struct LightCluster {
    Bounds3 box;
    Vector3 axis{0, 0, 1};  ///< of the cone of normals
    float cos_normals = 1;
    float cos_emission = 1;
    float power = 0;      ///< in the unit of whoever builds the tree; zero: no lights
    float strongest = 0;  ///< power of the strongest light in it
    /// Of a single planar light: how far its plane is in front of the centre of the box.
    /// Negative: not known.
    float plane = -1;
    bool two_sided = false;

    /// Whether all normals are one, and all shine to no more than the side of it.
    bool is_flat() const {
        return cos_normals >= 1 - 1e-6f && cos_emission >= -1e-4f && !two_sided;
    }
    void include(const LightCluster& other);
};

/// One light of a tree.
struct TreeLight {
    LightCluster cluster;
    std::uint32_t light = 0;  ///< index in the scene
};

/// How splits are chosen. Those of pbrt are coarser, and depend on rounding in symmetric places.
struct LightTreeRules {
    std::size_t first_split = 0;  ///< splits come after this bucket or a later one
    float line_area = 1e-6f;      ///< area of a cluster on a line, over its squared extent
    /// Added to places along an axis [buckets], so that lights in symmetric places fall alike in
    /// any unit of length.
    float shift = 1e-3f;
    float clearly_less = 0.9999f;  ///< a later split must cost less than this times the best
    bool upwards = false;          ///< clusters above a split are united in ascending order
};
inline constexpr LightTreeRules pbrt_rules{
    .first_split = 1, .line_area = 0, .shift = 0, .clearly_less = 1, .upwards = true};

/// Angle between unit vectors, exact where it is small or near π.
inline float angle_between(Vector3 a, Vector3 b) {
    if (glm::dot(a, b) < 0) return pi - 2 * std::asin(std::min(0.5f * glm::length(a + b), 1.0f));
    return 2 * std::asin(std::min(0.5f * glm::length(b - a), 1.0f));
}

inline void LightCluster::include(const LightCluster& other) {
    if (!(other.power > 0)) return;
    if (!(power > 0)) {
        *this = other;
        return;
    }
    box.include(other.box);
    power += other.power;
    strongest = std::max(strongest, other.strongest);
    plane = -1;
    cos_emission = std::min(cos_emission, other.cos_emission);
    two_sided |= other.two_sided;
    if (axis == other.axis || cos_normals <= -1) {
        cos_normals = std::min(cos_normals, other.cos_normals);
        return;
    }
    const float a = std::acos(cos_normals), b = std::acos(std::max(other.cos_normals, -1.0f));
    const float d = angle_between(axis, other.axis);
    if (std::min(d + b, pi) <= a) return;
    if (std::min(d + a, pi) <= b) {
        axis = other.axis;
        cos_normals = other.cos_normals;
        return;
    }
    const float angle = 0.5f * (a + d + b);
    if (!(angle < pi) || !(d < 0.999f * pi)) {
        cos_normals = -1;
        return;
    }
    // Turn the axis towards the other one.
    const float turn = angle - a;
    axis = glm::normalize(axis * std::sin(d - turn) + other.axis * std::sin(turn));
    cos_normals = std::cos(angle) - 1e-6f;
}

/// The integral of cos over the directions in which a cluster shines, had all of it the same
/// normal cone: M_Ω [sr].
inline float emission_measure(float cos_normals, float cos_emission) {
    const float theta_o = std::acos(std::clamp(cos_normals, -1.0f, 1.0f));
    const float theta_e = std::acos(std::clamp(cos_emission, -1.0f, 1.0f));
    const float theta_w = std::min(theta_o + theta_e, pi);
    const float sin_o = std::sin(theta_o), cos_o = std::cos(theta_o);
    return 2 * pi * (1 - cos_o) + 0.5f * pi *
                                      (2 * theta_w * sin_o - std::cos(theta_o - 2 * theta_w) -
                                       2 * theta_o * sin_o + cos_o);
}

class LightTree {
public:
    /// Inner nodes stand before their children; the first child is the next node.
    struct Node {
        LightCluster cluster;
        /// The second child; of a leaf, the index of its light in the scene.
        std::uint32_t link = 0;
        bool leaf = false;
    };

    LightTree() = default;
    LightTree(std::vector<TreeLight> lights, const Workers& workers,
              const LightTreeRules& rules = {})
        : rules_(rules), lights_(std::move(lights)) {
        build(workers);
    }

    bool empty() const { return nodes_.empty(); }
    const Node& operator[](std::uint32_t i) const { return nodes_[i]; }
    std::uint32_t size() const { return static_cast<std::uint32_t>(nodes_.size()); }

private:
    static constexpr int buckets = 12;
    static constexpr int halving_depth = 40;
    struct Range {
        std::uint32_t begin, end, node;
        int depth;
        std::uint32_t count() const { return end - begin; }
    };
    struct Split {
        int axis = -1;
        int bucket = 0;
        float low = 0, width = 0, shift = 0;
        int bucket_of(const LightCluster& c) const {
            const float x = buckets * ((c.box.center()[axis] - low) / width) + shift;
            return std::min(static_cast<int>(x), buckets - 1);
        }
    };

    using Bins = std::array<LightCluster, buckets>;

    void build(const Workers& workers);
    void build_below(const Range& range);
    std::array<Range, 2> divide(const Range& range);
    Split best_split(const Range& range) const;
    Bins clusters_above(const Bins& bins) const;

    LightTreeRules rules_;
    std::vector<TreeLight> lights_;
    std::vector<Node> nodes_;
};

inline void LightTree::build(const Workers& workers) {
    if (lights_.empty()) return;
    const auto count = static_cast<std::uint32_t>(lights_.size());
    nodes_.resize(2 * std::size_t{count} - 1);
    // A few large ranges first, then all of them at once: each has its own nodes.
    std::vector<Range> open{{0, count, 0, 0}}, ready;
    const std::uint32_t share = std::max(count / 64, 1024u);
    while (!open.empty()) {
        const Range range = open.back();
        open.pop_back();
        if (range.count() <= share) {
            ready.push_back(range);
            continue;
        }
        for (const Range& part : divide(range)) open.push_back(part);
    }
    workers.run(static_cast<std::int64_t>(ready.size()),
                [&](std::int64_t i) { build_below(ready[static_cast<std::size_t>(i)]); });
    for (std::size_t i = nodes_.size(); i-- > 0;) {
        Node& node = nodes_[i];
        if (node.leaf) continue;
        node.cluster = nodes_[i + 1].cluster;
        node.cluster.include(nodes_[node.link].cluster);
    }
    lights_ = {};
}

inline void LightTree::build_below(const Range& range) {
    if (range.count() == 1) {
        const TreeLight& light = lights_[range.begin];
        nodes_[range.node] = {.cluster = light.cluster, .link = light.light, .leaf = true};
        return;
    }
    for (const Range& part : divide(range)) build_below(part);
}

/// Sorts the lights of a range into two parts.
inline std::array<LightTree::Range, 2> LightTree::divide(const Range& range) {
    const auto first = lights_.begin() + range.begin, last = lights_.begin() + range.end;
    const std::uint32_t half = range.begin + range.count() / 2;
    std::uint32_t middle = half;
    if (const Split split = range.depth < halving_depth ? best_split(range) : Split();
        split.axis >= 0) {
        const auto it = std::partition(first, last, [&](const TreeLight& light) {
            return split.bucket_of(light.cluster) <= split.bucket;
        });
        middle = static_cast<std::uint32_t>(it - lights_.begin());
        if (middle == range.begin || middle == range.end) middle = half;
    }
    const std::uint32_t second = range.node + 2 * (middle - range.begin);
    nodes_[range.node].link = second;
    return {Range{range.begin, middle, range.node + 1, range.depth + 1},
            Range{middle, range.end, second, range.depth + 1}};
}

inline LightTree::Split LightTree::best_split(const Range& range) const {
    Bounds3 box, centers;
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
        box.include(lights_[i].cluster.box);
        centers.include(lights_[i].cluster.box.center());
    }
    const Vector3 extent = box.extent();
    const float longest = max_component(extent);
    const auto cost = [&](const LightCluster& c, int axis) {
        if (!(c.power > 0)) return 0.0f;
        const Vector3 e = c.box.extent();
        const float area =
            2 * (e.x * e.y + e.y * e.z + e.z * e.x) + rules_.line_area * sqr(longest);
        return c.power * emission_measure(c.cos_normals, c.cos_emission) * area * longest /
               extent[axis];
    };
    std::array<Bins, 3> bins;
    std::array<Split, 3> splits;
    for (int axis = 0; axis < 3; ++axis) {
        const float width = centers.extent()[axis];
        if (!(width > 0)) continue;
        splits[static_cast<std::size_t>(axis)] = {axis, 0, centers.min[axis], width, rules_.shift};
    }
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (splits[axis].axis < 0) continue;
            const LightCluster& c = lights_[i].cluster;
            bins[axis][static_cast<std::size_t>(splits[axis].bucket_of(c))].include(c);
        }
    }
    Split best;
    float least = infinity;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (splits[axis].axis < 0) continue;
        const Bins above = clusters_above(bins[axis]);
        LightCluster below;
        for (std::size_t i = 0; i + 1 < buckets; ++i) {
            below.include(bins[axis][i]);
            if (i < rules_.first_split) continue;
            const int dimension = static_cast<int>(axis);
            const float sum = cost(below, dimension) + cost(above[i], dimension);
            if (!(sum > 0 && sum < rules_.clearly_less * least)) continue;  // ties: the first
            least = sum;
            best = splits[axis];
            best.bucket = static_cast<int>(i);
        }
    }
    return best;
}

/// For each bucket, the union of all buckets above it, whose rounding depends on their order.
inline LightTree::Bins LightTree::clusters_above(const Bins& bins) const {
    Bins above;
    for (std::size_t i = buckets - 1; i-- > 0;) {
        if (rules_.upwards) {
            for (std::size_t k = i + 1; k < buckets; ++k) above[i].include(bins[k]);
        } else {
            above[i] = above[i + 1];
            above[i].include(bins[i + 1]);
        }
    }
    return above;
}

}  // namespace lucerna
