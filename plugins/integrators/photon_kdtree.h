// SPDX-License-Identifier: Apache-2.0
/// A balanced k-d tree of photons without pointers (after Bentley 1975; Jensen 2001, 6).
///
/// Photons are sorted in place into blocks of eight, the leaves. A node is a range of blocks and
/// splits it in the middle, so ranges follow from the number of photons alone, and the plane
/// between blocks m − 1 and m is element m of one array: 1 byte for each photon.
#pragma once

#include "core/base/parallel.h"
#include "core/math/bounds.h"
#include "plugins/integrators/photon.h"

#include <vector>

namespace lucerna {

class PhotonKdTree {
public:
    PhotonKdTree() = default;
    /// The order of the photons, and so of all sums, does not depend on the number of threads.
    PhotonKdTree(std::vector<Photon> photons, const Workers& workers);

    const std::vector<Photon>& photons() const { return photons_; }
    std::size_t bytes() const {
        return photons_.capacity() * sizeof(Photon) + splits_.capacity() * sizeof(Split);
    }

    /// Calls visit(photon, distance²) for photons with distance² < radius2 around `p`. `visit` may
    /// make radius2 smaller; near photons come first, roughly.
    template <typename Visit>
    void search(Vector3 p, float& radius2, Visit&& visit) const;

    /// Photons of a leaf, but for the last one, which may have fewer.
    static constexpr std::uint32_t block = 8;
    /// A node: blocks begin, …, end − 1.
    struct Range {
        std::uint32_t begin, end;
        bool leaf() const { return end - begin <= 1; }
        std::uint32_t middle() const { return begin + (end - begin) / 2; }
    };
    Range root() const { return {0, static_cast<std::uint32_t>(splits_.size())}; }

private:
    struct Split {
        float position = 0;
        int axis = 0;
    };

    void split(Range range);
    void split_all(Range range);

    std::vector<Photon> photons_;
    std::vector<Split> splits_;
};

inline PhotonKdTree::PhotonKdTree(std::vector<Photon> photons, const Workers& workers)
    : photons_(std::move(photons)) {
    const auto blocks = static_cast<std::uint32_t>((photons_.size() + block - 1) / block);
    splits_.resize(blocks);
    // Some levels breadth first, until there are enough subtrees for all threads.
    std::vector<Range> ranges = {{0, blocks}};
    for (int level = 0; level < 8; ++level) {
        workers.run(std::ssize(ranges),
                    [&](std::int64_t i) { split(ranges[static_cast<std::size_t>(i)]); });
        std::vector<Range> halves;
        for (const Range& r : ranges) {
            if (r.leaf()) continue;
            halves.push_back({r.begin, r.middle()});
            halves.push_back({r.middle(), r.end});
        }
        ranges = std::move(halves);
    }
    workers.run(std::ssize(ranges),
                [&](std::int64_t i) { split_all(ranges[static_cast<std::size_t>(i)]); });
}

/// Across the widest side of the photons' bounds.
inline void PhotonKdTree::split(Range range) {
    if (range.leaf()) return;
    const auto at = [&](std::uint32_t i) {
        return photons_.begin() +
               std::min<std::ptrdiff_t>(std::ptrdiff_t{i} * block, std::ssize(photons_));
    };
    const auto begin = at(range.begin), middle = at(range.middle()), end = at(range.end);
    Bounds3 bounds;
    for (auto photon = begin; photon != end; ++photon) bounds.include(photon->p());
    const Vector3 side = bounds.extent();
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    std::nth_element(begin, middle, end, [axis](const Photon& a, const Photon& b) {
        return a.p()[axis] < b.p()[axis];
    });
    splits_[range.middle()] = {middle->p()[axis], axis};
}

inline void PhotonKdTree::split_all(Range range) {
    if (range.leaf()) return;
    split(range);
    split_all({range.begin, range.middle()});
    split_all({range.middle(), range.end});
}

/// Depth first, the nearer half before the other. The distance to the box of a node grows by one
/// coordinate at each split (Arya and Mount 1993, "Algorithms for Fast Vector Quantization").
template <typename Visit>
void PhotonKdTree::search(Vector3 p, float& radius2, Visit&& visit) const {
    struct Pending {
        Range range;
        Vector3 offset;  ///< from p to the box, along each axis
        float distance2;
    };
    Pending stack[32];
    int size = 0;
    Pending node{root(), Vector3(0), 0};
    while (true) {
        while (!node.range.leaf()) {
            const std::uint32_t middle = node.range.middle();
            const Split split = splits_[middle];
            const float d = p[split.axis] - split.position;
            Pending far = node;
            (d < 0 ? node.range.end : node.range.begin) = middle;
            (d < 0 ? far.range.begin : far.range.end) = middle;
            far.distance2 += d * d - sqr(far.offset[split.axis]);
            far.offset[split.axis] = d;
            if (far.distance2 < radius2) stack[size++] = far;
        }
        const std::size_t begin = std::size_t{node.range.begin} * block;
        const std::size_t end = std::min(std::size_t{node.range.end} * block, photons_.size());
        for (std::size_t i = begin; i < end; ++i) {
            const Vector3 v = photons_[i].p() - p;
            const float distance2 = glm::dot(v, v);
            if (distance2 < radius2) visit(photons_[i], distance2);
        }
        do {
            if (size == 0) return;
            node = stack[--size];
        } while (!(node.distance2 < radius2));
    }
}

}  // namespace lucerna
