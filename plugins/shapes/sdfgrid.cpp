// SPDX-License-Identifier: Apache-2.0
/// sdfgrid: where the numbers on a grid, distances with a sign, are zero; negative ones are inside.
///
///   filename       string     required   a volume of Mitsuba (.vol) with one channel
///   normals        string     smooth     analytic: those of the surface, which has edges
///   to_world       transform             affine
///   flip_normals   boolean    false      the normals point to negative numbers
///
/// The first and the last numbers along each axis lie on the sides of the unit cube, as in Mitsuba.
/// There are no texture coordinates: the texture `volume` needs none. Areas are not known, so that
/// it cannot emit.
#include "plugins/shapes/analytic.h"
#include "plugins/shapes/sdf_grid.h"
#include "plugins/volumes/vol_file.h"

namespace lucerna {
namespace {

class SDFGridShape final : public Shape {
public:
    explicit SDFGridShape(const Params& params) : Shape(params) {
        const std::filesystem::path path =
            params.file("filename", "distances on a grid (.vol), one channel");
        smooth_ = params.choice("normals", true, {{"smooth", true}, {"analytic", false}},
                                "shading normals");
        params.no_effect("silhouette_sampling_weight", "rendering is not differentiated");
        if (emitter()) {
            params.error("emitter",
                         "an sdfgrid cannot emit light: its area is not known; use a "
                         "mesh");
        }
        if (path.empty()) return;
        VolFile file = read_vol(path);
        const std::string name = path.filename().string();
        for (const std::string& warning : file.warnings) params.warning("filename", warning);
        require_distances(file.grid, name);
        grid_ = SDFGrid(std::move(file.grid));
        if (grid_.empty()) {
            throw Error(
                fmt::format("{}: there is no surface: its numbers all have the same sign", name));
        }
        place();
    }

    Geometry geometry() const override { return AnalyticGeometry{bounds_}; }
    Bounds3 bounds() const override { return bounds_; }

    std::optional<Hit> intersect(const Ray& ray) const override {
        const auto met = grid_.first_crossing(line(ray), 0);
        if (!met) return {};
        const auto t = static_cast<float>(met->t);
        if (!(t <= ray.tmax)) return {};
        return Hit{.t = t};
    }

    void fill(const Ray& ray, const Hit& hit, Interaction& at) const override {
        // Again in double, from a little before the rounded t.
        const SDFGrid::Line l = line(ray);
        const auto rounded = static_cast<double>(hit.t);
        const auto met = grid_.first_crossing(l, rounded * (1 - 0x1p-21));
        const double t = met ? met->t : rounded;
        const Vector3d p = l.o + t * l.d;
        const Vector3i last = grid_.voxels() - 1;
        const Vector3i voxel =
            met ? met->voxel : glm::clamp(Vector3i(glm::floor(p)), Vector3i(0), last);
        at.p = Vector3(world_from_voxels_.point(p));
        at.error = rounding_error(at.p, magnitude_);
        at.n = world_normal(grid_.gradient(voxel, p));
        Vector3 ns = smooth_ ? world_normal(grid_.smooth_gradient(p)) : at.n;
        if (!(glm::dot(ns, at.n) > 0)) ns = at.n;
        at.uv = Vector2(0);
        at.shading = Frame::from_normal(ns);
        const Frame frame = Frame::from_normal(at.n);
        at.dpdu = frame.s;
        at.dpdv = frame.t;
    }

    // It does not emit.
    float area(std::uint32_t) const override { return 0; }
    SurfaceSample sample_area(std::uint32_t, Vector2) const override { return {}; }

private:
    static void require_distances(const VoxelGrid& grid, const std::string& name) {
        const Vector3i n = grid.resolution();
        if (grid.channels() != 1) {
            throw Error(
                fmt::format("{}: it has {} channels; distances are one", name, grid.channels()));
        }
        if (std::min({n.x, n.y, n.z}) < 2) {
            throw Error(
                fmt::format("{}: {} × {} × {} numbers have no surface between them: there "
                            "must be 2 or more along each axis",
                            name, n.x, n.y, n.z));
        }
        for (int z = 0; z < n.z; ++z) {
            for (int y = 0; y < n.y; ++y) {
                for (int x = 0; x < n.x; ++x) {
                    const float number = grid.real({x, y, z});
                    if (std::isfinite(number)) continue;
                    throw Error(fmt::format("{}: the distance at ({}, {}, {}) is not finite: {}",
                                            name, x, y, z, number));
                }
            }
        }
    }

    void place() {
        const Transform object_from_voxels = Transform::scale(1.0 / Vector3d(grid_.voxels()));
        world_from_voxels_ = world_from_object() * object_from_voxels;
        voxels_from_world_ = world_from_voxels_.inverse();
        Vector3d min(std::numeric_limits<double>::max()), max = -min;
        for (int i = 0; i < 8; ++i) {
            const Vector3d corner(i & 1 ? grid_.last().x : grid_.first().x,
                                  i & 2 ? grid_.last().y : grid_.first().y,
                                  i & 4 ? grid_.last().z : grid_.first().z);
            const Vector3d p = world_from_voxels_.point(corner);
            min = glm::min(min, p);
            max = glm::max(max, p);
        }
        bounds_ = bounds_around(min, max);
        const Vector3d size = glm::max(absolute(min), absolute(max));
        magnitude_ = std::max(size.x, std::max(size.y, size.z));
    }

    SDFGrid::Line line(const Ray& ray) const {
        return {voxels_from_world_.point(Vector3d(ray.o)),
                voxels_from_world_.direction(Vector3d(ray.d))};
    }

    /// Towards growing numbers; any direction where they do not change.
    Vector3 world_normal(Vector3d gradient) const {
        const Vector3d n = world_from_voxels_.normal(gradient);
        const double length = glm::length(n);
        if (!(length > 0)) return {0, 0, 1};
        return Vector3(n * ((flip_normals() ? -1 : 1) / length));
    }

    bool smooth_ = true;
    SDFGrid grid_;
    Transform world_from_voxels_, voxels_from_world_;
    Bounds3 bounds_;
    double magnitude_ = 1;
};

}  // namespace

const PluginInfo plugin = describe<SDFGridShape>("the zero set of distances on a grid");

}  // namespace lucerna
