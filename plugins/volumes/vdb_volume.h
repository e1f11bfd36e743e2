// SPDX-License-Identifier: Apache-2.0
/// A volume from a file of sparse grids, and the parameters that `openvdb` and `nanovdb` share.
///
///   filename      path
///   grid          string             name of the grid; the only one, or "density"
///   filter_type   string  trilinear  how voxels are interpolated: trilinear or nearest
///   to_world      transform          from the space of the file to the world
///
/// The volume ends where interpolation reaches no active voxel any more. What lies beyond, in the
/// corners of the box around a grid that is turned against the axes of the world, is the background
/// at the ends of the grid.
#pragma once

#include "plugins/volumes/vdb_grid.h"
#include "plugins/volumes/voxel_volume.h"

namespace lucerna {

class VdbVolume : public VoxelVolume {
protected:
    /// Reads one grid of a file, by the name of the grid.
    using Read = VdbGrid (*)(const std::filesystem::path&, const std::string&);

    VdbVolume(const Params& params, Read read)
        : VdbVolume(params, read, params.file("filename", "a file of sparse grids"),
                    params.string("grid", "", "its name; the only one, or \"density\"")) {}

private:
    VdbVolume(const Params& params, Read read, const std::filesystem::path& path,
              const std::string& name)
        : VoxelVolume(filter_parameter(params), GridWrap::clamp) {
        const Transform world_from_file =
            volume_transform(params, "from the space of the file to the world");
        if (path.empty()) return;
        VdbGrid grid = read(path, name);
        const Vector3 n(grid.voxels.resolution());
        const Transform world_from_voxels = world_from_file * grid.world_from_index *
                                            Transform::translate(Vector3d(grid.first) - 0.5);
        fill(std::move(grid.voxels), path.filename().string(), grid.first);
        place(world_from_voxels, world_from_voxels.bounds({.min = Vector3(0.5f), .max = n - 0.5f}));
    }
};

}  // namespace lucerna
