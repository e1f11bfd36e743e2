// SPDX-License-Identifier: Apache-2.0
/// city: a part of a procedural city at night, made of rectangles.
///
///   lights        integer    5000       lights of the whole city, over all parts that shine
///   size          integer    0          blocks along each side; 0: enough for the lights
///   seed          integer    1          another seed is another city
///   part          string     windows    which part of the city this shape is
///   shade         integer    −1         which of its four shades; −1: all
///   to_world, flip_normals              as of all shapes
///
/// A shape has one material and one emitter, a city has many: so a scene names the shape once for
/// each material, always with the same lights, size and seed, and the parts fit together. Each
/// rectangle is one primitive, and one light where the shape emits. All shades of `windows`,
/// `shops`, `signs`, `lamps`, `beacons`, `headlights` and `taillights` have together exactly as
/// many rectangles as `lights` says. y is up, lengths are metres.
#include "plugins/shapes/city_parts.h"
#include "plugins/shapes/parallelograms.h"

#include <fmt/format.h>

namespace lucerna {
namespace {

using namespace city;

/// Blocks along each side, so that about a third of the windows are lit; streets cross in the
/// middle.
int size_for(std::int64_t lights) {
    constexpr double lights_of_a_block = 200;
    const double side = std::sqrt(static_cast<double>(lights) / lights_of_a_block);
    return std::max(3, static_cast<int>(std::ceil(side)));
}

class CityShape final : public Parallelograms {
public:
    explicit CityShape(const Params& params) : Parallelograms(params) {
        const std::int64_t lights = params.integer("lights", 5000, {.min = 0, .max = 1e8},
                                                   "lights of the whole city, over all its parts");
        const int size = params.int32("size", 0, {.min = 0, .max = 2000},
                                      "blocks along each side; 0: enough for the lights");
        const std::int64_t seed =
            params.integer("seed", 1, {.min = 0}, "another one, another city");
        part_ = params.choice<Part>("part", Part::windows,
                                    {{"water", Part::water},
                                     {"streets", Part::streets},
                                     {"markings", Part::markings},
                                     {"pavements", Part::pavements},
                                     {"walls", Part::walls},
                                     {"glass", Part::glass},
                                     {"mirror", Part::mirror},
                                     {"roofs", Part::roofs},
                                     {"panes", Part::panes},
                                     {"posts", Part::posts},
                                     {"cars", Part::cars},
                                     {"windows", Part::windows},
                                     {"shops", Part::shops},
                                     {"signs", Part::signs},
                                     {"lamps", Part::lamps},
                                     {"beacons", Part::beacons},
                                     {"headlights", Part::headlights},
                                     {"taillights", Part::taillights}},
                                    "which part of the city this shape is");
        shade_ = params.int32("shade", -1, {.min = -1, .max = 3},
                              "which of the part's four shades; -1: all");

        const Plan plan(size > 0 ? size : size_for(lights), static_cast<std::uint64_t>(seed));
        if (shines(part_) || part_ == Part::panes) add_lights(plan, lights);
        if (!shines(part_)) {
            add_ground(plan);
            for (const Block& block : plan.blocks()) add_block(block);
            visit_cars(plan, [&](const Car& car) { add_car(car); });
        }
        assign(std::move(list_), flip_normals() != world_from_object().swaps_handedness());
    }

private:
    /// Keeps what belongs to this shape.
    void add(Part part, int shade, const Quad& quad) {
        if (part != part_ || (shade_ >= 0 && shade != shade_)) return;
        const Transform& world = world_from_object();
        list_.push_back({.corner = Vector3(world.point(quad.corner)),
                         .edge_u = Vector3(world.direction(quad.edge_u)),
                         .edge_v = Vector3(world.direction(quad.edge_v))});
    }

    void add_box(Part part, int shade, const Box& box) {
        if (part != part_) return;
        visit_faces(box, [&](const Quad& face) { add(part, shade, face); });
    }

