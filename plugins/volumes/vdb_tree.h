// SPDX-License-Identifier: Apache-2.0
/// What the nodes of an OpenVDB tree hold: the smallest and largest number of a box of voxels.
#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>

namespace lucerna {

/// Every voxel counts, whether it is active or not; for what has no node stands the background.
class VdbExtrema {
public:
    VdbExtrema(const openvdb::FloatTree& tree, const openvdb::CoordBBox& box) : box_(box) {
        add(tree.background());
        for (auto tile = tree.root().cbeginValueAll(); tile; ++tile) {
            const openvdb::CoordBBox extent =
                openvdb::CoordBBox::createCube(tile.getCoord(), Upper::DIM);
            if (extent.hasOverlap(box_)) add(*tile);
        }
        for (auto child = tree.root().cbeginChildOn(); child; ++child) visit(*child);
    }

    float smallest() const { return smallest_; }
    float largest() const { return largest_; }
    /// Whether all numbers can be compared: a NaN in their midst cannot.
    bool ordered() const { return ordered_; }

private:
    using Upper = openvdb::FloatTree::RootNodeType::ChildNodeType;
    using Leaf = openvdb::FloatTree::LeafNodeType;

    void add(float number) {
        smallest_ = std::min(smallest_, number);
        largest_ = std::max(largest_, number);
        ordered_ = ordered_ && number == number;
    }

    /// Calls `each` with the first voxel of every part of the node, `step` wide, in the box.
    template <typename Node, typename Each>
    void for_parts(const Node& node, int step, const Each& each) const {
        openvdb::CoordBBox part = node.getNodeBoundingBox();
        part.intersect(box_);
        const openvdb::Coord first = part.min() & ~(step - 1);
        for (int x = first.x(); x <= part.max().x(); x += step) {
            for (int y = first.y(); y <= part.max().y(); y += step) {
                for (int z = first.z(); z <= part.max().z(); z += step) each({x, y, z});
            }
        }
    }

    template <typename Node>
    void visit(const Node& node) {
        for_parts(node, Node::ChildNodeType::DIM, [&](const openvdb::Coord& at) {
            const openvdb::Index i = Node::coordToOffset(at);
            if (node.isChildMaskOn(i)) {
                visit(*node.getTable()[i].getChild());
            } else {
                add(node.getTable()[i].getValue());
            }
        });
    }
    void visit(const Leaf& leaf) {
        const float* const numbers = leaf.buffer().data();
        for_parts(leaf, 1,
                  [&](const openvdb::Coord& at) { add(numbers[Leaf::coordToOffset(at)]); });
    }

    openvdb::CoordBBox box_;
    float smallest_ = std::numeric_limits<float>::infinity();
    float largest_ = -std::numeric_limits<float>::infinity();
    bool ordered_ = true;
};

}  // namespace lucerna
