// SPDX-License-Identifier: Apache-2.0
/// The light sampler over cache points (cache_points.h), for any way to find the closest one.
///
/// At a point x with normal n, let k be the closest cache point, N its near lights, u_l(x) what
/// they contribute without shadows and v_l what arrives of it. A list is drawn, and then a light of
/// the list, so that all in all
///
///   P(l | x) = (1 − α) (Σ_a max(0, n · e_a) I_a,l + [l ∈ N] v_l u_l(x)) / Σ_l (the same)
///              + α P_tree(l | x)
///
/// with a light tree over all lights. The lists of a point may be far from the truth around a
/// corner; since the tree draws listed lights, too, the second moment is never more than 1 / α
/// times that of the tree alone. α is learnt at k. Surfaces that receive light from both sides
/// use the list of all directions instead of the six. With tail = none, α is 0: what lists leave
/// out is then missing from the image.
///
/// A lookup is constructed from parameters, `build(points, bounds)` once, and returns the index of
/// a point that is close to a receiver: `find(at)`.
#pragma once

#include "core/interfaces/light_sampler.h"
#include "plugins/light_samplers/cache_points.h"
#include "plugins/light_samplers/fine_bits.h"
#include "plugins/light_samplers/point_kdtree.h"
#include "plugins/light_samplers/point_memory.h"

namespace lucerna {

template <typename Lookup>
class CachePointSampler final : public LightSampler {
public:
    explicit CachePointSampler(const Params& params);

    void prepare(const Scene& scene) override;
    std::uint32_t draws() const override { return lights_.count() > 0 ? draws_ : 0; }
    std::optional<LightChoice> sample(const Receiver& at, std::uint32_t draw,
                                      float u) const override;
    float pmf(const Receiver& at, std::uint32_t light) const override;
    /// Without the lookup.
    std::size_t bytes() const override {
        std::size_t sum = lights_.tree.bytes() + lights_.every.bytes();
        for (const CachePoint& point : points_) {
            sum += sizeof(point) + point.near.bytes();
            for (const FarLights& list : point.lists) sum += list.bytes();
        }
        return sum;
    }

private:
    /// How draws are shared out at a point.
    struct MixtureWeights {
        const CachePoint* point = nullptr;  ///< null: no list
        /// For each list, what a unit of its weight is worth.
        std::array<float, CachePoint::axes + 1> facing;
        float infinite = 0;
        float near = 0;   ///< weight of the near lights
        float scale = 0;  ///< probability of a unit of weight
        float tree = 1;
        alignas(32) float weights[2 * CachePoint::most_near];
    };

    const MixtureWeights& shares_at(const Receiver& at) const {
        return memory_.at(at, [this](const Receiver& place, MixtureWeights& shares) {
            share_out(place, shares);
        });
    }
    void share_out(const Receiver& at, MixtureWeights& shares) const;
    float weight_in_lists(const MixtureWeights& shares, std::uint32_t light) const;
    float pmf_in_shares(const MixtureWeights& shares, const Receiver& at,
                        std::uint32_t light) const;
    std::optional<std::uint32_t> draw_from_lists(const MixtureWeights& shares, double place) const;
    float infinite_pmf(std::uint32_t i) const {
        return static_cast<float>(lights_.infinite_power.pmf(i));
    }

    std::uint32_t draws_;
    CachePointOptions options_;
    Lookup lookup_;

