// SPDX-License-Identifier: Apache-2.0
#include "core/math/polygon.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace lucerna {
namespace {

struct Cut {
    PolygonCut result;
    std::vector<std::uint32_t> triangles;
};

Cut cut(const std::vector<Vector3>& corners) {
    std::vector<std::uint32_t> indices(corners.size());
    std::iota(indices.begin(), indices.end(), 0u);
    Cut c{};
    c.result = cut_polygon(corners, indices, c.triangles);
    return c;
}

std::vector<Vector3> in_plane(const std::vector<Vector2>& points) {
    std::vector<Vector3> corners;
    for (const Vector2 p : points) corners.emplace_back(p, 0.0f);
    return corners;
}

/// Areas of the triangles: their sum with sign (along +z), and that of their absolute values.
std::pair<double, double> areas(const std::vector<Vector3>& corners, const Cut& c) {
    double sum = 0, absolute_sum = 0;
    for (std::size_t i = 0; i < c.triangles.size(); i += 3) {
        const Vector3d a(corners[c.triangles[i]]), b(corners[c.triangles[i + 1]]),
            d(corners[c.triangles[i + 2]]);
        const double area = 0.5 * glm::cross(b - a, d - a).z;
        sum += area;
        absolute_sum += std::abs(area);
    }
    return {sum, absolute_sum};
}

/// n − 2 triangles that turn as the polygon does and cover its area: then each point once.
void expect_covered(const std::vector<Vector3>& corners, double area) {
    const Cut c = cut(corners);
    EXPECT_EQ(c.result, PolygonCut::complete);
    EXPECT_EQ(c.triangles.size(), 3 * (corners.size() - 2));
    const auto [sum, absolute_sum] = areas(corners, c);
    EXPECT_NEAR(sum, area, 1e-6 * std::abs(area));
    EXPECT_NEAR(absolute_sum, std::abs(area), 1e-6 * std::abs(area));
}

/// The same from every corner on, and in both directions.
void expect_covered_from_all_corners(std::vector<Vector2> points, double area) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        std::rotate(points.begin(), points.begin() + 1, points.end());
        expect_covered(in_plane(points), area);
        expect_covered(in_plane({points.rbegin(), points.rend()}), -area);
    }
}

TEST(Polygon, ConvexOnesAreFansAroundTheFirstCorner) {
    const Cut c = cut(in_plane({{0, 0}, {2, 0}, {3, 1}, {2, 2}, {0, 2}}));
    EXPECT_EQ(c.triangles, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 0, 3, 4}));
}

TEST(Polygon, ConcaveOnesAreCoveredOnceWhereverTheyBegin) {
    expect_covered_from_all_corners({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 3);
    expect_covered_from_all_corners({{0, 0}, {2, 2}, {4, 0}, {2, 6}}, 8);  // an arrow
    expect_covered_from_all_corners(
        {{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}},
        7);  // a U
    expect_covered_from_all_corners(
        {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {1, 3}, {0, 3}, {0, 1}},
        4);  // corners without an angle
}

TEST(Polygon, HolesThatAreJoinedToTheOutlineStayOpen) {
    // A square of 16 with a square hole of 4; the outline goes in and out along one edge.
    expect_covered_from_all_corners(
        {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}}, 12);
    // Two holes, joined to the same corner.
    expect_covered_from_all_corners({{0, 0},
                                     {9, 0},
                                     {9, 4},
                                     {0, 4},
                                     {0, 0},
                                     {1, 1},
                                     {1, 3},
                                     {3, 3},
                                     {3, 1},
                                     {1, 1},
                                     {0, 0},
                                     {6, 1},
                                     {6, 3},
                                     {8, 3},
                                     {8, 1},
                                     {6, 1}},
                                    28);
}

