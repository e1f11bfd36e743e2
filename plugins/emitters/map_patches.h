// SPDX-License-Identifier: Apache-2.0
/// The picture of an environment map as a number of rectangles, each a light of its own, so that
/// light samplers can learn which of them a place sees.
///
/// The picture is a grid of cells of whole tiles (PiecewiseConstant2D). Patches are rectangles of
/// cells: the one with the largest product of power and angular extent is divided next, across its
/// longer side, where its power is halved. The density of a direction, patches chosen in proportion
/// to their power, is that of the picture as a whole.
#pragma once

#include "core/math/distribution.h"

#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace lucerna {

class MapPatches {
public:
    static constexpr std::uint32_t most = 256;

    MapPatches() = default;
    /// `weights`: flux of each texel, rows of `width`, upper row first.
    MapPatches(std::span<const float> weights, int width, int height);

    std::uint32_t size() const { return static_cast<std::uint32_t>(patches_.size()); }
    /// Sum of the weights of a patch.
    double power(std::uint32_t patch) const { return patches_[patch].table.total(); }
    /// The patch of a place in the picture, in [0, 1)².
    std::uint32_t at(Vector2 uv) const {
        const auto cell = [](float x, float count, int most_cells) {
            return std::clamp(static_cast<int>(x * count), 0, most_cells - 1);
        };
        const int x = cell(uv.x, cells_in_picture_.x, cells_.x);
        const int y = cell(uv.y, cells_in_picture_.y, cells_.y);
        return owners_[index({x, y})];
    }
    /// A place in a patch, with its density in the picture.
    PiecewiseConstant2D::Sample sample(std::uint32_t patch, Vector2d u) const {
        const Patch& p = patches_[patch];
        const PiecewiseConstant2D::Sample s = p.table.sample(u);
        return {p.corner + s.p * p.extent, s.pdf / (p.extent.x * p.extent.y)};
    }
    /// The density of `sample`; zero outside of the patch.
    float pdf(std::uint32_t patch, Vector2 uv) const {
        if (at(uv) != patch) return 0;
        const Patch& p = patches_[patch];
        const Vector2 inside = glm::clamp((uv - p.corner) / p.extent, 0.0f, 1.0f);
        return p.table.pdf(inside) / (p.extent.x * p.extent.y);
    }
    /// Places on a grid that cover a patch, its borders included.
    template <typename Visit>
    void for_each_corner(std::uint32_t patch, Visit&& visit) const {
        const Vector2i min = patches_[patch].cells.min, max = patches_[patch].cells.max;
        for (int y = min.y; y <= max.y; ++y) {
            for (int x = min.x; x <= max.x; ++x) visit(corner({x, y}));
        }
    }
    /// Distance of two neighbours of that grid, in the picture.
    Vector2 step() const { return 1.0f / cells_in_picture_; }

private:
    struct Rectangle {
        Vector2i min{0}, max{0};  ///< cells; max is outside
    };
    struct Patch {
        Rectangle cells;
        Vector2 corner{0}, extent{1};  ///< in the picture
        PiecewiseConstant2D table;
    };

    std::size_t index(Vector2i cell) const {
        return static_cast<std::size_t>(cell.x) +
               static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(cells_.x);
    }
    Vector2 corner(Vector2i cell) const {
        return glm::min(Vector2(cell) / cells_in_picture_, Vector2(1));
    }
    double power_of(std::span<const double> powers, Rectangle r) const;
    Vector2 angles(Rectangle r) const;
    std::optional<std::pair<Rectangle, Rectangle>> divide(std::span<const double> powers,
                                                          Rectangle r) const;
    std::vector<Rectangle> partition(std::span<const double> powers) const;
    Patch make_patch(std::span<const float> weights, Rectangle r) const;

    Vector2i size_{0};             ///< of the picture, in texels
    Vector2i cell_{1};             ///< of a cell, in texels
    Vector2i cells_{0};            ///< of the grid
    Vector2 cells_in_picture_{1};  ///< the last ones may reach beyond its edges
    std::vector<Patch> patches_;
    std::vector<std::uint8_t> owners_;  ///< patch of each cell
};

