// SPDX-License-Identifier: Apache-2.0
/// What a city (city_plan.h) is made of: parallelograms, sorted by part and shade.
///
/// As many of the things that can shine are lit as are asked for. Which ones is a draw without
/// replacement, in which lamps have more tickets than shops, and shops more than windows of houses
/// (Efraimidis and Spirakis 2006: the smallest of −log(u) / weight).
#pragma once

#include "plugins/shapes/city_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace lucerna::city {

enum class Part {
    water,      ///< around the city
    streets,    ///< and the quay
    markings,   ///< white, on the streets
    pavements,  ///< and the quay's coping
    walls,      ///< of masonry
    glass,      ///< facades
    mirror,     ///< facades, and the water of basins
    roofs,      ///< and what stands on them
    panes,      ///< windows that are not lit, and those of cars
    posts,      ///< of lamps, masts
    cars,       ///< painted metal
    windows,    ///< from here on: lights
    shops,      ///< their windows
    signs,
    lamps,
    beacons,
    headlights,
    taillights
};

constexpr bool shines(Part part) { return part >= Part::windows; }

struct Quad {
    Vector3d corner, edge_u, edge_v;  ///< faces edge_u × edge_v
};

/// A vertical plane with a corner below on the left, seen from outside.
struct Wall {
    Vector3d corner, right, out;
    double length;

    /// A rectangle on it, `ahead` of it.
    Quad rectangle(double x, double y, double width, double height, double ahead) const {
        return {corner + x * right + Vector3d(0, y - corner.y, 0) + ahead * out, width * right,
                Vector3d(0, height, 0)};
    }
};

inline Wall wall_of(const Box& box, int side) {
    const Area& a = box.area;
    switch (side) {
        case 0:
            return {{a.x0, box.y0, a.z1}, {1, 0, 0}, {0, 0, 1}, a.width()};
        case 1:
            return {{a.x1, box.y0, a.z1}, {0, 0, -1}, {1, 0, 0}, a.depth()};
        case 2:
            return {{a.x1, box.y0, a.z0}, {-1, 0, 0}, {0, 0, -1}, a.width()};
        default:
            return {{a.x0, box.y0, a.z0}, {0, 0, 1}, {-1, 0, 0}, a.depth()};
    }
}

inline Quad top_of(const Area& a, double y) {
    return {{a.x0, y, a.z0}, {0, 0, a.depth()}, {a.width(), 0, 0}};
}

/// Receives what can shine.
struct Site {
    Part part;
    int shade;
    double weight;      ///< tickets in the draw
    std::uint64_t key;  ///< its luck
    Quad quad;

    double rank() const { return -std::log(1 - uint64_to_double(key)) / weight; }
};

/// Calls visit(Site) for all windows of a building. Lit ones look as if people were at home on
/// some floors and not on others.
template <typename Visit>
void visit_windows(const Building& building, const Visit& visit) {
    const bool masonry = building.facade == Facade::masonry;
    const double spacing = masonry ? 1.7 + 0.7 * chance(building.seed, 30) : 1.5;
    const double width = masonry ? 0.5 * spacing : spacing - 0.18;
    const double height = masonry ? 1.7 : 2.3, sill = masonry ? 0.9 : 0.6;
    const auto tone = hash_combine(building.seed, 31);
    for (std::size_t tier = 0; tier < building.tiers.size(); ++tier) {
        const Box& box = building.tiers[tier];
        for (int side = 0; side < 4; ++side) {
            const Wall wall = wall_of(box, side);
            const int columns = static_cast<int>((wall.length - 0.8) / spacing);
            const double margin = 0.5 * (wall.length - columns * spacing);
            const double ground = tier == 0 ? shop_height - storey : 0;
            const int floors = static_cast<int>((box.y1 - box.y0 - ground) / storey + 0.5);
            for (int floor = tier == 0 ? 1 : 0; floor < floors; ++floor) {
                const std::uint64_t row = hash64({tone, tier, static_cast<std::uint64_t>(floor)});
                const double mood = building.activity * (masonry ? 0.5 + chance(row, 1)
                                                         : chance(row, 2) < 0.35 ? 2.6
                                                                                 : 0.35);
                const double y = box.y0 + ground + floor * storey + sill;
                for (int column = 0; column < columns; ++column) {
                    const std::uint64_t key = hash64({row, static_cast<std::uint64_t>(side),
                                                      static_cast<std::uint64_t>(column)});
                    const double hue =
                        0.6 * chance(masonry ? key : row, 3) + 0.4 * chance(building.seed, 32);
                    const int shade = masonry ? (hue < 0.52  ? 0
                                                 : hue < 0.9 ? 1
                                                             : 3)
                                              : (hue < 0.3    ? 1
                                                 : hue < 0.93 ? 2
                                                              : 3);
                    const double x = margin + column * spacing + 0.5 * (spacing - width);
                    visit(Site{Part::windows, shade, mood, key,
                               wall.rectangle(x, y, width, height, 0.05)});
                }
            }
        }
    }
}

