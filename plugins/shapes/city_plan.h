// SPDX-License-Identifier: Apache-2.0
/// The plan of a procedural city: where its blocks are, and what is built on them.
///
/// y is up, lengths are metres, the middle of the city is a crossing at the origin. Everything is a
/// function of the seed and of a place's own number, so that a part of the city (city_parts.h) can
/// be made without the others.
#pragma once

#include "core/math/sequences.h"

#include <vector>

namespace lucerna::city {

constexpr double pitch = 36;       ///< from street to street
constexpr double street = 10;      ///< width of a street
constexpr double pavement = 2.5;   ///< width of a pavement
constexpr double kerb = 0.15;      ///< height of a pavement
constexpr double storey = 3.3;     ///< height of a storey
constexpr double shop_height = 4;  ///< of a ground floor

/// A random number in [0, 1) that belongs to a seed and a number.
inline double chance(std::uint64_t seed, std::uint64_t number) {
    return uint64_to_double(hash_combine(seed, number));
}

/// A rectangle on the ground, in the plane y = 0.
struct Area {
    double x0, z0, x1, z1;

    double width() const { return x1 - x0; }
    double depth() const { return z1 - z0; }
    Area inset(double d) const { return {x0 + d, z0 + d, x1 - d, z1 - d}; }
};

struct Box {
    Area area;
    double y0, y1;
};

enum class Facade { masonry, glass, mirror };

/// A stack of boxes, each smaller than the one below.
struct Building {
    std::uint64_t seed;
    Facade facade;
    int shade;               ///< of masonry, 0 to 3
    double activity;         ///< how likely its windows are lit, around 1
    std::vector<Box> tiers;  ///< the first has a ground floor of shop_height
};

struct Block {
    std::uint64_t seed;
    Area area;                        ///< without pavements
    bool square;                      ///< without buildings: a basin of water
    std::vector<Building> buildings;  ///< none on a square
};

/// size × size blocks.
class Plan {
public:
    Plan(int size, std::uint64_t seed) : seed_(hash_combine(0x63697479, seed)), size_(size) {
        blocks_.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
        for (int j = 0; j < size; ++j) {
            for (int i = 0; i < size; ++i) add_block(i, j);
        }
    }

    const std::vector<Block>& blocks() const { return blocks_; }
    std::uint64_t seed() const { return seed_; }
    int size() const { return size_; }
    /// All blocks with the streets around them.
    Area area() const {
        return {edge(0) - street, edge(0) - street, edge(size_) + street, edge(size_) + street};
    }
    /// The middle of street number i, 0 to size.
    double edge(int i) const { return pitch * (i - size_ / 2); }

private:
    void add_block(int i, int j) {
        const std::uint64_t seed =
            hash64({seed_, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(j)});
        const Area whole{edge(i), edge(j), edge(i + 1), edge(j + 1)};
        Block block{.seed = seed,
                    .area = whole.inset(0.5 * street + pavement),
                    .square = size_ > 3 && chance(seed, 1) < 0.07,
                    .buildings = {}};
        if (!block.square) divide(block, block.area, seed, 0);
        blocks_.push_back(std::move(block));
    }

    /// How tall houses are at a place, 0 to 1: a centre, and hills of a few blocks elsewhere.
    double tallness(double x, double z) const {
        const double reach = 0.2 * pitch * size_ + pitch;
        const double centre = std::exp(-(x * x + z * z) / (2 * reach * reach));
        const double wave = std::sin(0.013 * x + 1.3) * std::sin(0.011 * z + 0.4);
        return std::min(1.0, centre + 0.5 * std::max(0.0, wave));
    }

    /// Lots: a block is cut in two until the pieces are small, or by chance large.
    void divide(Block& block, Area lot, std::uint64_t seed, int depth) {
        const bool along_x = lot.width() > lot.depth();
        const double length = std::max(lot.width(), lot.depth());
        if (length > 19 || (length > 10 && chance(seed, 2) < 0.55 && depth < 3)) {
            const double at = 0.36 + 0.28 * chance(seed, 3);
            Area first = lot, second = lot;
            if (along_x) {
                first.x1 = second.x0 = lot.x0 + at * lot.width();
            } else {
                first.z1 = second.z0 = lot.z0 + at * lot.depth();
            }
            divide(block, first, hash_combine(seed, 4), depth + 1);
            divide(block, second, hash_combine(seed, 5), depth + 1);
            return;
        }
        add_building(block, lot, hash_combine(seed, 6));
    }

    void add_building(Block& block, Area lot, std::uint64_t seed) {
        const double tall = tallness(0.5 * (lot.x0 + lot.x1), 0.5 * (lot.z0 + lot.z1));
        const double luck = chance(seed, 1);
        const int storeys = 2 + static_cast<int>(5 * luck + 20 * tall * luck * luck * luck +
                                                 4 * tall * chance(seed, 2));
        const double modern = chance(seed, 3);
        Building building{.seed = seed,
                          .facade = Facade::masonry,
                          .shade = static_cast<int>(4 * chance(seed, 4)),
                          .activity = 0.25 + 1.9 * sqr(chance(seed, 5)),
                          .tiers = {}};
        if (storeys > 9 && modern < 0.62) building.facade = Facade::glass;
        if (storeys > 9 && modern < 0.16) building.facade = Facade::mirror;
        add_tiers(building, lot.inset(0.15 + 0.5 * chance(seed, 6)), storeys);
        block.buildings.push_back(std::move(building));
    }

    static void add_tiers(Building& building, Area area, int storeys) {
        int left = storeys;
        double y = kerb;
        const int most = storeys > 9 ? 3 : 1;
        for (int tier = 0; tier < most && left > 0; ++tier) {
            const auto number = static_cast<std::uint64_t>(tier);
            const double share =
                tier + 1 == most ? 1.0 : 0.45 + 0.3 * chance(building.seed, number + 10);
            const int here = std::max(1, static_cast<int>(share * left));
            const double height = here * storey + (tier == 0 ? shop_height - storey : 0);
            building.tiers.push_back({area, y, y + height});
            y += height;
            left -= here;
            area = area.inset(0.7 + 1.2 * chance(building.seed, number + 20));
            if (std::min(area.width(), area.depth()) < 5) break;
        }
    }

    std::uint64_t seed_;
    int size_;
    std::vector<Block> blocks_;
};

}  // namespace lucerna::city