    void add_lights(const Plan& plan, std::int64_t lights);
    void add_ground(const Plan& plan);
    void add_markings(const Plan& plan);
    void add_block(const Block& block);
    void add_building(const Building& building);
    void add_roof(const Building& building, const Box& tier, bool top);
    void add_lamp(const Lamp& lamp);
    void add_car(const Car& car);

    Part part_;
    int shade_;
    std::vector<Parallelogram> list_;  ///< until it is assigned
};

void CityShape::add_lights(const Plan& plan, std::int64_t lights) {
    std::vector<double> ranks;
    visit_sites(plan, [&](const Site& site) { ranks.push_back(site.rank()); });
    const auto wanted = static_cast<std::size_t>(lights);
    if (wanted > ranks.size()) {
        throw Error(
            fmt::format("a city of {0} × {0} blocks has room for {1} lights, and {2} are "
                        "asked for; make \"size\" larger, or leave it out",
                        plan.size(), ranks.size(), lights));
    }
    // Sites of the same rank, the faces of one thing, are lit in the order in which they come.
    double last = -1;
    std::size_t of_last = 0;
    if (wanted > 0) {
        const auto nth = ranks.begin() + static_cast<std::ptrdiff_t>(wanted - 1);
        std::nth_element(ranks.begin(), nth, ranks.end());
        last = *nth;
        of_last = wanted - static_cast<std::size_t>(std::count_if(
                               ranks.begin(), ranks.end(), [&](double r) { return r < last; }));
    }
    visit_sites(plan, [&](const Site& site) {
        const double rank = site.rank();
        const bool lit = rank < last || (rank == last && of_last > 0);
        if (rank == last && lit) --of_last;
        if (lit) {
            add(site.part, site.shade, site.quad);
        } else if (site.part == Part::windows || site.part == Part::shops) {
            add(Part::panes, site.shade, site.quad);
        }
    });
}

void CityShape::add_ground(const Plan& plan) {
    const Area area = plan.area();
    constexpr double water_level = -2, sea = 6000;
    add(Part::water, 0, top_of(area.inset(-sea), water_level));
    add(Part::streets, 0, top_of(area, 0));
    const Box quay{area, water_level - 1, 0};
    for (int side = 0; side < 4; ++side) {
        const Wall wall = wall_of(quay, side);
        add(Part::streets, 0, wall.rectangle(0, quay.y0, wall.length, -quay.y0, 0));
        const Wall rim = wall_of({area.inset(1), 0, 0}, side);
        const Vector3d a = rim.corner, b = rim.corner + rim.length * rim.right;
        Box coping{{std::min(a.x, b.x), std::min(a.z, b.z), std::max(a.x, b.x), std::max(a.z, b.z)},
                   0,
                   0.8};
        coping.area = coping.area.inset(-0.2);
        add_box(Part::pavements, 0, coping);
    }
    add_markings(plan);
}

/// A dashed line in the middle of each street, from block to block.
void CityShape::add_markings(const Plan& plan) {
    if (part_ != Part::markings) return;
    constexpr double height = 0.012, line = 0.14, dash = 2, gap = 3;
    for (int i = 0; i <= plan.size(); ++i) {
        for (int j = 0; j < plan.size(); ++j) {
            for (double at = 0.5 * street + 1; at + dash < pitch - 0.5 * street; at += dash + gap) {
                const double across = plan.edge(i), along = plan.edge(j) + at;
                const Area first{across - 0.5 * line, along, across + 0.5 * line, along + dash};
                add(Part::markings, 0, top_of(first, height));
                add(Part::markings, 0, top_of({first.z0, first.x0, first.z1, first.x1}, height));
            }
        }
    }
}

void CityShape::add_block(const Block& block) {
    add_box(Part::pavements, 0, {block.area.inset(-pavement), 0, kerb});
    if (block.square) {
        const Area basin = block.area.inset(5);
        add_box(Part::pavements, 1, {basin.inset(-0.5), kerb, kerb + 0.45});
        add(Part::mirror, 1, top_of(basin, kerb + 0.46));
    }
    for (const Building& building : block.buildings) add_building(building);
    visit_lamps(block, [&](const Lamp& lamp) { add_lamp(lamp); });
}

void CityShape::add_building(const Building& building) {
    const Part part = building.facade == Facade::masonry ? Part::walls
                      : building.facade == Facade::glass ? Part::glass
                                                         : Part::mirror;
    for (const Box& tier : building.tiers) {
        for (int side = 0; side < 4; ++side) {
            const Wall wall = wall_of(tier, side);
            add(part, part == Part::walls ? building.shade : 0,
                wall.rectangle(0, tier.y0, wall.length, tier.y1 - tier.y0, 0));
        }
        add_roof(building, tier, &tier == &building.tiers.back());
    }
    if (const std::optional<Vector3d> mast = mast_of(building)) {
        add_box(Part::posts, 0, box_at(*mast, 0.25, 0.25, mast_height));
    }
}

/// A flat roof behind a parapet, with a hut and machines on the highest.
void CityShape::add_roof(const Building& building, const Box& tier, bool top) {
    if (part_ != Part::roofs && part_ != Part::walls) return;
    constexpr double parapet = 0.8, thickness = 0.3;
    add(Part::roofs, building.shade, top_of(tier.area, tier.y1));
    const Area a = tier.area.inset(-0.08);
    const double y0 = tier.y1 - 0.25, y1 = tier.y1 + parapet, t = thickness;
    for (const Area& rim :
         {Area{a.x0, a.z0, a.x1, a.z0 + t}, Area{a.x0, a.z1 - t, a.x1, a.z1},
          Area{a.x0, a.z0 + t, a.x0 + t, a.z1 - t}, Area{a.x1 - t, a.z0 + t, a.x1, a.z1 - t}}) {
        add_box(Part::roofs, building.shade, {rim, y0, y1});
    }
    if (!top || mast_of(building)) return;
    const Area inner = tier.area.inset(2.2);
    if (std::min(inner.width(), inner.depth()) < 1) return;
    for (std::uint64_t i = 0; i < 3; ++i) {
        const auto key = hash64({building.seed, 80, i});
        const Vector3d at(inner.x0 + chance(key, 1) * inner.width(), tier.y1,
                          inner.z0 + chance(key, 2) * inner.depth());
        const double width = i == 0 ? 2.6 : 0.9 + chance(key, 3), height = i == 0 ? 2.4 : 1.1;
        add_box(i == 0 ? Part::walls : Part::roofs, building.shade,
                box_at(at, width, width * (0.8 + 0.4 * chance(key, 4)), height));
    }
}

void CityShape::add_lamp(const Lamp& lamp) {
    if (part_ != Part::posts) return;
    add_box(Part::posts, 0, box_at(lamp.foot, 0.12, 0.12, lamp_height));
    const Vector3d arm = 0.5 * lamp_reach * lamp.outwards;
    const Vector3d top = lamp.foot + Vector3d(0, lamp_height, 0);
    add_box(Part::posts, 0,
            box_at(top + arm, 0.1 + 2 * std::abs(arm.x), 0.1 + 2 * std::abs(arm.z), 0.08));
    add_box(Part::posts, 0, box_at(top + 2.0 * arm - Vector3d(0, 0.04, 0), 0.6, 0.6, 0.14));
}

void CityShape::add_car(const Car& car) {
    if (part_ != Part::cars && part_ != Part::panes) return;
    const bool along_x = std::abs(car.ahead.x) > 0.5;
    const auto box = [&](double behind, double y, double length, double width, double height) {
        const Vector3d bottom = car.middle - behind * car.ahead + Vector3d(0, y, 0);
        return box_at(bottom, along_x ? length : width, along_x ? width : length, height);
    };
    const int shade = static_cast<int>(4 * chance(car.key, 4));
    add_box(Part::cars, shade, box(0, 0.25, car_length, car_width, 0.6));
    add_box(Part::panes, 0, box(0.25, 0.85, 0.55 * car_length, car_width - 0.25, 0.5));
    add_box(Part::cars, shade, box(0.25, 1.35, 0.5 * car_length, car_width - 0.3, 0.05));
}

}  // namespace

const PluginInfo plugin = describe<CityShape>("a part of a procedural city at night");

}  // namespace lucerna