/// The ground floor: shop windows and signs above them.
template <typename Visit>
void visit_shops(const Building& building, const Visit& visit) {
    const Box& box = building.tiers.front();
    const auto keys = hash_combine(building.seed, 40);
    for (int side = 0; side < 4; ++side) {
        const Wall wall = wall_of(box, side);
        const int shops = std::max(1, static_cast<int>(wall.length / 5));
        const double width = wall.length / shops;
        for (int i = 0; i < shops; ++i) {
            const auto key =
                hash64({keys, static_cast<std::uint64_t>(side), static_cast<std::uint64_t>(i)});
            const double x = i * width + 0.5;
            const int shade = static_cast<int>(2 * chance(key, 1));
            visit(Site{Part::shops, shade, 6, hash_combine(key, 2),
                       wall.rectangle(x, box.y0 + 0.5, width - 1, 2.1, 0.05)});
            const int color = static_cast<int>(4 * chance(key, 3));
            const double kind = chance(key, 4);
            if (kind < 0.45) {
                visit(Site{Part::signs, color, 12, hash_combine(key, 5),
                           wall.rectangle(x + 0.3, box.y0 + 2.95, width - 1.6, 0.55, 0.12)});
            } else if (kind < 0.68 && box.y1 - box.y0 > 9) {
                const Vector3d low = wall.rectangle(x, box.y0 + 4, 0, 0, 0.25).corner;
                const Vector3d up(0, 3 + 2 * chance(key, 6), 0), out = 0.8 * wall.out;
                visit(Site{Part::signs, color, 12, hash_combine(key, 7), {low, out, up}});
                visit(Site{Part::signs,
                           color,
                           12,
                           hash_combine(key, 7),
                           {low + 0.1 * wall.right + out, -out, up}});
            }
        }
    }
}

/// Where lamps stand around a block: at the kerb, two to a side.
struct Lamp {
    Vector3d foot, outwards;
    std::uint64_t key;
    int shade;
};
constexpr double lamp_height = 5.5, lamp_reach = 1.4;

template <typename Visit>
void visit_lamps(const Block& block, const Visit& visit) {
    const Box kerbs{block.area.inset(-(pavement - 0.4)), kerb, kerb};
    const int shade = static_cast<int>(2 * chance(block.seed, 50));
    for (int side = 0; side < 4; ++side) {
        const Wall wall = wall_of(kerbs, side);
        for (int i = 0; i < 2; ++i) {
            const double x = wall.length * (i == 0 ? 0.27 : 0.77);
            visit(Lamp{wall.corner + x * wall.right, wall.out,
                       hash64({block.seed, 51, static_cast<std::uint64_t>(2 * side + i)}), shade});
        }
    }
}

