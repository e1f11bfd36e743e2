// SPDX-License-Identifier: Apache-2.0
#include "core/math/polygon.h"

namespace lucerna {

namespace {

/// Twice the area that a triangle of the plane has, negative if it is clockwise.
double orientation(Vector2d a, Vector2d b, Vector2d c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The polygon and what the fan around its first corner says about it.
class Fan {
public:
    Fan(std::span<const Vector3> positions, std::span<const std::uint32_t> corners)
        : positions_(positions), corners_(corners) {
        for (std::size_t i = 1; i + 1 < corners.size(); ++i) normal_ += triangle_normal(i);
    }

    /// Normal of the whole polygon, as long as twice its area (Newell).
    Vector3d normal() const { return normal_; }
    Vector3d edge(std::size_t i) const {
        return Vector3d(positions_[corners_[i]]) - Vector3d(positions_[corners_[0]]);
    }
    /// No triangle is turned over: the polygon is convex, or at least seen whole from the corner.
    bool covers() const {
        for (std::size_t i = 1; i + 1 < corners_.size(); ++i) {
            if (glm::dot(triangle_normal(i), normal_) < 0) return false;
        }
        return true;
    }
    /// All triangles are degenerate.
    bool is_flat() const {
        for (std::size_t i = 1; i + 1 < corners_.size(); ++i) {
            if (triangle_normal(i) != Vector3d(0)) return false;
        }
        return true;
    }
    void append(std::vector<std::uint32_t>& triangles) const {
        for (std::size_t i = 1; i + 1 < corners_.size(); ++i) {
            triangles.insert(triangles.end(), {corners_[0], corners_[i], corners_[i + 1]});
        }
    }

private:
    Vector3d triangle_normal(std::size_t i) const { return glm::cross(edge(i), edge(i + 1)); }

    std::span<const Vector3> positions_;
    std::span<const std::uint32_t> corners_;
    Vector3d normal_{0};
};

/// The polygon in the coordinate plane that it faces most, counter-clockwise.
std::vector<Vector2d> project(const Fan& fan, std::size_t count) {
    const Vector3d size = absolute(fan.normal());
    const int dropped = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    int u = (dropped + 1) % 3, v = (dropped + 2) % 3;
    if (fan.normal()[dropped] < 0) std::swap(u, v);
    std::vector<Vector2d> points(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Vector3d p = fan.edge(i);
        points[i] = {p[u], p[v]};
    }
    return points;
}

/// How often the outline turns around: once, unless the polygon crosses itself. Edges that run
/// straight back can be meant either way; then the answer is 1.
int turns(const std::vector<Vector2d>& points) {
    std::vector<Vector2d> edges;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vector2d edge = points[(i + 1) % points.size()] - points[i];
        if (edge != Vector2d(0)) edges.push_back(edge);
    }
    double angle = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const Vector2d a = edges[i], b = edges[(i + 1) % edges.size()];
        const double sine = a.x * b.y - a.y * b.x, cosine = glm::dot(a, b);
        if (sine == 0 && cosine < 0) return 1;
        angle += std::atan2(sine, cosine);
    }
    return static_cast<int>(std::lround(angle / (2 * std::numbers::pi)));
}

/// Cuts ears off a counter-clockwise polygon. Cutting one changes no other ear but those of its two
/// neighbours, so that each corner is looked at about three times.
class EarClipper {
public:
    explicit EarClipper(const std::vector<Vector2d>& points) : points_(points) {
        const auto count = static_cast<std::uint32_t>(points.size());
        for (std::uint32_t i = 0; i < count; ++i) {
            corners_.push_back({.before = i == 0 ? count - 1 : i - 1, .after = (i + 1) % count});
        }
        for (std::uint32_t i = 0; i < count; ++i) {
            corners_[i].turn = turn(i);
            if (corners_[i].turn <= 0) blockers_.push_back(i);
        }
        std::sort(blockers_.begin(), blockers_.end(),
                  [&](std::uint32_t a, std::uint32_t b) { return points_[a].x < points_[b].x; });
        find_ears();
    }

