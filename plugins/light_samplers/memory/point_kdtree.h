// SPDX-License-Identifier: Apache-2.0
/// The closest of some points (Bentley 1975): a balanced tree without pointers. A node stands in
/// the middle of its range of the array, and its children in the middles of the two halves.
#pragma once

#include "core/math/bounds.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace lucerna {

class PointKdTree {
public:
    static constexpr std::uint32_t none = 0xffffffff;

    PointKdTree() = default;
    explicit PointKdTree(const std::vector<Vector3>& points) {
        nodes_.reserve(points.size());
        for (std::uint32_t i = 0; i < points.size(); ++i) nodes_.push_back({points[i], i, 0});
        sort(0, nodes_.size());
    }

    /// Index of the point closest to `p`, but not `except`; none if there is no other.
    std::uint32_t closest(Vector3 p, std::uint32_t except = none) const {
        Search search{p, except};
        look(0, nodes_.size(), search);
        return search.closest;
    }

private:
    struct Node {
        Vector3 p;
        std::uint32_t index;
        int axis;
    };
    struct Search {
        Vector3 p;
        std::uint32_t except;
        std::uint32_t closest = none;
        float distance2 = infinity;
    };

    void sort(std::size_t begin, std::size_t end) {
        if (end - begin < 2) return;
        Bounds3 box;
        for (std::size_t i = begin; i < end; ++i) box.include(nodes_[i].p);
        const Vector3 e = box.extent();
        const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
        const std::size_t middle = begin + (end - begin) / 2;
        const auto at = [&](std::size_t i) {
            return nodes_.begin() + static_cast<std::ptrdiff_t>(i);
        };
        std::nth_element(at(begin), at(middle), at(end), [axis](const Node& a, const Node& b) {
            return a.p[axis] != b.p[axis] ? a.p[axis] < b.p[axis] : a.index < b.index;
        });
        nodes_[middle].axis = axis;
        sort(begin, middle);
        sort(middle + 1, end);
    }

    void look(std::size_t begin, std::size_t end, Search& search) const {
        while (begin < end) {
            const std::size_t middle = begin + (end - begin) / 2;
            const Node& node = nodes_[middle];
            const Vector3 d = search.p - node.p;
            const float distance2 = glm::dot(d, d);
            if (distance2 < search.distance2 && node.index != search.except) {
                search.distance2 = distance2;
                search.closest = node.index;
            }
            const float across = d[node.axis];
            if (across < 0) {
                look(begin, middle, search);
                begin = middle + 1;
            } else {
                look(middle + 1, end, search);
                end = middle;
            }
            if (!(across * across < search.distance2)) return;
        }
    }

    std::vector<Node> nodes_;
};

}  // namespace lucerna
