// SPDX-License-Identifier: Apache-2.0
/// The zero set of numbers on a regular grid, interpolated trilinearly, and where lines meet it.
///
/// Along a line, the interpolant is a cubic in each voxel, whose first root is found between the
/// roots of its derivative (Hansson Söderlund, Evans and Akenine-Möller 2022, "Ray Tracing of
/// Signed Distance Function Grids", JCGT 11(3)). Voxels are visited in order, and the value at the
/// end of one is that at the beginning of the next: no line passes between two of them.
///
/// Coordinates count voxels: nodes lie at integers.
#pragma once

#include "plugins/volumes/voxel_grid.h"

#include <array>
#include <optional>

namespace lucerna {

/// c[0] + c[1] s + c[2] s² + c[3] s³.
struct Cubic {
    std::array<double, 4> c;

    double at(double s) const { return c[0] + s * (c[1] + s * (c[2] + s * c[3])); }
    double slope(double s) const { return c[1] + s * (2 * c[2] + s * 3 * c[3]); }

    /// The first root in [0, length], where the value at 0 is `start`, up to rounding.
    std::optional<double> first_root(double start, double length) const {
        std::array<double, 3> ends = turns(length);
        double begin = 0, value = start;
        if (value == 0) return 0;
        for (const double end : ends) {
            const double next = at(end);
            if ((next <= 0) != (value <= 0)) return root_between(begin, end, value > 0);
            begin = end;
            value = next;
        }
        return {};
    }

private:
    /// Where the slope is zero in [0, length], in order, then `length`.
    std::array<double, 3> turns(double length) const {
        const double half = c[2], square = half * half - 3 * c[3] * c[1];
        if (!(square > 0)) return {length, length, length};
        const double q = -(half + std::copysign(std::sqrt(square), half));
        const double a = q / (3 * c[3]), b = c[1] / q;  // either may not be finite
        const auto inside = [&](double s) { return s > 0 && s < length ? s : length; };
        return {std::min(inside(a), inside(b)), std::max(inside(a), inside(b)), length};
    }

    /// By Newton's method, and by halves where it leaves the interval, in which the slope has one
    /// sign.
    double root_between(double begin, double end, bool falling) const {
        double s = 0.5 * (begin + end);
        for (int i = 0; i < 100; ++i) {
            const double value = at(s), step = value / slope(s);
            if (value == 0 || std::abs(step) <= 1e-15 * end || end - begin <= 1e-15 * end) break;
            if ((value > 0) == falling) {
                begin = s;
            } else {
                end = s;
            }
            double next = s - step;
            if (!(next > begin && next < end)) next = 0.5 * (begin + end);
            s = next;
        }
        return s;
    }
};

class SDFGrid {
public:
    struct Line {
        Vector3d o, d;
    };
    struct Crossing {
        double t;
        Vector3i voxel;
    };

    SDFGrid() = default;
    /// The grid has one channel, finite numbers, and at least two nodes along each axis.
    explicit SDFGrid(VoxelGrid grid) : grid_(std::move(grid)), voxels_(grid_.resolution() - 1) {
        crossed_.resize(index({0, 0, voxels_.z}));
        for (int z = 0; z < voxels_.z; ++z) {
            for (int y = 0; y < voxels_.y; ++y) {
                for (int x = 0; x < voxels_.x; ++x) add_if_crossed({x, y, z});
            }
        }
    }

    /// True if the surface goes through no voxel.
    bool empty() const { return first_.x > last_.x; }
    /// The corners of the box of all voxels that it may go through.
    Vector3i first() const { return first_; }
    Vector3i last() const { return last_ + 1; }
    /// Number of voxels along each axis.
    Vector3i voxels() const { return voxels_; }

    /// The first point of the surface with t from `start` on.
    std::optional<Crossing> first_crossing(const Line& line, double start) const;

    /// The gradient of the interpolant of a voxel.
    Vector3d gradient(Vector3i voxel, Vector3d p) const;
    /// The gradient of a smoother one: the differences of values half a voxel before and behind,
    /// which blends the gradients of the voxels around (Hansson Söderlund et al. 2022, section 4,
    /// without the normalization of each).
    Vector3d smooth_gradient(Vector3d p) const {
        Vector3d result;
        for (int k = 0; k < 3; ++k) {
            Vector3d before = p, behind = p;
            before[k] = std::max(p[k] - 0.5, 0.0);
            behind[k] = std::min(p[k] + 0.5, static_cast<double>(voxels_[k]));
            result[k] = (value(behind) - value(before)) / (behind[k] - before[k]);
        }
        return result;
    }

private:
    using Corners = std::array<std::array<std::array<double, 2>, 2>, 2>;  ///< by z, y, x

