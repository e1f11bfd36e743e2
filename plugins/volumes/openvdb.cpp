// SPDX-License-Identifier: Apache-2.0
/// openvdb: numbers on a sparse grid, from an OpenVDB file.
///
/// The file places the grid in the world: its transform is honoured, and `to_world` comes after it.
/// Numbers stand at the voxels' indices, and are interpolated between them. The volume ends where
/// the interpolation of the outermost active voxels does, one voxel beyond them.
#include "core/base/file_bytes.h"
#include "core/interfaces/volume.h"
#include "plugins/volumes/grid_axis.h"
#include "plugins/volumes/vdb_reader.h"
#include "plugins/volumes/vdb_tree.h"
#include "plugins/volumes/volume_space.h"

namespace lucerna {
namespace {

std::string read_text(const std::filesystem::path& path) {
    const FileReader file(path);
    std::string bytes(file.size(), '\0');
    file.read(0, {reinterpret_cast<std::uint8_t*>(bytes.data()), bytes.size()});
    return bytes;
}

class OpenVdbVolume final : public Volume {
public:
    explicit OpenVdbVolume(const Params& params) {
        const std::filesystem::path path = params.file("filename", "the OpenVDB file");
        const std::string grid_name =
            params.string("grid_name", "density", "which grid of the file");
        filter_ =
            params.choice("filter_type", GridFilter::trilinear,
                          {{"trilinear", GridFilter::trilinear}, {"nearest", GridFilter::nearest}},
                          "how voxels are interpolated");
        const Transform to_world =
            volume_transform(params, "applied after the transform of the file");
        if (path.empty()) return;

        const std::string name = path.filename().string();
        grid_ = VdbReader(read_text(path), name).read(grid_name);
        check(fmt::format("{}: grid \"{}\"", name, grid_name));
        if (grid_->background() > 0) {
            params.warning("filename",
                           fmt::format("{}: the background of grid \"{}\" is {:g}; beyond its "
                                       "active voxels it is not seen",
                                       name, grid_name, grid_->background()));
        }
        place(to_world, fmt::format("{}: grid \"{}\"", name, grid_name));
    }

    Color color(Vector3 p) const override { return Color(real(p)); }
    float real(Vector3 p) const override;
    Bounds3 bounds() const override { return bounds_; }
    glm::ivec3 resolution() const override {
        return rounded_resolution(space_.voxels_along(bounds_.extent()));
    }
    float max(const Bounds3& box) const override;

private:
    void check(const std::string& who) const;
    void place(const Transform& to_world, const std::string& who);

    openvdb::FloatGrid::Ptr grid_;
    GridFilter filter_;
    VolumeSpace space_;  ///< of indices
    Bounds3 bounds_{.min = Vector3(0), .max = Vector3(1)};
};

void OpenVdbVolume::check(const std::string& who) const {
    if (grid_->getGridClass() == openvdb::GRID_LEVEL_SET) {
        throw Error(
            fmt::format("{} is a level set, whose numbers are distances; a volume needs a "
                        "density (a fog volume)",
                        who));
    }
    if (grid_->evalActiveVoxelBoundingBox().empty()) {
        throw Error(fmt::format("{} has no active voxels", who));
    }
    const VdbExtrema all(grid_->tree(), openvdb::CoordBBox::inf());
    if (!all.ordered() || all.smallest() < 0 || !(all.largest() < infinity)) {
        throw Error(fmt::format("{} holds {}; a volume holds finite numbers of at least 0", who,
                                !all.ordered()       ? "NaN"
                                : all.smallest() < 0 ? fmt::format("{:g}", all.smallest())
                                                     : "infinity"));
    }
}

void OpenVdbVolume::place(const Transform& to_world, const std::string& who) {
    if (!grid_->transform().isLinear()) {
        throw Error(fmt::format("{} has a transform that is not affine", who));
    }
    const openvdb::Mat4d of_file = grid_->transform().baseMap()->getAffineMap()->getMat4();
    Matrix4d matrix;
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 4; ++k) matrix[i][k] = of_file(i, k);  // it multiplies rows
    }
    try {
        space_ = VolumeSpace(to_world * Transform(matrix));
    } catch (const std::invalid_argument&) {
        throw Error(fmt::format("{} has a transform that is singular or not finite", who));
    }
    const openvdb::CoordBBox active = grid_->evalActiveVoxelBoundingBox();
    const float reach = filter_ == GridFilter::nearest ? 0.5f : 1.0f;
    const auto index = [](const openvdb::Coord& c) { return Vector3(c.x(), c.y(), c.z()); };
    bounds_ = space_.world_bounds(
        {.min = index(active.min()) - reach, .max = index(active.max()) + reach});
}

float OpenVdbVolume::real(Vector3 p) const {
    // Index i is the centre of a voxel that `between` and `reach` know from i to i + 1.
    const Vector3d q = space_.point(p) + 0.5;
    std::array<int, 3> first;
    std::array<float, 3> t;
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const VoxelRange range = reach(q[k], q[k], filter_);
        first[i] = range.first;
        t[i] = filter_ == GridFilter::nearest ? 0 : fraction(q[k] - 0.5);
    }
    const auto voxels = grid_->getConstUnsafeAccessor();
    const auto at = [&](int x, int y, int z) {
        return voxels.getValue({first[0] + x, first[1] + y, first[2] + z});
    };
    if (filter_ == GridFilter::nearest) return at(0, 0, 0);
    const auto row = [&](int y, int z) { return mixed(at(0, y, z), at(1, y, z), t[0]); };
    return mixed(mixed(row(0, 0), row(1, 0), t[1]), mixed(row(0, 1), row(1, 1), t[1]), t[2]);
}

float OpenVdbVolume::max(const Bounds3& box) const {
    const Bounds3 inside = intersection(box, bounds_);
    if (inside.empty()) return 0;
    const Bounds3d place = space_.box(inside);
    openvdb::CoordBBox voxels;
    for (int k = 0; k < 3; ++k) {
        const VoxelRange range = reach(place.min[k] + 0.5, place.max[k] + 0.5, filter_);
        voxels.min()[k] = range.first;
        voxels.max()[k] = range.last;
    }
    return VdbExtrema(grid_->tree(), voxels).largest();
}

}  // namespace

const PluginInfo plugin = describe<OpenVdbVolume>("numbers on a sparse grid, from OpenVDB");

}  // namespace lucerna
