// SPDX-License-Identifier: Apache-2.0
/// The largest numbers of a grid, or eigenvalues: of each block of 8³ voxels, and so of any box.
#pragma once

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "plugins/volumes/voxel_grid.h"

#include <fmt/format.h>

#include <optional>

namespace lucerna {

/// A box of voxels, both ends included.
struct VoxelBox {
    Vector3i min, max;
};

class BlockMaxima {
public:
    BlockMaxima() = default;
    /// Reads the whole grid once, in parallel. Throws Error, which begins with `name`, for the
    /// first voxel that is negative, infinite or no number, or holds a matrix that is neither zero
    /// nor positive definite; `first` is what its message calls voxel (0, 0, 0).
    BlockMaxima(const VoxelGrid& grid, const std::string& name, Vector3i first = Vector3i(0));

    /// The smallest channel, or eigenvalue.
    float smallest() const { return smallest_; }
    float largest() const { return largest_; }
    /// The largest channel of all voxels of a box inside of the grid, exactly.
    float largest(const VoxelGrid& grid, const VoxelBox& box) const;
    std::size_t bytes() const { return maxima_.size() * sizeof(float); }

private:
    static constexpr int edge = 8;

    /// What a thread finds in a layer of blocks.
    struct Layer {
        float smallest = infinity;
        std::optional<std::size_t> bad;  ///< place of the first number that is refused
    };
    static void read_matrix(const VoxelGrid& grid, std::size_t place, float& largest, Layer& layer);
    static void read_channels(const VoxelGrid& grid, std::size_t place, float& largest,
                              Layer& layer);
    Layer read_layer(const VoxelGrid& grid, int block_z);
    float& maximum(Vector3i block) { return maxima_[index(block)]; }
    std::size_t index(Vector3i block) const {
        return (static_cast<std::size_t>(block.z) * static_cast<std::size_t>(blocks_.y) +
                static_cast<std::size_t>(block.y)) *
                   static_cast<std::size_t>(blocks_.x) +
               static_cast<std::size_t>(block.x);
    }
    static float scan(const VoxelGrid& grid, const VoxelBox& box);
    [[noreturn]] static void refuse(const VoxelGrid& grid, std::size_t place,
                                    const std::string& name, Vector3i first);

    Vector3i blocks_{0};
    std::vector<float> maxima_;
    float smallest_ = 0, largest_ = 0;
};

inline BlockMaxima::BlockMaxima(const VoxelGrid& grid, const std::string& name, Vector3i first)
    : blocks_((grid.resolution() + (edge - 1)) / edge) {
    maxima_.resize(index({0, 0, blocks_.z}));
    std::vector<Layer> layers(static_cast<std::size_t>(blocks_.z));
    Workers().run(blocks_.z, [&](std::int64_t z) {
        layers[static_cast<std::size_t>(z)] = read_layer(grid, static_cast<int>(z));
    });
    smallest_ = infinity;
    for (const Layer& layer : layers) {
        if (layer.bad) refuse(grid, *layer.bad, name, first);
        smallest_ = std::min(smallest_, layer.smallest);
    }
    largest_ = *std::max_element(maxima_.begin(), maxima_.end());
}

inline void BlockMaxima::read_matrix(const VoxelGrid& grid, std::size_t place, float& largest,
                                     Layer& layer) {
    const EigenvalueRange range = eigenvalues(grid.matrix(place));
    if (is_zero_or_positive_definite(range)) {
        largest = std::max(largest, static_cast<float>(range.largest));
        layer.smallest = std::min(layer.smallest, static_cast<float>(range.least));
    } else if (!layer.bad) {
        layer.bad = place;
    }
}

inline void BlockMaxima::read_channels(const VoxelGrid& grid, std::size_t place, float& largest,
                                       Layer& layer) {
    const std::size_t end = place + static_cast<std::size_t>(grid.channels());
    for (; place < end; ++place) {
        const float number = grid.number(place);
        if (number >= 0 && number < infinity) {
            largest = std::max(largest, number);
            layer.smallest = std::min(layer.smallest, number);
        } else if (!layer.bad) {
            layer.bad = place;
        }
    }
}

inline BlockMaxima::Layer BlockMaxima::read_layer(const VoxelGrid& grid, int block_z) {
    const Vector3i n = grid.resolution();
    const auto channels = static_cast<std::size_t>(grid.channels());
    Layer layer;
    for (int z = edge * block_z; z < std::min(n.z, edge * (block_z + 1)); ++z) {
        for (int y = 0; y < n.y; ++y) {
            std::size_t place = grid.place({0, y, z});
            for (int x = 0; x < n.x; ++x, place += channels) {
                float& largest = maximum({x / edge, y / edge, block_z});
                if (grid.has_matrices()) {
                    read_matrix(grid, place, largest, layer);
                } else {
                    read_channels(grid, place, largest, layer);
                }
            }
        }
    }
    return layer;
}

inline float BlockMaxima::scan(const VoxelGrid& grid, const VoxelBox& box) {
    float largest = 0;
    for (int z = box.min.z; z <= box.max.z; ++z) {
        for (int y = box.min.y; y <= box.max.y; ++y) {
            for (int x = box.min.x; x <= box.max.x; ++x) {
                largest = std::max(largest, grid.largest({x, y, z}));
            }
        }
    }
    return largest;
}

inline float BlockMaxima::largest(const VoxelGrid& grid, const VoxelBox& box) const {
    const Vector3i first = box.min / edge, last = box.max / edge;
    float largest = 0;
    for (int z = first.z; z <= last.z; ++z) {
        for (int y = first.y; y <= last.y; ++y) {
            for (int x = first.x; x <= last.x; ++x) {
                const Vector3i block(x, y, z);
                const float of_block = maxima_[index(block)];
                if (of_block <= largest) continue;
                const VoxelBox whole{block * edge,
                                     glm::min(block * edge + (edge - 1), grid.resolution() - 1)};
                const VoxelBox part{glm::max(whole.min, box.min), glm::min(whole.max, box.max)};
                const bool is_whole = part.min == whole.min && part.max == whole.max;
                largest = std::max(largest, is_whole ? of_block : scan(grid, part));
            }
        }
    }
    return largest;
}

inline void BlockMaxima::refuse(const VoxelGrid& grid, std::size_t place, const std::string& name,
                                Vector3i first) {
    const auto channels = static_cast<std::size_t>(grid.channels());
    const std::size_t voxel = place / channels;
    const auto nx = static_cast<std::size_t>(grid.resolution().x);
    const auto ny = static_cast<std::size_t>(grid.resolution().y);
    const Vector3i at = first + Vector3i(voxel % nx, voxel / nx % ny, voxel / nx / ny);
    if (grid.has_matrices()) {
        const SymmetricMatrix s = grid.matrix(place);
        throw Error(fmt::format(
            "{}: voxel ({}, {}, {}) is the matrix {:g}, {:g}, {:g}, {:g}, {:g}, {:g} (xx, yy, zz, "
            "xy, xz, yz); matrices must be positive definite, or zero",
            name, at.x, at.y, at.z, s.xx, s.yy, s.zz, s.xy, s.xz, s.yz));
    }
    throw Error(
        fmt::format("{}: voxel ({}, {}, {}) is {:g}; a volume holds finite numbers of at "
                    "least 0",
                    name, at.x, at.y, at.z, grid.number(place)));
}

}  // namespace lucerna
