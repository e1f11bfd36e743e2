// SPDX-License-Identifier: Apache-2.0
/// A coarse grid of upper bounds of the extinction of a medium, and the walk of a ray through it
/// (Amanatides and Woo 1987; pbrt 4e, 11.4.2).
#pragma once

#include "core/math/bounds.h"

#include <optional>
#include <vector>

namespace lucerna {

/// Cells of equal size that fill a finite box, x fastest.
class MajorantGrid {
public:
    /// `majorant(box)` bounds the extinction in a box [1/m].
    template <typename Majorant>
    MajorantGrid(const Bounds3& bounds, glm::ivec3 size, Majorant&& majorant)
        : bounds_(bounds), size_(size), cell_(bounds.extent() / Vector3(size)) {
        cells_.reserve(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                       static_cast<std::size_t>(size.z));
        for (int z = 0; z < size.z; ++z) {
            for (int y = 0; y < size.y; ++y) {
                for (int x = 0; x < size.x; ++x) cells_.push_back(majorant(box({x, y, z})));
            }
        }
    }

    const Bounds3& bounds() const { return bounds_; }
    glm::ivec3 size() const { return size_; }
    Vector3 cell() const { return cell_; }  ///< edges of a cell [m]
    float operator[](glm::ivec3 i) const {
        const auto x = static_cast<std::size_t>(i.x), y = static_cast<std::size_t>(i.y),
                   z = static_cast<std::size_t>(i.z), nx = static_cast<std::size_t>(size_.x),
                   ny = static_cast<std::size_t>(size_.y);
        return cells_[(z * ny + y) * nx + x];
    }

private:
    /// A cell, grown by what rounding may move a point on a ray.
    Bounds3 box(glm::ivec3 i) const {
        const Vector3 slack = 0x1p-20f * glm::max(absolute(bounds_.min), absolute(bounds_.max));
        return {.min = bounds_.min + Vector3(i) * cell_ - slack,
                .max = bounds_.min + Vector3(i + glm::ivec3(1)) * cell_ + slack};
    }

    Bounds3 bounds_;
    glm::ivec3 size_;
    Vector3 cell_;
    std::vector<float> cells_;
};

/// A part of a ray with one majorant.
struct MajorantSegment {
    float begin = 0, end = 0;  ///< distances along the ray
    float majorant = 0;        ///< [1/m]
};

/// The parts of a ray o + t d, |d| = 1, that lie in the grid, from t = 0 to `tmax`.
class MajorantIterator {
public:
    MajorantIterator(const MajorantGrid& grid, Vector3 o, Vector3 d, float tmax);
    /// Empty: the ray has left the grid, or has ended.
    std::optional<MajorantSegment> next();

private:
    const MajorantGrid& grid_;
    float t_ = 0, end_ = 0;
    Vector3 next_{infinity}, delta_{infinity};  ///< per axis: the next wall, and from wall to wall
    glm::ivec3 at_{0}, step_{0};
};

}  // namespace lucerna
