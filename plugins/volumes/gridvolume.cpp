// SPDX-License-Identifier: Apache-2.0
/// gridvolume: numbers, colours or symmetric matrices on a regular grid, from a volume file of
/// Mitsuba (`.vol`).
///
/// The grid fills the unit cube of its own space: voxel (i, j, k) of n has its centre at
/// ((i, j, k) + ½) / n. Between centres, values are interpolated. Beyond the cube, which a medium
/// only reaches where `to_world` turns it against the axes of the world, `wrap_mode` continues it.
#include "plugins/volumes/vol_file.h"
#include "plugins/volumes/voxel_volume.h"

namespace lucerna {
namespace {

class GridVolume final : public VoxelVolume {
public:
    explicit GridVolume(const Params& params)
        : GridVolume(params, params.file("filename", "the volume file")) {}

private:
    GridVolume(const Params& params, const std::filesystem::path& path)
        : VoxelVolume(filter_parameter(params), params.choice("wrap_mode", GridWrap::clamp,
                                                              {{"clamp", GridWrap::clamp},
                                                               {"repeat", GridWrap::repeat},
                                                               {"mirror", GridWrap::mirror}},
                                                              "what lies beyond the grid")) {
        const bool use_file_bounds = params.boolean(
            "use_grid_bbox", false, "places the grid in the box that the file states");
        const Transform world_from_grid =
            volume_transform(params, "from the unit cube, which the grid fills, to the world");
        params.no_effect("raw", "the numbers of a volume are linear");
        params.no_effect("accel", "every look-up is interpolated with all bits");
        params.no_effect("max_value", "bounds are found from the voxels");
        if (path.empty()) return;

        VolFile file = read_vol(path);
        const std::string name = path.filename().string();
        for (const std::string& warning : file.warnings) params.warning("filename", warning);
        fill(std::move(file.grid), name);
        place_cube(use_file_bounds ? world_from_grid * box_from_cube(file.bounds, name)
                                   : world_from_grid);
    }

    static Transform box_from_cube(const Bounds3& box, const std::string& name) {
        const Vector3d min(box.min), extent = Vector3d(box.max) - min;
        const bool is_box = is_finite(box.min) && is_finite(box.max) && extent.x > 0 &&
                            extent.y > 0 && extent.z > 0;
        if (!is_box) {
            throw Error(fmt::format(
                "{}: its box from ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g}) is "
                "empty or not finite; leave \"use_grid_bbox\" out and place "
                "the grid with \"to_world\"",
                name, box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z));
        }
        return Transform::translate(min) * Transform::scale(extent);
    }

    void place_cube(const Transform& world_from_cube) {
        place(world_from_cube * Transform::scale(1.0 / Vector3d(voxels())),
              world_from_cube.bounds({.min = Vector3(0), .max = Vector3(1)}));
    }
};

}  // namespace

const PluginInfo plugin =
    describe<GridVolume>("numbers, colours or matrices on a grid, from a file");

}  // namespace lucerna
