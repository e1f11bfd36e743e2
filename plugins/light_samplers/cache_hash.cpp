// SPDX-License-Identifier: Apache-2.0
/// cache_hash: cache points, found by spatial hash: constant time, and not always the closest.
///
/// Cubes of halving size are hashed. A point x looks into the smallest cube around it that holds a
/// cache point, and takes the closest one of that cube alone: without jitter, pictures show the
/// borders of the cubes as squares of different noise. With it, x is moved by up to half a cube
/// along the surface, as a hash of x says, before it looks.
#include "plugins/light_samplers/memory/cache_points.h"
#include "plugins/light_samplers/memory/cache_sampler.h"
#include "plugins/light_samplers/memory/jitter.h"

#include <map>

namespace lucerna {

namespace {

class HashLookup {
public:
    explicit HashLookup(const Params& params)
        : jitter_(params.real("jitter", 1, unit_interval,
                              "size of the region around a point, in cubes, that is looked at")) {}

    void build(const std::vector<Vector3>& points, const Bounds3& bounds);
    std::uint32_t find(const Receiver& at) const;

private:
    static constexpr int finest = 16;
    static constexpr std::size_t most_points = 8;  ///< of a cube that are looked at

    struct Cube {
        std::uint32_t place;  ///< in `members_`
        float edge;
    };

    std::uint64_t key(Vector3 p, int level) const {
        const Vector3 x = (p - corner_) * (std::ldexp(1.0f, level) / size_);
        std::uint64_t key = 1 + static_cast<std::uint64_t>(level);
        for (int i = 0; i < 3; ++i) {
            // Points beside the scene look into the cubes at its border.
            const float cube = std::clamp(std::floor(x[i]), 0.0f, std::ldexp(1.0f, level) - 1);
            key = key << 18 | static_cast<std::uint64_t>(cube);
        }
        return key;
    }
    Cube smallest(Vector3 p) const {
        int level = levels_ - 1;
        std::uint32_t found = cubes_.find(key(p, level));
        while (found == KeyTable::none && level > 0) found = cubes_.find(key(p, --level));
        return {found, std::ldexp(size_, -level)};
    }

    float jitter_;
    Vector3 corner_{0};
    float size_ = 1;
    int levels_ = 1;
    KeyTable cubes_;
    std::vector<std::vector<std::uint32_t>> members_;  ///< the points of each cube
    std::vector<Vector3> points_;
};

void HashLookup::build(const std::vector<Vector3>& points, const Bounds3& bounds) {
    points_ = points;
    corner_ = bounds.min;
    size_ = std::max(max_component(bounds.extent()), 1e-20f);
    std::vector<std::uint64_t> keys;
    members_.clear();
    // Until most points are alone in their cubes.
    std::size_t cubes_of_level = 0;
    for (levels_ = 0; levels_ <= finest && 10 * cubes_of_level < 9 * points.size(); ++levels_) {
        std::map<std::uint64_t, std::vector<std::uint32_t>> cubes;
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            cubes[key(points[i], levels_)].push_back(i);
        }
        cubes_of_level = cubes.size();
        for (const auto& [key, cube] : cubes) {
            keys.push_back(key);
            // A large cube keeps a few that are far from each other in the order of placement.
            const std::size_t count = std::min(cube.size(), most_points);
            members_.emplace_back();
            for (std::size_t k = 0; k < count; ++k) {
                members_.back().push_back(cube[k * cube.size() / count]);
            }
        }
    }
    cubes_ = KeyTable(std::move(keys));
}

std::uint32_t HashLookup::find(const Receiver& at) const {
    Cube cube = smallest(at.p);
    if (jitter_ > 0) {
        cube = smallest(jittered(at, (at.p - corner_) / size_, jitter_ * cube.edge));
    }
    const auto distance2 = [&](std::uint32_t point) {
        const Vector3 d = points_[point] - at.p;
        return glm::dot(d, d);
    };
    const std::vector<std::uint32_t>& members = members_[cube.place];
    return *std::min_element(members.begin(), members.end(),
                             [&](auto a, auto b) { return distance2(a) < distance2(b); });
}

}  // namespace

const PluginInfo plugin = describe<CacheSampler<CachePoints<HashLookup>>>(
    "cache points remember lights; one that is close is found by hash");

}  // namespace lucerna
