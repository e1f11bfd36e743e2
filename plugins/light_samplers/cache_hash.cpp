// SPDX-License-Identifier: Apache-2.0
/// cache_hash: cache points, found by spatial hash: constant time, and not always the closest.
///
/// Cubes of halving size are hashed. A point x looks into the smallest cube around it that holds a
/// cache point, and takes the closest one of that cube alone: without jitter, pictures show the
/// borders of the cubes as squares of different noise. With it, x is moved by up to half a cube
/// along the surface, as a hash of x says, before it looks.
#include "plugins/light_samplers/cache_point_sampler.h"
#include "plugins/light_samplers/memory/jitter.h"

#include <unordered_map>

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

    struct Slot {
        std::uint64_t key = 0;  ///< zero: empty
        std::uint32_t begin = 0, count = 0;
    };
    struct Place {
        const Slot* slot;
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
    const Slot* slot(std::uint64_t key) const {
        for (std::size_t i = mix64(key) & (slots_.size() - 1);; i = (i + 1) & (slots_.size() - 1)) {
            if (slots_[i].key == key) return &slots_[i];
            if (slots_[i].key == 0) return nullptr;
        }
    }
    Place smallest(Vector3 p) const {
        int level = levels_ - 1;
        const Slot* found = slot(key(p, level));
        while (!found && level > 0) found = slot(key(p, --level));
        return {found, std::ldexp(size_, -level)};
    }

    float jitter_;
    Vector3 corner_{0};
    float size_ = 1;
    int levels_ = 1;
    std::vector<Slot> slots_;
    std::vector<std::uint32_t> members_;
    std::vector<Vector3> points_;
};

void HashLookup::build(const std::vector<Vector3>& points, const Bounds3& bounds) {
    points_ = points;
    corner_ = bounds.min;
    size_ = std::max(max_component(bounds.extent()), 1e-20f);
    // Until most points are alone in their cubes.
    using Cubes = std::unordered_map<std::uint64_t, std::vector<std::uint32_t>>;
    Cubes all;
    members_.clear();
    for (levels_ = 0; levels_ <= finest;) {
        Cubes cubes;
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            cubes[key(points[i], levels_)].push_back(i);
        }
        const bool enough = 10 * cubes.size() >= 9 * points.size();
        all.merge(cubes);
        ++levels_;
        if (enough) break;
    }
    slots_.assign(std::bit_ceil(2 * all.size() + 1), {});
    for (auto& [key, cube] : all) {
        std::size_t i = mix64(key) & (slots_.size() - 1);
        while (slots_[i].key != 0) i = (i + 1) & (slots_.size() - 1);
        // From those in a large cube, some that are far from each other in the order of placement.
        const std::size_t count = std::min(cube.size(), most_points);
        slots_[i] = {key, static_cast<std::uint32_t>(members_.size()),
                     static_cast<std::uint32_t>(count)};
        for (std::size_t k = 0; k < count; ++k) members_.push_back(cube[k * cube.size() / count]);
    }
}

std::uint32_t HashLookup::find(const Receiver& at) const {
    Place place = smallest(at.p);
    if (jitter_ > 0) {
        place = smallest(jittered(at, (at.p - corner_) / size_, jitter_ * place.edge));
    }
    std::uint32_t closest = 0;
    float least = infinity;
    for (std::uint32_t i = 0; i < place.slot->count; ++i) {
        const std::uint32_t member = members_[place.slot->begin + i];
        const Vector3 d = points_[member] - at.p;
        const float distance2 = glm::dot(d, d);
        if (!(distance2 < least)) continue;
        least = distance2;
        closest = member;
    }
    return closest;
}

}  // namespace

const PluginInfo plugin = describe<CachePointSampler<HashLookup>>(
    "cache points remember lights; one that is close is found by hash");

}  // namespace lucerna
