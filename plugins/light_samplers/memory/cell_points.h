// SPDX-License-Identifier: Apache-2.0
/// Pilot points by the cells in which they lie.
#pragma once

#include "plugins/light_samplers/learning/pilot_paths.h"
#include "plugins/light_samplers/memory/cell_grid.h"

#include <algorithm>
#include <vector>

namespace lucerna {

/// Which pilot points lie in which cell.
struct CellPoints {
    struct Member {
        std::uint64_t key;
        std::uint32_t point;
        bool operator<(const Member& o) const {
            return key != o.key ? key < o.key : point < o.point;
        }
    };
    std::vector<Member> members;  ///< sorted
    std::vector<std::uint64_t> keys;
    std::vector<std::size_t> starts, ends;

    /// Cells with fewer points than `least` are left out.
    CellPoints(const CellGrid& grid, const std::vector<Receiver>& points, std::size_t least) {
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            members.push_back({grid.key(points[i].p, points[i]), i});
        }
        std::sort(members.begin(), members.end());
        for (std::size_t i = 0, end = 0; i < members.size(); i = end) {
            while (end < members.size() && members[end].key == members[i].key) ++end;
            if (end - i < least) continue;
            keys.push_back(members[i].key);
            starts.push_back(i);
            ends.push_back(end);
        }
    }
    /// All points of a cell.
    std::vector<Receiver> inside(const std::vector<Receiver>& points, std::size_t cell) const {
        std::vector<Receiver> all;
        for (std::size_t i = starts[cell]; i < ends[cell]; ++i) {
            all.push_back(points[members[i].point]);
        }
        return all;
    }
    /// Some of the points of a cell: half of them as they come, half far from those, so that a
    /// surface which few paths met is seen, too.
    std::vector<Receiver> choose(const std::vector<Receiver>& points, std::size_t cell) const {
        constexpr std::size_t most_points = 16;
        const std::size_t size = ends[cell] - starts[cell], used = std::min(size, most_points);
        const auto member = [&](std::size_t i) -> const Receiver& {
            return points[members[starts[cell] + i].point];
        };
        std::vector<Receiver> chosen;
        std::vector<float> distance2(size, infinity);  // of each to the nearest one that is chosen
        const auto take = [&](std::size_t taken) {
            chosen.push_back(member(taken));
            for (std::size_t i = 0; i < size; ++i) {
                const Vector3 d = member(i).p - chosen.back().p;
                distance2[i] = std::min(distance2[i], glm::dot(d, d));
            }
        };
        const std::size_t even = (used + 1) / 2;
        for (std::size_t k = 0; k < even; ++k) take(k * size / even);
        while (chosen.size() < used) {
            const auto farthest = std::max_element(distance2.begin(), distance2.end());
            take(static_cast<std::size_t>(farthest - distance2.begin()));
        }
        return chosen;
    }
};

struct Cells {
    CellGrid grid;
    CellPoints points;
};

/// The cells of some points, of the given size, or of a larger one if there were more than `most`.
inline Cells make_cells(const Scene& scene, const std::vector<Receiver>& points, float size,
                        std::size_t least_points, std::size_t most, bool by_side) {
    const Vector3 eye = eye_of(scene);
    for (;; size *= 1.25f) {
        CellGrid grid(eye, scene.bounds(), size, by_side);
        CellPoints cells(grid, points, least_points);
        if (cells.keys.size() > most && size < 1e4f) continue;
        grid.index(cells.keys);
        return {std::move(grid), std::move(cells)};
    }
}

}  // namespace lucerna
