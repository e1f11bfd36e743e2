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
/// Lists hold the strongest lights until they cover a given part of the sum. The share of the light
/// tree is the part of all light, as far as it is known, that the point does not remember.
#pragma once

#include "plugins/light_samplers/learning/light_study.h"
#include "plugins/light_samplers/memory/cache_record.h"
#include "plugins/light_samplers/memory/cell_points.h"
#include "plugins/light_samplers/memory/point_kdtree.h"

namespace lucerna {

enum class PointPlacement { surfaces, boxes };

struct CachePointOptions {
    explicit CachePointOptions(const Params& params);

    PointPlacement placement;
    std::size_t points_per_box;
    std::size_t most_points;
    std::size_t lights;      ///< in a list, at most
    std::size_t candidates;  ///< that a point considers
    std::size_t rays;        ///< shadow rays of a point
    float coverage;          ///< of the irradiance, by a list
    float floor = 0.05f;     ///< of the learnt visibility
    bool has_tail;
    float least_tail;  ///< share of draws of the tree
    PilotPaths pilots;
};

inline CachePointOptions::CachePointOptions(const Params& params) {
    const auto count = [&](const char* name, int value, int most, const char* doc) {
        return static_cast<std::uint32_t>(
            params.int32(name, value, {.min = 1, .max = static_cast<double>(most)}, doc));
    };
    placement = params.choice<PointPlacement>(
        "placement", PointPlacement::surfaces,
        {{"surfaces", PointPlacement::surfaces}, {"boxes", PointPlacement::boxes}},
        "of cache points: where the camera's paths meet surfaces, or uniformly random in the "
        "bounding boxes of shapes");
    points_per_box = count("points_per_box", 4, 1 << 20, "in each box");
    most_points = count("max_points", 4096, 1 << 20, "of the scene");
    lights = count("lights", 1024, 1 << 16, "kept in a list, at most");
    candidates = count("candidates", 1024, 1 << 16, "lights that a cache point considers");
    rays = count("shadow_rays", 512, 1 << 16, "that a cache point learns from");
    coverage = params.real("coverage", 0.97, {.min = 0, .max = 1, .open_min = true},
                           "of the irradiance, at which a list ends");
    pilots = pilot_paths(params, 1 << 17);
    has_tail = params.choice<bool>("tail", true, {{"tree", true}, {"none", false}},
                                   "what chooses the lights that are in no list of a cache point");
    least_tail = params.real("least_tail", 0.1, {.min = 1e-3, .max = 0.9},
                             "share of draws that is left to the light tree at least");
    if (has_tail) return;
    params.warning("tail",
                   "the image will be biased: lights that are in no list of a cache point "
                   "are left out there");
    if (params.has("least_tail")) params.error("least_tail", "there is no tail");
}

struct CachePoint : CacheRecord<7> {
    static constexpr bool is_disjoint = false;
    static constexpr std::size_t axes = 6, all_around = 6;
    static constexpr std::size_t clusters = 7;  ///< no list has any
    static constexpr std::size_t most_near = 64;

