// SPDX-License-Identifier: Apache-2.0
/// Points of the scene that remember which lights matter around them, by the direction from which
/// their light comes (Burley et al. 2018, on Hyperion, describe such cache points).
///
/// Each point keeps lists of lights: one for each of the six axes ±x, ±y, ±z, with the irradiance
/// that a light causes on a face turned that way; one for all directions; and one of lights so near
/// that what they cause changes much around the point, which are weighed anew wherever they are
/// needed. With b_l what light l causes on a surface that faces it, from the direction d_l, and v_l
/// the part of it that shadow rays found to arrive,
///
///   I_a,l = b_l v_l max(0, d_l · e_a)     for an axis a,      I_o,l = b_l v_l
///
/// Lists hold the strongest lights until they cover a given part of the sum.
#pragma once

#include "plugins/light_samplers/learning/pilot_paths.h"
#include "plugins/light_samplers/memory/cell_grid.h"
#include "plugins/light_samplers/memory/kept_lights.h"

#include <array>

namespace lucerna {

enum class PointPlacement { surfaces, boxes };

struct CachePointOptions {
    PointPlacement placement = PointPlacement::surfaces;
    std::size_t points_per_box = 4;
    std::size_t most_points = 4096;
    std::size_t lights = 1024;      ///< in a list, at most
    std::size_t candidates = 1024;  ///< that a point considers
    std::size_t rays = 512;         ///< shadow rays of a point
    float coverage = 0.97f;         ///< of the irradiance, by a list
    float floor = 0.05f;            ///< of the learnt visibility
    bool has_tail = true;
    float least_tail = 0.1f;  ///< share of draws of the tree
    PilotPaths pilots;
};

struct CachePoint {
    static constexpr std::size_t axes = 6, all_around = 6;
    static constexpr std::size_t most_near = 64;

    std::array<WeightTable, axes + 1> lists;  ///< +x, −x, +y, …; then from all around
    WeighedLights near;
    float infinite = 0;  ///< what lights at infinity cause together
    float tail = 1;      ///< share of draws for lights that are in no list
};

/// Where points are, and for which receivers each stands.
struct CachePointSites {
    std::vector<Vector3> positions;
    std::vector<std::vector<Receiver>> receivers;

    void add(std::vector<Receiver> around) {
        Vector3 middle(0);
        for (const Receiver& at : around) middle += at.p / static_cast<float>(around.size());
        const auto nearer = [&](const Receiver& a, const Receiver& b) {
            return glm::length(a.p - middle) < glm::length(b.p - middle);
        };
        positions.push_back(std::min_element(around.begin(), around.end(), nearer)->p);
        receivers.push_back(std::move(around));
    }
};

/// Uniformly random in the bounding boxes of the shapes: most are in the air, or inside walls.
inline CachePointSites sites_in_boxes(const Scene& scene, const CachePointOptions& options) {
    const std::size_t shapes = scene.shapes().size();
    const std::size_t wanted = shapes * options.points_per_box;
    const std::size_t count = std::min(wanted, options.most_points);
    CachePointSites sites;
    Rng rng(0x626f786573);
    for (std::size_t i = 0; i < count; ++i) {
        const Bounds3 box = scene.shapes()[i * wanted / count / options.points_per_box]->bounds();
        const float x = rng.next_float(), y = rng.next_float(), z = rng.next_float();
        const Vector3 p = box.min + Vector3(x, y, z) * box.extent();
        sites.add({{.p = p, .error = 0x1p-22f * max_component(absolute(p)), .sides = Sides::both}});
    }
    return sites;
}

/// On surfaces where paths from the camera sample lights: a point for each cube whose size grows
/// with the distance to the eye.
inline CachePointSites sites_on_surfaces(const Scene& scene, const CachePointOptions& options,
                                         const Workers& workers) {
    const std::vector<Receiver> points =
        pilot_receivers(scene, options.pilots.within(scene), workers);
    CachePointSites sites;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> members(points.size());
    std::size_t cubes = 0;
    float size = 1.0f / 128;
    do {
        const CellGrid grid(eye_of(scene), scene.bounds(), size);
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            members[i] = {grid.cube(points[i].p), i};
        }
        std::sort(members.begin(), members.end());
        cubes = 0;
        for (std::size_t i = 0; i < members.size(); ++i) {
            cubes += i == 0 || members[i].first != members[i - 1].first;
        }
        size *= 1.25f;
    } while (cubes > options.most_points && size < 1e4f);
    constexpr std::size_t most_receivers = 16;
    for (std::size_t i = 0, end = 0; i < members.size(); i = end) {
        while (end < members.size() && members[end].first == members[i].first) ++end;
        const std::size_t used = std::min(end - i, most_receivers);
        std::vector<Receiver> around;
        for (std::size_t k = 0; k < used; ++k) {
            around.push_back(points[members[i + k * (end - i) / used].second]);
        }
        sites.add(std::move(around));
    }
    return sites;
}

