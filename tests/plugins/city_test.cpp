// SPDX-License-Identifier: Apache-2.0
/// The shape `city`: its parts fit together, have as many lights as they should, and are the same
/// each time.
#include "tests/paths.h"
#include "tests/plugins/world.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>
#include <tuple>

namespace lucerna {
namespace {

const char* const shining[] = {"windows", "shops",      "signs",     "lamps",
                               "beacons", "headlights", "taillights"};

std::string city(const std::string& part, int lights, int size, int seed = 1, int shade = -1) {
    return fmt::format(
        "<shape type='city'><string name='part' value='{}'/><integer name='lights' value='{}'/>"
        "<integer name='size' value='{}'/><integer name='seed' value='{}'/>"
        "<integer name='shade' value='{}'/></shape>",
        part, lights, size, seed, shade);
}

std::vector<Parallelogram> list_of(const World& world) {
    const Geometry geometry = world.shape().geometry();
    return std::get<ParallelogramGeometry>(geometry).list;
}

std::uint32_t count(const std::string& xml) { return World(xml).shape().primitive_count(); }

TEST(City, has_exactly_as_many_lights_as_are_asked_for) {
    for (const auto& [lights, size, seed] :
         {std::tuple{0, 2, 1}, {1, 1, 1}, {7, 1, 2}, {300, 0, 3}, {5000, 0, 1}, {5000, 8, 9}}) {
        std::uint32_t sum = 0;
        for (const char* part : shining) sum += count(city(part, lights, size, seed));
        EXPECT_EQ(sum, static_cast<std::uint32_t>(lights)) << size << " " << seed;
    }
}

TEST(City, more_lights_keep_those_that_were_lit) {
    const auto corners = [](int lights) {
        std::set<std::tuple<float, float, float>> result;
        const World world(city("windows", lights, 4));
        for (const Parallelogram& it : list_of(world)) {
            result.insert({it.corner.x, it.corner.y, it.corner.z});
        }
        return result;
    };
    const auto few = corners(1000), many = corners(1500);
    EXPECT_GT(many.size(), few.size());
    for (const auto& corner : few) EXPECT_TRUE(many.contains(corner));
}

TEST(City, a_window_is_lit_or_a_dark_pane) {
    // As many windows and shops, however many of them are lit.
    const auto windows = [](int lights) {
        return count(city("windows", lights, 3)) + count(city("shops", lights, 3)) +
               count(city("panes", lights, 3));
    };
    EXPECT_EQ(windows(0), windows(3000));
}

TEST(City, shades_are_the_whole_part) {
    for (const char* part : {"windows", "walls", "signs", "cars", "roofs"}) {
        std::uint32_t sum = 0;
        for (int shade = 0; shade < 4; ++shade) sum += count(city(part, 2000, 0, 1, shade));
        EXPECT_EQ(sum, count(city(part, 2000, 0))) << part;
        EXPECT_GT(sum, 0u) << part;
    }
}

TEST(City, the_seed_decides) {
    const World first(city("walls", 100, 3, 5)), same(city("walls", 100, 3, 5));
    const World other(city("walls", 100, 3, 6));
    ASSERT_EQ(list_of(first).size(), list_of(same).size());
    bool differs = list_of(first).size() != list_of(other).size();
    for (std::size_t i = 0; i < list_of(first).size(); ++i) {
        EXPECT_EQ(list_of(first)[i].corner, list_of(same)[i].corner);
        if (!differs) differs = list_of(first)[i].corner != list_of(other)[i].corner;
    }
    EXPECT_TRUE(differs);
}

TEST(City, windows_face_away_from_their_building) {
    // The wall is behind the window, and near; nothing is as near in front of it.
    const World world(city("windows", 2000, 3));
    const World walls(city("walls", 2000, 3)), glass(city("glass", 2000, 3)),
        mirror(city("mirror", 2000, 3));
    const auto meets_a_wall = [&](const Ray& ray) {
        return walls.scene().occluded(ray) || glass.scene().occluded(ray) ||
               mirror.scene().occluded(ray);
    };
    for (std::uint32_t i = 0; i < world.shape().primitive_count(); ++i) {
        const SurfaceSample middle = world.shape().sample_area(i, Vector2(0.5f));
        EXPECT_EQ(middle.n.y, 0);
        EXPECT_FALSE(meets_a_wall({.o = middle.p, .d = middle.n, .tmax = 0.1f}));
        EXPECT_TRUE(meets_a_wall({.o = middle.p, .d = -middle.n, .tmax = 0.1f})) << i;
    }
}

TEST(City, refuses_more_lights_than_it_has_room_for) {
    try {
        const World world(city("windows", 100000, 1));
        FAIL();
    } catch (const std::exception& e) {
        EXPECT_NE(std::string(e.what()).find("make \"size\" larger"), std::string::npos)
            << e.what();
    }
}

}  // namespace
}  // namespace lucerna