    std::size_t index(Vector3i voxel) const {
        return (static_cast<std::size_t>(voxel.z) * static_cast<std::size_t>(voxels_.y) +
                static_cast<std::size_t>(voxel.y)) *
                   static_cast<std::size_t>(voxels_.x) +
               static_cast<std::size_t>(voxel.x);
    }
    Corners corners(Vector3i voxel) const {
        Corners result;
        for (std::size_t i = 0; i < 8; ++i) {
            const Vector3i node = voxel + Vector3i(i & 1, i >> 1 & 1, i >> 2);
            result[i >> 2][i >> 1 & 1][i & 1] = static_cast<double>(grid_.real(node));
        }
        return result;
    }
    void add_if_crossed(Vector3i voxel) {
        double least = std::numeric_limits<double>::max(), most = -least;
        for (const auto& plane : corners(voxel)) {
            for (const auto& row : plane) {
                least = std::min({least, row[0], row[1]});
                most = std::max({most, row[0], row[1]});
            }
        }
        if (least > 0 || most < 0) return;
        crossed_[index(voxel)] = true;
        first_ = glm::min(first_, voxel);
        last_ = glm::max(last_, voxel);
    }
    Vector3i voxel_at(Vector3d p) const {
        return glm::clamp(Vector3i(glm::floor(p)), Vector3i(0), voxels_ - 1);
    }
    double value(Vector3d p) const {
        const Vector3i voxel = voxel_at(p);
        return along(voxel, {p, Vector3d(0)}, 0).c[0];
    }
    /// The interpolant of a voxel along a line, from `start` on.
    Cubic along(Vector3i voxel, const Line& line, double start) const;

    VoxelGrid grid_;
    Vector3i voxels_{0};
    std::vector<bool> crossed_;
    Vector3i first_{std::numeric_limits<int>::max()}, last_{-1};
};

inline Cubic SDFGrid::along(Vector3i voxel, const Line& line, double start) const {
    const Vector3d o = line.o + start * line.d - Vector3d(voxel), d = line.d;
    const Corners f = corners(voxel);
    double plane[2][3];
    for (std::size_t k = 0; k < 2; ++k) {
        double row[2][2];
        for (std::size_t j = 0; j < 2; ++j) {
            const double rise = f[k][j][1] - f[k][j][0];
            row[j][0] = f[k][j][0] + rise * o.x;
            row[j][1] = rise * d.x;
        }
        const double rise0 = row[1][0] - row[0][0], rise1 = row[1][1] - row[0][1];
        plane[k][0] = row[0][0] + rise0 * o.y;
        plane[k][1] = row[0][1] + rise1 * o.y + rise0 * d.y;
        plane[k][2] = rise1 * d.y;
    }
    const double rise0 = plane[1][0] - plane[0][0], rise1 = plane[1][1] - plane[0][1],
                 rise2 = plane[1][2] - plane[0][2];
    return {{plane[0][0] + rise0 * o.z, plane[0][1] + rise1 * o.z + rise0 * d.z,
             plane[0][2] + rise2 * o.z + rise1 * d.z, rise2 * d.z}};
}

inline Vector3d SDFGrid::gradient(Vector3i voxel, Vector3d p) const {
    Vector3d result;
    for (int k = 0; k < 3; ++k) {
        Vector3d axis(0);
        axis[k] = 1;
        result[k] = along(voxel, {p, axis}, 0).c[1];
    }
    return result;
}

inline std::optional<SDFGrid::Crossing> SDFGrid::first_crossing(const Line& line,
                                                                double start) const {
    constexpr double never = std::numeric_limits<double>::infinity();
    double t = start, end = never;
    for (int k = 0; k < 3; ++k) {
        const double low = first_[k], high = last_[k] + 1;
        if (line.d[k] == 0) {
            if (line.o[k] < low || line.o[k] > high) return {};
            continue;
        }
        const double a = (low - line.o[k]) / line.d[k], b = (high - line.o[k]) / line.d[k];
        t = std::max(t, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    if (!(t <= end)) return {};
    Vector3i voxel = glm::clamp(Vector3i(glm::floor(line.o + t * line.d)), first_, last_);
    double value = 0;  // at t, if it is known
    bool known = false;
    for (;;) {
        int axis = 0;
        double leaves = never;
        for (int k = 0; k < 3; ++k) {
            if (line.d[k] == 0) continue;
            const double side = voxel[k] + (line.d[k] > 0 ? 1 : 0);
            const double there = (side - line.o[k]) / line.d[k];
            if (there < leaves) {
                leaves = there;
                axis = k;
            }
        }
        if (crossed_[index(voxel)]) {
            const double length = std::max(std::min(leaves, end) - t, 0.0);
            const Cubic cubic = along(voxel, line, t);
            const auto root = cubic.first_root(known ? value : cubic.c[0], length);
            if (root) return Crossing{t + *root, voxel};
            value = cubic.at(length);
        }
        known = crossed_[index(voxel)];
        voxel[axis] += line.d[axis] > 0 ? 1 : -1;
        if (!(leaves < end) || voxel[axis] < first_[axis] || voxel[axis] > last_[axis]) return {};
        t = std::max(t, leaves);
    }
}

}  // namespace lucerna