    /// The lists are for +x, −x, +y, …; then from all around.
    static std::array<float, axes + 1> factors(const ReceiverRegion& at) {
        std::array<float, axes + 1> result{};
        if (at.two_sided > 0) {
            result[all_around] = 1;
            return result;
        }
        for (std::size_t axis = 0; axis < axes; ++axis) {
            result[axis] = std::max(along_axis(at.n, axis), 0.0f);
        }
        return result;
    }
    static float along_axis(Vector3 v, std::size_t axis) {
        return v[static_cast<int>(axis / 2)] * (axis % 2 == 0 ? 1.0f : -1.0f);
    }
};

/// For each point in the bounding boxes of the shapes, uniformly random, itself: most are in the
/// air, or inside walls.
inline std::vector<std::vector<Receiver>> sites_in_boxes(const Scene& scene,
                                                         const CachePointOptions& options) {
    const std::size_t shapes = scene.shapes().size();
    const std::size_t wanted = shapes * options.points_per_box;
    const std::size_t count = std::min(wanted, options.most_points);
    std::vector<std::vector<Receiver>> sites;
    Rng rng(0x626f786573);
    for (std::size_t i = 0; i < count; ++i) {
        const Bounds3 box = scene.shapes()[i * wanted / count / options.points_per_box]->bounds();
        const float x = rng.next_float(), y = rng.next_float(), z = rng.next_float();
        const Vector3 p = box.min + Vector3(x, y, z) * box.extent();
        const float error = 0x1p-22f * max_component(absolute(p));
        sites.push_back({{.p = p, .error = error, .sides = Sides::both}});
    }
    return sites;
}

/// For each cube whose size grows with the distance to the eye, some points on surfaces where paths
/// from the camera sample lights.
inline std::vector<std::vector<Receiver>> sites_on_surfaces(const Scene& scene,
                                                            const CachePointOptions& options,
                                                            const Workers& workers) {
    const std::vector<Receiver> points =
        pilot_receivers(scene, options.pilots.within(scene), workers);
    const CellPoints cubes =
        make_cells(scene, points, 1.0f / 128, 1, options.most_points, false).points;
    std::vector<std::vector<Receiver>> sites;
    for (std::size_t i = 0; i < cubes.keys.size(); ++i) sites.push_back(cubes.choose(points, i));
    return sites;
}

/// Of some receivers, the place of the one nearest to the middle.
inline Vector3 middle_place(std::span<const Receiver> around) {
    Vector3 middle(0);
    for (const Receiver& at : around) middle += at.p / static_cast<float>(around.size());
    return std::min_element(around.begin(), around.end(),
                            [&](const Receiver& a, const Receiver& b) {
                                return glm::length(a.p - middle) < glm::length(b.p - middle);
                            })
        ->p;
}

/// The strongest lights of a list, until they cover a given part of its sum.
inline WeightTable strongest(std::vector<std::pair<std::uint32_t, float>> list,
                             const CachePointOptions& options) {
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
    return WeightTable(std::move(list));
}

/// What a point remembers of a study of its surroundings.
inline CachePoint make_cache_point(LightStudy& study, const LightTree8& tree,
                                   const InfiniteLights& infinite,
                                   const CachePointOptions& options) {
    Candidates candidates = study.candidates(options.candidates, options.rays);
    candidates.sort_by_value();
    CachePoint point;
    std::vector<WeighedLight> near;
    std::array<std::vector<std::pair<std::uint32_t, float>>, CachePoint::axes + 1> lists;
    const ReceiverRegion& region = study.region();
    float all = candidates.rest * assumed_visibility(candidates.usual, options.floor), kept = 0;
    for (const Candidate& c : candidates.all) {
        const float irradiance = c.weight(options.floor);
        all += irradiance;
        const auto [lanes, i] = tree.lane(c.light);
        const Vector3 to(lanes->cx[i] - region.p.x, lanes->cy[i] - region.p.y,
                         lanes->cz[i] - region.p.z);
        const float size = glm::length(Vector3(lanes->ex[i], lanes->ey[i], lanes->ez[i]));
        const float distance = glm::length(to);
        if (distance - size < 4 * region.slack && near.size() < CachePoint::most_near) {
            const float factor = assumed_visibility(c.visibility(), options.floor);
            near.push_back({c.light, tree.lane(c.light), factor});
            kept += irradiance;
            continue;
        }
        for (std::size_t axis = 0; axis < CachePoint::axes; ++axis) {
            // Light from a large light comes from around the direction to its middle.
            const float along = CachePoint::along_axis(to, axis) + size;
            const float cosine = std::min(along / std::max(distance, size), 1.0f);
            if (cosine > 0) lists[axis].emplace_back(c.light, irradiance * cosine);
        }
        lists[CachePoint::all_around].emplace_back(c.light, irradiance);
    }
    point.near = WeighedLights(near);
    for (std::size_t k = 0; k < lists.size(); ++k) {
        point.lists[k] = strongest(std::move(lists[k]), options);
    }
    const std::size_t rays = std::max(infinite.size(), std::size_t{64});
    point.infinite = infinite_weights(study.infinite(infinite, rays), infinite, options.floor);
    kept += point.lists[CachePoint::all_around].total();
    const float lost = all > 0 ? 1 - kept / all : 0.0f;
    // Lists that are worth little are forgotten, unless there is nothing else.
    if (lost > 0.9f && options.has_tail && infinite.size() == 0) return {};
    point.tail = options.has_tail ? std::clamp(lost, options.least_tail, 0.9f) : 0.0f;
    return point;
}

/// The cache of such points. A lookup is constructed from parameters, `build(points, bounds)` once,
/// and returns the index of a point that is close to a receiver: `find(at)`.
template <typename Lookup>
class CachePoints {
public:
    using Record = CachePoint;

    explicit CachePoints(const Params& params) : lookup_(params), options_(params) {}

    void learn(const Scene& scene, const LightTree8& tree, const InfiniteLights& infinite) {
        points_.clear();
        if (tree.empty()) return;
        const Workers workers(scene.threads());
        const std::vector<std::vector<Receiver>> sites =
            options_.placement == PointPlacement::boxes
                ? sites_in_boxes(scene, options_)
                : sites_on_surfaces(scene, options_, workers);
        if (sites.empty()) return;
        std::vector<Vector3> places;
        for (const std::vector<Receiver>& site : sites) places.push_back(middle_place(site));
        lookup_.build(places, scene.bounds());
        const PointKdTree others(places);
        points_.resize(sites.size());
        workers.run(static_cast<std::int64_t>(points_.size()), [&](std::int64_t index) {
            const auto i = static_cast<std::size_t>(index);
            const std::uint32_t next = others.closest(places[i], static_cast<std::uint32_t>(i));
            // How far from the site the point may be asked.
            const float reach =
                next == PointKdTree::none ? 0.0f : glm::length(places[next] - places[i]);
            LightStudy study(scene, tree, sites[i], reach, true, i);
            points_[i] = make_cache_point(study, tree, infinite, options_);
        });
    }
    const CachePoint* find(const Receiver& at) const {
        return points_.empty() ? nullptr : &points_[lookup_.find(at)];
    }
    /// Without the lookup.
    std::size_t bytes() const {
        std::size_t sum = 0;
        for (const CachePoint& point : points_) sum += point.bytes();
        return sum;
    }

private:
    Lookup lookup_;
    CachePointOptions options_;
    std::vector<CachePoint> points_;
};

}  // namespace lucerna