    PointMemory<MixtureWeights, 1> memory_;
    SceneLights lights_;
    std::vector<CachePoint> points_;
};

template <typename Lookup>
CachePointSampler<Lookup>::CachePointSampler(const Params& params) : lookup_(params) {
    const auto count = [&](const char* name, int value, int most, const char* doc) {
        return static_cast<std::uint32_t>(
            params.int32(name, value, {.min = 1, .max = static_cast<double>(most)}, doc));
    };
    draws_ = count("light_samples", 1, 1024, "lights chosen at each point");
    options_.placement = params.choice<PointPlacement>(
        "placement", PointPlacement::surfaces,
        {{"surfaces", PointPlacement::surfaces}, {"boxes", PointPlacement::boxes}},
        "of cache points: where the camera's paths meet surfaces, or uniformly random in the "
        "bounding boxes of shapes");
    options_.points_per_box = count("points_per_box", 4, 1 << 20, "in each box");
    options_.most_points = count("max_points", 4096, 1 << 20, "of the scene");
    options_.lights = count("lights", 1024, 1 << 16, "kept in a list, at most");
    options_.candidates = count("candidates", 1024, 1 << 16, "lights that a cache point considers");
    options_.rays = count("shadow_rays", 512, 1 << 16, "that a cache point learns from");
    options_.coverage = params.real("coverage", 0.97, {.min = 0, .max = 1, .open_min = true},
                                    "of the irradiance, at which a list ends");
    options_.pilots.count = count("paths", 1 << 17, 1 << 24,
                                  "most paths from the camera that place points on surfaces");
    options_.pilots.bounces =
        params.int32("bounces", 2, {.min = 0, .max = 16}, "after which those paths end");
    options_.has_tail =
        params.choice<bool>("tail", true, {{"tree", true}, {"none", false}},
                            "what chooses the lights that are in no list of a cache point");
    options_.least_tail = params.real("least_tail", 0.1, {.min = 1e-3, .max = 0.9},
                                      "share of draws that is left to the light tree at least");
    if (options_.has_tail) return;
    params.warning("tail",
                   "the image will be biased: lights that are in no list of a cache point "
                   "are left out there");
    if (params.has("least_tail")) params.error("least_tail", "there is no tail");
}

template <typename Lookup>
void CachePointSampler<Lookup>::prepare(const Scene& scene) {
    memory_.clear();
    lights_ = SceneLights(scene, few_lights);
    points_.clear();
    if (lights_.finite == 0 || lights_.count() == 1) return;  // nothing to choose from
    const Workers workers(scene.threads());
    const CachePointSites sites = options_.placement == PointPlacement::boxes
                                      ? sites_in_boxes(scene, options_)
                                      : sites_on_surfaces(scene, options_, workers);
    if (sites.positions.empty()) return;
    lookup_.build(sites.positions, scene.bounds());
    const PointKdTree tree(sites.positions);
    points_.resize(sites.positions.size());
    workers.run(static_cast<std::int64_t>(points_.size()), [&](std::int64_t index) {
        const auto i = static_cast<std::size_t>(index);
        const Vector3 p = sites.positions[i];
        const std::uint32_t next = tree.closest(p, static_cast<std::uint32_t>(i));
        const float spacing =
            next == PointKdTree::none ? 0.0f : glm::length(sites.positions[next] - p);
        points_[i] = make_cache_point(scene, lights_, sites.receivers[i], spacing, options_, i);
    });
}

template <typename Lookup>
void CachePointSampler<Lookup>::share_out(const Receiver& at, MixtureWeights& shares) const {
    shares.point = nullptr;
    shares.infinite = lights_.infinite_share();
    shares.tree = options_.has_tail ? 1 - shares.infinite : 0;
    if (points_.empty()) return;
    const CachePoint& point = points_[lookup_.find(at)];
    const ReceiverRegion lit(at);
    point.near.weigh(lit, shares.weights);
    shares.near = point.near.total(shares.weights);
    float total = shares.near + point.infinite;
    for (std::size_t k = 0; k <= CachePoint::axes; ++k) {
        const bool all_around = k == CachePoint::all_around;
        const float along =
            all_around ? 1 : lit.n[static_cast<int>(k / 2)] * (k % 2 == 0 ? 1.0f : -1.0f);
        const bool used = all_around == (lit.two_sided > 0);
        shares.facing[k] = used ? std::max(along, 0.0f) : 0.0f;
        total += shares.facing[k] * point.lists[k].total();
    }
    if (!(total > 0)) return;
    shares.point = &point;
    shares.tree = point.tail;
    shares.scale = (1 - point.tail) / total;
    shares.infinite = point.infinite * shares.scale;
}

template <typename Lookup>
float CachePointSampler<Lookup>::weight_in_lists(const MixtureWeights& shares,
                                                 std::uint32_t light) const {
    const CachePoint& point = *shares.point;
    const std::size_t lane = point.near.find(light);
    float weight = lane < point.near.lights().size() ? shares.weights[lane] : 0.0f;
    for (std::size_t k = 0; k < point.lists.size(); ++k) {
        if (shares.facing[k] > 0) weight += shares.facing[k] * point.lists[k].weight_of(light);
    }
    return weight;
}

/// Probability of a light that is somewhere, by lists and tree together.
template <typename Lookup>
float CachePointSampler<Lookup>::pmf_in_shares(const MixtureWeights& shares, const Receiver& at,
                                               std::uint32_t light) const {
    const float listed = shares.point ? shares.scale * weight_in_lists(shares, light) : 0.0f;
    return shares.tree > 0 ? listed + shares.tree * lights_.tree.pmf(ReceiverRegion(at), light)
                           : listed;
}

/// The light at a place in [0, total weight).
template <typename Lookup>
std::optional<std::uint32_t> CachePointSampler<Lookup>::draw_from_lists(
    const MixtureWeights& shares, double place) const {
    const CachePoint& point = *shares.point;
    const auto near = static_cast<double>(shares.near);
    if (place < near) return point.near.lights()[point.near.draw(shares.weights, place)];
    place -= near;
    const FarLights* last = nullptr;
    double in_list = 0;
    for (std::size_t k = 0; k < point.lists.size(); ++k) {
        const auto facing = static_cast<double>(shares.facing[k]);
        const double total = facing * static_cast<double>(point.lists[k].total());
        if (!(total > 0)) continue;
        last = &point.lists[k];
        in_list = place / facing;
        if (place < total) break;
        place -= total;
    }
    if (!last) return {};
    return last->draw(in_list).light;
}

template <typename Lookup>
std::optional<LightChoice> CachePointSampler<Lookup>::sample(const Receiver& at, std::uint32_t draw,
                                                             float u) const {
    if (const auto only = lights_.only_light()) {
        return LightChoice{*only, static_cast<float>(draws_)};
    }
    const MixtureWeights& shares = shares_at(at);
    const auto scale = static_cast<float>(draws_);
    const double place = fine_number(at, draw, draws_, u);
    const auto infinite = static_cast<double>(shares.infinite);
    if (place < infinite) {
        const std::uint32_t i =
            lights_.infinite_power.sample(std::min(place / infinite, 1 - 0x1p-53));
        return LightChoice{lights_.infinite[i], scale * (shares.infinite * infinite_pmf(i))};
    }
    const auto tree = static_cast<double>(shares.tree);
    if (shares.point && place < 1 - tree) {
        const auto light =
            draw_from_lists(shares, (place - infinite) / static_cast<double>(shares.scale));
        if (!light) return {};
        return LightChoice{*light, scale * pmf_in_shares(shares, at, *light)};
    }
    if (!(tree > 0)) return {};
    const double rest = std::clamp((place - (1 - tree)) / tree, 0.0, 1 - 0x1p-53);
    const auto choice = lights_.tree.sample(ReceiverRegion(at), rest);
    if (!choice) return {};
    return LightChoice{choice->light, scale * pmf_in_shares(shares, at, choice->light)};
}

template <typename Lookup>
float CachePointSampler<Lookup>::pmf(const Receiver& at, std::uint32_t light) const {
    const auto scale = static_cast<float>(draws_);
    if (const auto only = lights_.only_light()) return light == *only ? scale : 0.0f;
    const MixtureWeights& shares = shares_at(at);
    const auto found = std::lower_bound(lights_.infinite.begin(), lights_.infinite.end(), light);
    if (found != lights_.infinite.end() && *found == light) {
        const auto i = static_cast<std::uint32_t>(found - lights_.infinite.begin());
        return scale * (shares.infinite * infinite_pmf(i));
    }
    return scale * pmf_in_shares(shares, at, light);
}

}  // namespace lucerna
