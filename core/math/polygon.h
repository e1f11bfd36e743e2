// SPDX-License-Identifier: Apache-2.0
/// Polygons become triangles: fans where that is right, else by cutting off ears (Meisters 1975,
/// "Polygons have ears"; O'Rourke 1998, "Computational Geometry in C", 1.4).
#pragma once

#include "core/math/vector.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lucerna {

enum class PolygonCut : std::uint8_t {
    complete,   ///< the triangles cover the polygon, each point once
    crossing,   ///< the polygon crosses itself: what is inside is not defined
    too_large,  ///< not convex, and more corners than `max_concave_corners`; no triangles
};

/// Ears are found in quadratic time: a few seconds at the most.
inline constexpr std::size_t max_concave_corners = 32768;

/// Appends the n − 2 triangles of a polygon, three indices each, with the polygon's winding.
/// `corners` are indices of `positions`, at least 3. The polygon may be concave, not quite flat,
/// and have holes that are joined to its outline by a pair of coinciding edges. A fan around the
/// first corner is preferred.
PolygonCut cut_polygon(std::span<const Vector3> positions, std::span<const std::uint32_t> corners,
                       std::vector<std::uint32_t>& triangles);

}  // namespace lucerna