    /// Calls `take(a, b, c)` for each triangle. False if the polygon turned out to cross itself:
    /// the last triangles then are a fan.
    template <typename Take>
    bool clip(const Take& take) {
        bool is_simple = true;
        for (std::size_t left = points_.size(); left > 2; --left) {
            std::uint32_t ear = next_ear();
            if (ear == none) {  // rounding may have hidden one
                find_ears();
                ear = next_ear();
            }
            if (ear == none) ear = flat_corner();
            if (ear == none) {
                is_simple = false;
                ear = corners_[first_].after;
            }
            take(corners_[ear].before, ear, corners_[ear].after);
            remove(ear);
        }
        return is_simple;
    }

private:
    static constexpr std::uint32_t none = 0xffffffff;

    struct Corner {
        std::uint32_t before, after;
        double turn = 0;  ///< positive where the polygon is convex
        bool is_ear = false, removed = false;
    };

    double turn(std::uint32_t i) const {
        return orientation(points_[corners_[i].before], points_[i], points_[corners_[i].after]);
    }

    /// A convex corner whose triangle holds no corner that bends inwards.
    bool is_ear(std::uint32_t i) const {
        if (!(corners_[i].turn > 0)) return false;
        const Vector2d a = points_[corners_[i].before], b = points_[i],
                       c = points_[corners_[i].after];
        const double low = std::min({a.x, b.x, c.x}), high = std::max({a.x, b.x, c.x});
        auto at = std::lower_bound(blockers_.begin(), blockers_.end(), low,
                                   [&](std::uint32_t k, double x) { return points_[k].x < x; });
        for (; at != blockers_.end() && points_[*at].x <= high; ++at) {
            if (corners_[*at].removed || corners_[*at].turn > 0) continue;
            const Vector2d p = points_[*at];
            if (p == a || p == b || p == c) continue;  // outlines may touch there
            if (orientation(a, b, p) >= 0 && orientation(b, c, p) >= 0 && orientation(c, a, p) >= 0)
                return false;
        }
        return true;
    }

    void update(std::uint32_t i) {
        corners_[i].turn = turn(i);
        const bool was_ear = corners_[i].is_ear;
        corners_[i].is_ear = is_ear(i);
        if (corners_[i].is_ear && !was_ear) ears_.push_back(i);
    }

    void find_ears() {
        std::uint32_t i = first_;
        do {
            update(i);
            i = corners_[i].after;
        } while (i != first_);
    }

    std::uint32_t next_ear() {
        while (next_ear_ < ears_.size()) {
            const std::uint32_t ear = ears_[next_ear_++];
            if (corners_[ear].is_ear && !corners_[ear].removed) return ear;
        }
        return none;
    }

    /// A corner without an angle.
    std::uint32_t flat_corner() const {
        std::uint32_t i = first_;
        do {
            if (corners_[i].turn == 0) return i;
            i = corners_[i].after;
        } while (i != first_);
        return none;
    }

    void remove(std::uint32_t i) {
        const std::uint32_t before = corners_[i].before, after = corners_[i].after;
        corners_[i].removed = true;
        corners_[before].after = after;
        corners_[after].before = before;
        if (first_ == i) first_ = before;
        update(before);
        update(after);
    }

    const std::vector<Vector2d>& points_;
    std::vector<Corner> corners_;
    std::vector<std::uint32_t> blockers_;  ///< corners that were not convex at first, by x
    std::vector<std::uint32_t> ears_;      ///< in the order in which they were found
    std::size_t next_ear_ = 0;
    std::uint32_t first_ = 0;
};

}  // namespace

PolygonCut cut_polygon(std::span<const Vector3> positions, std::span<const std::uint32_t> corners,
                       std::vector<std::uint32_t>& triangles) {
    const Fan fan(positions, corners);
    if (fan.covers()) {
        fan.append(triangles);
        const bool is_crossing = fan.normal() == Vector3d(0) && !fan.is_flat();
        return is_crossing ? PolygonCut::crossing : PolygonCut::complete;
    }
    if (corners.size() > max_concave_corners) return PolygonCut::too_large;
    const std::vector<Vector2d> points = project(fan, corners.size());
    if (turns(points) != 1) {
        fan.append(triangles);
        return PolygonCut::crossing;
    }
    const bool is_simple =
        EarClipper(points).clip([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            triangles.insert(triangles.end(), {corners[a], corners[b], corners[c]});
        });
    return is_simple ? PolygonCut::complete : PolygonCut::crossing;
}

}  // namespace lucerna