inline MapPatches::MapPatches(std::span<const float> weights, int width, int height)
    : size_(width, height) {
    constexpr int tile = PiecewiseConstant2D::side;
    constexpr Vector2i most_cells(64, 32);
    const Vector2i tiles = (size_ + tile - 1) / tile;
    cell_ = tile * ((tiles + most_cells - 1) / most_cells);
    cells_ = (size_ + cell_ - 1) / cell_;
    cells_in_picture_ = Vector2(size_) / Vector2(cell_);
    std::vector<double> powers(index({0, cells_.y}));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            powers[index(Vector2i(x, y) / cell_)] += static_cast<double>(
                weights[static_cast<std::size_t>(x) +
                        static_cast<std::size_t>(y) * static_cast<std::size_t>(width)]);
        }
    }
    owners_.resize(powers.size());
    for (const Rectangle& r : partition(powers)) {
        for (int y = r.min.y; y < r.max.y; ++y) {
            for (int x = r.min.x; x < r.max.x; ++x) {
                owners_[index({x, y})] = static_cast<std::uint8_t>(patches_.size());
            }
        }
        patches_.push_back(make_patch(weights, r));
    }
}

inline double MapPatches::power_of(std::span<const double> powers, Rectangle r) const {
    double sum = 0;
    for (int y = r.min.y; y < r.max.y; ++y) {
        for (int x = r.min.x; x < r.max.x; ++x) sum += powers[index({x, y})];
    }
    return sum;
}

/// Width and height of a rectangle as it is seen [rad].
inline Vector2 MapPatches::angles(Rectangle r) const {
    constexpr float pi_f = std::numbers::pi_v<float>;
    const Vector2 a = corner(r.min), b = corner(r.max);
    const float middle = 0.5f * (a.y + b.y);
    return {2 * pi_f * (b.x - a.x) * std::sin(pi_f * middle), pi_f * (b.y - a.y)};
}

/// In two of about the same power, across the longer side.
inline std::optional<std::pair<MapPatches::Rectangle, MapPatches::Rectangle>> MapPatches::divide(
    std::span<const double> powers, Rectangle r) const {
    const Vector2i count = r.max - r.min;
    const Vector2 angle = angles(r);
    const int axis = count.y < 2 || (count.x > 1 && angle.x > angle.y) ? 0 : 1;
    if (count[axis] < 2) return {};
    const double half = 0.5 * power_of(powers, r);
    Rectangle first = r, second = r;
    double best = std::numeric_limits<double>::infinity();
    for (int at = r.min[axis] + 1; at < r.max[axis]; ++at) {
        Rectangle part = r;
        part.max[axis] = at;
        const double difference = std::abs(power_of(powers, part) - half);
        if (!(difference < best)) continue;
        best = difference;
        first.max[axis] = second.min[axis] = at;
    }
    return std::pair(first, second);
}

inline std::vector<MapPatches::Rectangle> MapPatches::partition(
    std::span<const double> powers) const {
    constexpr std::size_t fewest_cells = 16;  // smaller pictures are one light
    std::vector<Rectangle> done, open{{.min = Vector2i(0), .max = cells_}};
    if (powers.size() < fewest_cells) return open;
    const auto urgency = [&](const Rectangle& r) {
        const Vector2 angle = angles(r);
        return power_of(powers, r) * static_cast<double>(std::max(angle.x, angle.y));
    };
    while (!open.empty() && done.size() + open.size() < most) {
        const auto next = std::max_element(
            open.begin(), open.end(),
            [&](const Rectangle& a, const Rectangle& b) { return urgency(a) < urgency(b); });
        const Rectangle r = *next;
        if (!(urgency(r) > 0)) break;
        open.erase(next);
        if (const auto halves = divide(powers, r)) {
            open.push_back(halves->first);
            open.push_back(halves->second);
        } else {
            done.push_back(r);
        }
    }
    done.insert(done.end(), open.begin(), open.end());
    return done;
}

inline MapPatches::Patch MapPatches::make_patch(std::span<const float> weights, Rectangle r) const {
    const Vector2i min = r.min * cell_, max = glm::min(r.max * cell_, size_);
    std::vector<float> own;
    for (int y = min.y; y < max.y; ++y) {
        const auto begin = weights.begin() + static_cast<std::ptrdiff_t>(y) * size_.x +
                           static_cast<std::ptrdiff_t>(min.x);
        own.insert(own.end(), begin, begin + (max.x - min.x));
    }
    const Vector2 a = corner(r.min), b = corner(r.max);
    return {.cells = r,
            .corner = a,
            .extent = b - a,
            .table = PiecewiseConstant2D(own, max.x - min.x, max.y - min.y)};
}

}  // namespace lucerna
