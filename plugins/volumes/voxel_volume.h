// SPDX-License-Identifier: Apache-2.0
/// A volume of voxels on a regular grid, wherever they come from: look-ups and their bounds.
///
/// In the space of voxels, voxel i reaches from i to i + 1 along each axis, and its number is the
/// value at its centre.
#pragma once

#include "core/interfaces/volume.h"
#include "plugins/volumes/block_maxima.h"
#include "plugins/volumes/grid_axis.h"
#include "plugins/volumes/volume_space.h"

namespace lucerna {

class VoxelVolume : public Volume {
public:
    Color color(Vector3 p) const override {
        return at<Color>(p, [this](Vector3i voxel) { return grid_.color(voxel); });
    }
    float real(Vector3 p) const override {
        return at<float>(p, [this](Vector3i voxel) { return grid_.real(voxel); });
    }
    bool has_matrices() const override { return grid_.has_matrices(); }
    SymmetricMatrix matrix(Vector3 p) const override {
        return at<SymmetricMatrix>(
            p, [this](Vector3i voxel) { return grid_.matrix(grid_.place(voxel)); });
    }
    Bounds3 bounds() const override { return bounds_; }
    glm::ivec3 resolution() const override {
        return rounded_resolution(space_.voxels_along(bounds_.extent()));
    }
    float max(const Bounds3& box) const override;

protected:
    static GridFilter filter_parameter(const Params& params) {
        return params.choice(
            "filter_type", GridFilter::trilinear,
            {{"trilinear", GridFilter::trilinear}, {"nearest", GridFilter::nearest}},
            "how voxels are interpolated");
    }

    VoxelVolume(GridFilter filter, GridWrap wrap) : filter_(filter), wrap_(wrap) {}

    /// Takes the numbers. Throws Error, which begins with `name`, for one that no volume holds;
    /// `first` is what its message calls voxel (0, 0, 0).
    void fill(VoxelGrid grid, const std::string& name, Vector3i first = Vector3i(0)) {
        grid_ = std::move(grid);
        maxima_ = BlockMaxima(grid_, name, first);
    }
    /// `bounds`, of the world, is where the volume ends.
    void place(const Transform& world_from_voxels, const Bounds3& bounds) {
        space_ = VolumeSpace(world_from_voxels);
        bounds_ = bounds;
    }
    Vector3i voxels() const { return grid_.resolution(); }

private:
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

    GridFilter filter_;
    GridWrap wrap_;
    VoxelGrid grid_;
    BlockMaxima maxima_;
    VolumeSpace space_;
    Bounds3 bounds_{.min = Vector3(0), .max = Vector3(1)};
};

inline float VoxelVolume::max(const Bounds3& box) const {
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

}  // namespace lucerna
