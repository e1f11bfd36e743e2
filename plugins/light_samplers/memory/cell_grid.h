// SPDX-License-Identifier: Apache-2.0
/// A partition of receivers into cells, found by hash: a cube whose size grows with the distance
/// to the eye, the side to which the surface faces, and of the cube one slab of four to that side.
///
/// Slabs tell walls apart that face the same way at both sides of a lane, or of a house: what
/// lights one of them is often behind the other.
#pragma once

#include "core/scene/scene.h"
#include "plugins/light_samplers/memory/key_table.h"

namespace lucerna {

class CellGrid {
public:
    static constexpr std::uint32_t none = KeyTable::none;
    static constexpr float slabs = 4;  ///< of a cube

    CellGrid() = default;
    /// `size` is the edge of a cell relative to its distance to the eye. Unless `by_side`, cells
    /// are whole cubes.
    CellGrid(Vector3 eye, const Bounds3& bounds, float size, bool by_side = true)
        : eye_(eye),
          origin_(bounds.center()),
          unit_(std::max(2 * bounds.radius(), 1e-20f)),
          size_(size),
          by_side_(by_side) {}

    /// Edge of the cells at `p`: the size of the scene times a power of two.
    float edge(Vector3 p) const { return unit_ / per_unit(level(p)); }

    /// `p` from the middle of the scene, in units of its size.
    Vector3 relative(Vector3 p) const { return (p - origin_) / unit_; }
    /// Name of the cell of a point `p` of a surface like that of the receiver.
    std::uint64_t key(Vector3 p, const Receiver& at) const {
        return key(p, by_side_ ? face(at) : 7);
    }

    /// The cells of the same size and side around a cell, as far as they exist: of the next slabs,
    /// and of the cubes beside it.
    std::vector<std::uint32_t> neighbours(std::uint64_t key) const {
        std::vector<std::uint32_t> result;
        for (std::uint64_t i = 0; i < 27; ++i) {
            const std::uint64_t around = key + ((i % 3) << 36) + ((i / 3 % 3) << 18) + i / 9 -
                                         ((std::uint64_t{1} << 36) + (std::uint64_t{1} << 18) + 1);
            const std::uint32_t cell = around == key ? none : find(around);
            if (cell != none) result.push_back(cell);
        }
        return result;
    }

    /// Cells in the order of this list.
    void index(const std::vector<std::uint64_t>& keys) { cells_ = KeyTable(keys); }
    /// Number of the cell, or `none`.
    std::uint32_t find(std::uint64_t key) const { return cells_.find(key); }
    std::size_t bytes() const { return cells_.bytes(); }

private:
    /// Cells of the level are 2^−level of the scene.
    int level(Vector3 p) const {
        const float wanted = size_ * glm::length(p - eye_) / unit_;
        const int exponent = static_cast<int>(std::bit_cast<std::uint32_t>(wanted) >> 23) - 127;
        return std::clamp(-1 - exponent, 0, 16);  // 18 bits hold the slabs of half a scene
    }
    static float per_unit(int level) { return static_cast<float>(1 << level); }

    std::uint64_t key(Vector3 p, std::uint64_t face) const {
        const int l = level(p);
        const Vector3 x = (p - origin_) * (per_unit(l) / unit_);
        std::uint64_t key = (1 + static_cast<std::uint64_t>(l)) << 3 | face;
        for (std::uint64_t i = 0; i < 3; ++i) {
            const float pieces = face < 6 && face / 2 == i ? slabs : 1.0f;
            const float place = pieces * x[static_cast<int>(i)];
            const float cell = std::clamp(place, -131071.0f, 131070.0f) + 131072;  // rounds down
            key = key << 18 | static_cast<std::uint64_t>(static_cast<int>(cell));
        }
        return key;
    }

    /// The one of six axes that is nearest to the normal, 6 if light arrives from both sides, or
    /// 7 in a medium.
    static std::uint64_t face(const Receiver& at) {
        if (!at.has_normal()) return 7;
        if (at.sides == Sides::both) return 6;
        const Vector3 a = absolute(at.n);
        const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
        const bool negative = (at.n[axis] < 0) != (at.sides == Sides::back);
        return static_cast<std::uint64_t>(2 * axis + (negative ? 1 : 0));
    }

    Vector3 eye_{0}, origin_{0};
    float unit_ = 1;
    float size_ = 1;
    bool by_side_ = true;
    KeyTable cells_;
};

}  // namespace lucerna
