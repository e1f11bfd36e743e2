// SPDX-License-Identifier: Apache-2.0
/// gridvolume: numbers or colours on a regular grid, from a volume file of Mitsuba (`.vol`).
///
/// The grid fills the unit cube of its own space: voxel (i, j, k) of n has its centre at
/// ((i, j, k) + ½) / n. Between centres, values are interpolated. Beyond the cube, which a medium
/// only reaches where `to_world` turns it against the axes of the world, `wrap_mode` continues it.
#include "core/interfaces/volume.h"
#include "plugins/volumes/block_maxima.h"
#include "plugins/volumes/grid_axis.h"
#include "plugins/volumes/vol_file.h"
#include "plugins/volumes/volume_space.h"

namespace lucerna {
namespace {

class GridVolume final : public Volume {
public:
    explicit GridVolume(const Params& params) {
        const std::filesystem::path path = params.file("filename", "the volume file");
        filter_ =
            params.choice("filter_type", GridFilter::trilinear,
                          {{"trilinear", GridFilter::trilinear}, {"nearest", GridFilter::nearest}},
                          "how voxels are interpolated");
        wrap_ = params.choice("wrap_mode", GridWrap::clamp,
                              {{"clamp", GridWrap::clamp},
                               {"repeat", GridWrap::repeat},
                               {"mirror", GridWrap::mirror}},
                              "what lies beyond the grid");
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
        grid_ = std::move(file.grid);
        maxima_ = BlockMaxima(grid_, name);
        place(use_file_bounds ? world_from_grid * box_from_cube(file.bounds, name)
                              : world_from_grid);
    }

    Color color(Vector3 p) const override {
        return at<Color>(p, [this](Vector3i voxel) { return grid_.color(voxel); });
    }
    float real(Vector3 p) const override {
        return at<float>(p, [this](Vector3i voxel) { return grid_.real(voxel); });
    }
    Bounds3 bounds() const override { return bounds_; }
    glm::ivec3 resolution() const override {
        return rounded_resolution(space_.voxels_along(bounds_.extent()));
    }
    float max(const Bounds3& box) const override;

private:
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

    void place(const Transform& world_from_cube) {
        const Vector3d n(grid_.resolution());
        space_ = VolumeSpace(world_from_cube * Transform::scale(1.0 / n));
        bounds_ = world_from_cube.bounds({.min = Vector3(0), .max = Vector3(1)});
    }

    template <typename Value, typename Fetch>
    Value at(Vector3 p, const Fetch& fetch) const {
        const Vector3d q = space_.point(p);
        const Vector3i n = grid_.resolution();
        const Between x = between(q.x, n.x, filter_, wrap_);
        const Between y = between(q.y, n.y, filter_, wrap_);
        const Between z = between(q.z, n.z, filter_, wrap_);
        if (filter_ == GridFilter::nearest) return fetch({x.first, y.first, z.first});
        const auto row = [&](int j, int k) {
            return mixed(fetch({x.first, j, k}), fetch({x.second, j, k}), x.t);
        };
        const Value near = mixed(row(y.first, z.first), row(y.second, z.first), y.t);
        const Value far = mixed(row(y.first, z.second), row(y.second, z.second), y.t);
        return mixed(near, far, z.t);
    }

    VoxelGrid grid_;
    BlockMaxima maxima_;
    GridFilter filter_;
    GridWrap wrap_;
    VolumeSpace space_;
    Bounds3 bounds_{.min = Vector3(0), .max = Vector3(1)};
};

float GridVolume::max(const Bounds3& box) const {
    const Bounds3 inside = intersection(box, bounds_);
    if (inside.empty()) return 0;
    const Bounds3d voxels = space_.box(inside);
    const Vector3i n = grid_.resolution();
    std::array<std::array<VoxelRange, 2>, 3> ranges;
    for (int k = 0; k < 3; ++k) {
        ranges[static_cast<std::size_t>(k)] =
            wrapped(reach(voxels.min[k], voxels.max[k], filter_), n[k], wrap_);
    }
    float largest = 0;
    for (const VoxelRange x : ranges[0]) {
        for (const VoxelRange y : ranges[1]) {
            for (const VoxelRange z : ranges[2]) {
                if (x.first > x.last || y.first > y.last || z.first > z.last) continue;
                const VoxelBox part{{x.first, y.first, z.first}, {x.last, y.last, z.last}};
                largest = std::max(largest, maxima_.largest(grid_, part));
            }
        }
    }
    return largest;
}

}  // namespace

const PluginInfo plugin = describe<GridVolume>("numbers or colours on a grid, from a file");

}  // namespace lucerna
