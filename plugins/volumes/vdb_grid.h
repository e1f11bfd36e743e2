// SPDX-License-Identifier: Apache-2.0
/// What the readers of OpenVDB and NanoVDB files share: sparse grids made dense, and the choice of
/// one grid of several by its name.
///
/// A sparse grid has a value for each integer index (i, j, k), whose place is `world_from_index`
/// of it; values lie between by interpolation, as the libraries' own samplers have it. The dense
/// grid holds the box of the active voxels and a layer of one voxel around it, so that it shows how
/// values fall to the background.
#pragma once

#include "core/math/transform.h"
#include "plugins/volumes/block_maxima.h"
#include "plugins/volumes/voxel_grid.h"

#include <string>
#include <vector>

namespace lucerna {

struct VdbGrid {
    VoxelGrid voxels;
    Vector3i first{0};           ///< index of voxel (0, 0, 0)
    Transform world_from_index;  ///< affine
};

/// Which of the grids `names` is meant: the one called `wanted`; if that is empty, the only one or
/// "density". Throws Error, which begins with the file's name.
std::size_t choose_grid(const std::vector<std::string>& names, const std::string& wanted,
                        const std::string& file);

/// Throws Error, which begins with `what`, unless the class of a grid, as OpenVDB calls it, is one
/// whose values are what a volume holds: fog volume, or none.
void check_class(const std::string& what, const std::string& grid_class);

/// The box of active voxels and the layer around it; if there are none (min > max), of index
/// (0, 0, 0). Throws Error, which begins with `what`, if its voxels need more than `memory` bytes.
VoxelBox dense_box(const VoxelBox& active, int channels, const std::string& what,
                   std::uint64_t memory);

/// Zeros (float32) for all voxels of `dense_box`, which also tells the errors.
VdbGrid dense_grid(const VoxelBox& active, int channels, const Transform& world_from_index,
                   const std::string& what, std::uint64_t memory);

/// `world_from_index` of three columns and an offset. Throws Error, which begins with `what`, if
/// they are no transform.
Transform index_transform(const Matrix4d& matrix, const std::string& what);

}  // namespace lucerna