/// A car at the kerb or on its way.
struct Car {
    Vector3d middle, ahead;  ///< on the ground; unit vector
    std::uint64_t key;
};
constexpr double car_length = 4.3, car_width = 1.75;

template <typename Visit>
void visit_cars(const Plan& plan, const Visit& visit) {
    for (const Block& block : plan.blocks()) {
        const Area road = block.area.inset(-(pavement + 0.25 * street));
        for (int side = 0; side < 4; ++side) {
            const Wall lane = wall_of({road, 0, 0}, side);
            const auto key = hash64({block.seed, 60, static_cast<std::uint64_t>(side)});
            if (chance(key, 1) < 0.55) continue;
            // Cars keep to the right, where their block is.
            visit(Car{lane.corner + (0.1 + 0.8 * chance(key, 2)) * lane.length * lane.right,
                      -lane.right, key});
        }
    }
}

/// Where the mast of a building stands, if it has one.
inline std::optional<Vector3d> mast_of(const Building& building) {
    const Box& top = building.tiers.back();
    if (building.facade == Facade::masonry || top.y1 < 36) return {};
    return Vector3d(0.5 * (top.area.x0 + top.area.x1), top.y1, 0.5 * (top.area.z0 + top.area.z1));
}
constexpr double mast_height = 8;

/// A box around a point of its bottom.
inline Box box_at(Vector3d bottom, double width, double depth, double height) {
    return {{bottom.x - 0.5 * width, bottom.z - 0.5 * depth, bottom.x + 0.5 * width,
             bottom.z + 0.5 * depth},
            bottom.y,
            bottom.y + height};
}

/// Calls visit(Quad) for the sides of a box and its top.
template <typename Visit>
void visit_faces(const Box& box, const Visit& visit) {
    for (int side = 0; side < 4; ++side) {
        const Wall wall = wall_of(box, side);
        visit(wall.rectangle(0, box.y0, wall.length, box.y1 - box.y0, 0));
    }
    visit(top_of(box.area, box.y1));
}

/// Calls visit(Site) for everything in the city that can shine.
template <typename Visit>
void visit_sites(const Plan& plan, const Visit& visit) {
    for (const Block& block : plan.blocks()) {
        for (const Building& building : block.buildings) {
            visit_windows(building, visit);
            visit_shops(building, visit);
            const std::optional<Vector3d> mast = mast_of(building);
            if (!mast) continue;
            std::uint64_t key = hash_combine(building.seed, 70);
            visit_faces(box_at(*mast + Vector3d(0, mast_height, 0), 0.5, 0.5, 0.5),
                        [&](const Quad& face) {
                            visit(Site{Part::beacons, 0, 40, ++key, face});
                        });
        }
        visit_lamps(block, [&](const Lamp& lamp) {
            const Vector3d end =
                lamp.foot + lamp_reach * lamp.outwards + Vector3d(0, lamp_height - 0.05, 0);
            const Area face = box_at(end, 1.2, 1.2, 0).area;
            visit(Site{Part::lamps,
                       lamp.shade,
                       40,
                       lamp.key,
                       {{face.x0, end.y, face.z0}, {face.width(), 0, 0}, {0, 0, face.depth()}}});
        });
    }
    visit_cars(plan, [&](const Car& car) {
        const Vector3d left = glm::cross(Vector3d(0, 1, 0), car.ahead);
        for (int i = 0; i < 4; ++i) {
            const bool head = i < 2;
            const double across = i % 2 == 0 ? 0.62 : -0.62, end = head ? 0.51 : -0.51;
            const Vector3d u = (head ? 0.3 : -0.36) * left, v(0, head ? 0.16 : 0.12, 0);
            const Vector3d at =
                car.middle + end * car_length * car.ahead + across * left + Vector3d(0, 0.55, 0);
            visit(Site{head ? Part::headlights : Part::taillights,
                       0,
                       30,
                       hash_combine(car.key, 3),
                       {at - 0.5 * u, u, v}});
        }
    });
}

}  // namespace lucerna::city