/// What a point remembers. `reach` is how far from its receivers it may be asked.
inline CachePoint make_cache_point(const Scene& scene, const SceneLights& lights,
                                   std::span<const Receiver> receivers, float reach,
                                   const CachePointOptions& options, std::uint64_t seed) {
    LightStudy study(scene, lights, receivers, reach, true, seed);
    std::vector<Candidate> candidates = study.candidates(options.candidates, options.rays).all;
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.value() > b.value(); });
    CachePoint point;
    std::vector<Candidate> near;
    std::array<std::vector<std::pair<std::uint32_t, float>>, CachePoint::axes + 1> lists;
    const ReceiverRegion& region = study.region();
    for (const Candidate& c : candidates) {
        const auto [lanes, i] = lights.tree.lane(c.light);
        const Vector3 to(lanes->cx[i] - region.p.x, lanes->cy[i] - region.p.y,
                         lanes->cz[i] - region.p.z);
        const float size = glm::length(Vector3(lanes->ex[i], lanes->ey[i], lanes->ez[i]));
        const float distance = glm::length(to);
        if (distance - size < 4 * region.slack && near.size() < CachePoint::most_near) {
            near.push_back(c);
            continue;
        }
        const float irradiance = c.mean * assumed_visibility(c.visibility(), options.floor);
        for (std::size_t axis = 0; axis < CachePoint::axes; ++axis) {
            const float along = to[static_cast<int>(axis / 2)] * (axis % 2 == 0 ? 1.0f : -1.0f);
            // Light from a large light comes from around the direction to its middle.
            const float cosine = std::min((along + size) / std::max(distance, size), 1.0f);
            if (cosine > 0) lists[axis].emplace_back(c.light, irradiance * cosine);
        }
        lists[CachePoint::all_around].emplace_back(c.light, irradiance);
    }
    point.near = WeighedLights(near, lights.tree, options.floor);
    for (std::size_t k = 0; k < lists.size(); ++k) {
        auto& list = lists[k];
        std::stable_sort(list.begin(), list.end(),
                         [](const auto& a, const auto& b) { return a.second > b.second; });
        double all = 0, sum = 0;
        for (const auto& [light, irradiance] : list) all += static_cast<double>(irradiance);
        std::size_t count = 0;
        while (count < std::min(list.size(), options.lights) &&
               sum < static_cast<double>(options.coverage) * all) {
            sum += static_cast<double>(list[count++].second);
        }
        list.resize(count);
        point.lists[k].assign(std::move(list));
    }
    point.infinite = study.infinite_contribution();
    const KeptLights kept(point.near, point.lists[CachePoint::all_around]);
    point.tail = kept.count() == lights.finite
                     ? options.least_tail
                     : std::max(kept.tail_share(study, lights), options.least_tail);
    // Lists that are worth nothing are forgotten, unless there is nothing else.
    if (point.tail == 1 && options.has_tail && lights.infinite.empty()) return {};
    point.tail = options.has_tail ? std::min(point.tail, 0.9f) : 0.0f;
    return point;
}

}  // namespace lucerna
