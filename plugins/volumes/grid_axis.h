// SPDX-License-Identifier: Apache-2.0
/// Where a coordinate of a volume meets the voxels of a row: the filters and what lies beyond the
/// ends. Coordinates are in voxels: voxel i reaches from i to i + 1, and its number is its value at
/// the centre.
#pragma once

#include "core/math/symmetric_matrix.h"

#include <array>

namespace lucerna {

enum class GridFilter { nearest, trilinear };
enum class GridWrap { repeat, mirror, clamp };

/// std::floor without a call.
inline double floor_of(double x) {
    const auto whole = static_cast<double>(static_cast<std::int64_t>(x));
    return whole > x ? whole - 1 : whole;
}

/// Voxels first to last, both included.
struct VoxelRange {
    int first, last;
};

/// a mod n in [0, n).
constexpr int modulo(int a, int n) {
    const int rest = a % n;
    return rest < 0 ? rest + n : rest;
}

/// The voxel that stands for number i, which may lie beyond the ends of n voxels.
constexpr int wrapped(int i, int n, GridWrap wrap) {
    if (i >= 0 && i < n) return i;
    if (wrap == GridWrap::clamp) return i < 0 ? 0 : n - 1;
    const int inside = modulo(i, n);
    if (wrap == GridWrap::repeat) return inside;
    return (i - inside) / n % 2 == 0 ? inside : n - 1 - inside;
}

/// The voxels that stand for numbers lo to hi: one range, or two, of which the second may be empty
/// (first > last).
constexpr std::array<VoxelRange, 2> wrapped(VoxelRange range, int n, GridWrap wrap) {
    constexpr VoxelRange none{0, -1};
    const auto [lo, hi] = range;
    const int a = wrapped(lo, n, wrap), b = wrapped(hi, n, wrap);
    if (wrap == GridWrap::clamp) return {VoxelRange{a, b}, none};
    const int first_period = (lo - modulo(lo, n)) / n, last_period = (hi - modulo(hi, n)) / n;
    if (first_period == last_period) return {VoxelRange{std::min(a, b), std::max(a, b)}, none};
    if (last_period - first_period > 1) return {VoxelRange{0, n - 1}, none};
    if (wrap == GridWrap::repeat) return {VoxelRange{a, n - 1}, VoxelRange{0, b}};
    // The numbers turn round at an end of the row.
    if (first_period % 2 == 0) return {VoxelRange{std::min(a, b), n - 1}, none};
    return {VoxelRange{0, std::max(a, b)}, none};
}

/// The two voxels between whose centres a coordinate lies, and how far from the first.
struct Between {
    int first, second;
    float t;  ///< in [0, 1)
};

/// x − ⌊x⌋ in [0, 1), also where it is rounded.
inline float fraction(double x) {
    return std::min(static_cast<float>(x - floor_of(x)), one_minus_epsilon);
}

/// Coordinates beyond ±2^29 count as the nearest of these, and NaN as the lower.
inline Between between(double x, int n, GridFilter filter, GridWrap wrap) {
    x = std::min(std::max(-0x1p29, x), 0x1p29);
    const double place = filter == GridFilter::nearest ? x : x - 0.5;
    const int i = static_cast<int>(floor_of(place));
    const int first = wrapped(i, n, wrap);
    if (filter == GridFilter::nearest) return {first, first, 0};
    return {first, wrapped(i + 1, n, wrap), fraction(place)};
}

/// The numbers that `between` can reach, before they are wrapped, from coordinates in [lo, hi].
inline VoxelRange reach(double lo, double hi, GridFilter filter) {
    lo = std::min(std::max(-0x1p29, lo), 0x1p29);
    hi = std::min(std::max(-0x1p29, hi), 0x1p29);
    if (filter == GridFilter::nearest) {
        return {static_cast<int>(floor_of(lo)), static_cast<int>(floor_of(hi))};
    }
    return {static_cast<int>(floor_of(lo - 0.5)), static_cast<int>(floor_of(hi - 0.5)) + 1};
}

/// a + t (b − a), for t in [0, 1): never above the larger of two numbers that are not negative, and
/// exactly a where both are equal.
inline float mixed(float a, float b, float t) { return std::min(std::max(a, b), a + t * (b - a)); }
inline Color mixed(Color a, Color b, float t) { return glm::min(glm::max(a, b), a + t * (b - a)); }
/// For each number. Zero or positive definite if both are.
inline SymmetricMatrix mixed(const SymmetricMatrix& a, const SymmetricMatrix& b, float t) {
    return {.xx = mixed(a.xx, b.xx, t),
            .yy = mixed(a.yy, b.yy, t),
            .zz = mixed(a.zz, b.zz, t),
            .xy = mixed(a.xy, b.xy, t),
            .xz = mixed(a.xz, b.xz, t),
            .yz = mixed(a.yz, b.yz, t)};
}

}  // namespace lucerna