TEST(Polygon, ManyCornersInAnyPlane) {
    // A star with corners on two circles, area n r R sin(π / n), turned by a random rotation.
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const int n = 500;
    const double area = n * 1.0 * 0.2 * std::sin(std::numbers::pi / n);
    for (int round = 0; round < 20; ++round) {
        const Vector3d s =
            glm::normalize(Vector3d(uniform(random), uniform(random), uniform(random)));
        const Vector3d t =
            glm::normalize(glm::cross(s, Vector3d(uniform(random), uniform(random), 0.1)));
        std::vector<Vector3> corners;
        for (int i = 0; i < 2 * n; ++i) {
            const double r = i % 2 ? 0.2 : 1.0, angle = std::numbers::pi * i / n;
            corners.emplace_back(r * std::cos(angle) * s + r * std::sin(angle) * t);
        }
        const Cut c = cut(corners);
        EXPECT_EQ(c.result, PolygonCut::complete);
        double sum = 0, absolute_sum = 0;
        const Vector3d normal = glm::cross(s, t);
        for (std::size_t i = 0; i < c.triangles.size(); i += 3) {
            const Vector3d a(corners[c.triangles[i]]), b(corners[c.triangles[i + 1]]),
                d(corners[c.triangles[i + 2]]);
            sum += 0.5 * glm::dot(glm::cross(b - a, d - a), normal);
            absolute_sum += 0.5 * glm::length(glm::cross(b - a, d - a));
        }
        EXPECT_NEAR(sum, area, 1e-5 * area);
        EXPECT_NEAR(absolute_sum, area, 1e-5 * area);
    }
}

TEST(Polygon, RandomOutlinesAreCovered) {
    // Seen from the origin all corners lie in the order of their angles: the outline is simple.
    std::mt19937 random(11);
    std::uniform_real_distribution<float> radius(0.05f, 1);
    for (int round = 0; round < 300; ++round) {
        std::vector<Vector2> points;
        const int n = 4 + round % 60;
        for (int i = 0; i < n; ++i) {
            const float angle = 2 * pi * static_cast<float>(i) / static_cast<float>(n);
            points.push_back(radius(random) * Vector2(std::cos(angle), std::sin(angle)));
        }
        double area = 0;  // shoelace
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vector2d a(points[i]), b(points[(i + 1) % points.size()]);
            area += 0.5 * (a.x * b.y - a.y * b.x);
        }
        expect_covered(in_plane(points), area);
    }
}

TEST(Polygon, RepeatedCornersAreHarmless) {
    expect_covered_from_all_corners(
        {{0, 0}, {2, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 1}, {1, 1}, {1, 2}, {0, 2}}, 3);
}

TEST(Polygon, OnesThatCrossThemselvesAreTold) {
    EXPECT_EQ(cut(in_plane({{0, 0}, {1, 1}, {1, 0}, {0, 1}})).result, PolygonCut::crossing);
    EXPECT_EQ(cut(in_plane({{0, 0}, {3, 3}, {3, 0}, {0, 1}})).result, PolygonCut::crossing);
    std::vector<Vector2> pentagram;
    for (int i = 0; i < 5; ++i) {
        const float angle = 0.8f * pi * static_cast<float>(i);
        pentagram.push_back({std::cos(angle), std::sin(angle)});
    }
    const Cut star = cut(in_plane(pentagram));
    EXPECT_EQ(star.result, PolygonCut::crossing);
    EXPECT_EQ(star.triangles.size(), 9u);
}

TEST(Polygon, TheLargestOneIsCutAndALargerOneRefused) {
    // A comb, whose ears are as wide as it is: the slowest case.
    const auto comb = [](std::size_t corners) {
        std::vector<Vector2> points = {{0, 0}, {static_cast<float>(corners), 0}};
        for (std::size_t i = 2; i < corners; ++i) {
            points.push_back({static_cast<float>(corners - i), i % 2 ? 1.0f : 100.0f});
        }
        return in_plane(points);
    };
    const Cut largest = cut(comb(max_concave_corners));
    EXPECT_EQ(largest.result, PolygonCut::complete);
    EXPECT_EQ(largest.triangles.size(), 3 * (max_concave_corners - 2));
    const Cut refused = cut(comb(max_concave_corners + 1));
    EXPECT_EQ(refused.result, PolygonCut::too_large);
    EXPECT_TRUE(refused.triangles.empty());
}

TEST(Polygon, DegenerateOnesBecomeDegenerateTriangles) {
    const Cut point = cut(std::vector<Vector3>(5, Vector3(1, 2, 3)));
    EXPECT_EQ(point.result, PolygonCut::complete);
    EXPECT_EQ(point.triangles.size(), 9u);
    EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {2, 0, 0}}).result, PolygonCut::complete);
}

}  // namespace
}  // namespace lucerna
