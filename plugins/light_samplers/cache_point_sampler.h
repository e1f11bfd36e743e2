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
#include "plugins/light_samplers/memory/cache_points.h"
#include "plugins/light_samplers/memory/point_kdtree.h"

namespace lucerna {

template <typename Lookup>
class CachePointSampler final : public LightSampler {
public:
    explicit CachePointSampler(const Params& params);

    void prepare(const Scene& scene) override;

    /// The shares of the lists and of the tree at a point.
    class Distribution {
    public:
        Distribution(const CachePointSampler& sampler, const Receiver& receiver);

        std::optional<LightChoice> sample(double u) const;
        float pmf(std::uint32_t light) const;

    private:
        float weight_in_lists(std::uint32_t light) const;
        float pmf_in_shares(std::uint32_t light) const;
        std::optional<std::uint32_t> draw_from_lists(double place) const;
        float infinite_pmf(std::uint32_t i) const {
            return infinite_ * static_cast<float>(sampler_->lights_.infinite_power.pmf(i));
        }

        const CachePointSampler* sampler_;
        const CachePoint* point_ = nullptr;  ///< null: no list
        ReceiverRegion at_;
        /// For each list, what a unit of its weight is worth.
        std::array<float, CachePoint::axes + 1> facing_;
        float infinite_;   ///< share of lights at infinity
        float tree_;       ///< share of the tree
        float scale_ = 0;  ///< probability of a unit of weight
        WeightsAt near_;
    };
    Distribution at(const Receiver& receiver) const { return {*this, receiver}; }

    /// Without the lookup.
    std::size_t bytes() const override {
        std::size_t sum = lights_.tree.bytes();
        for (const CachePoint& point : points_) {
            sum += sizeof(point) + point.near.bytes();
            for (const WeightTable& list : point.lists) sum += list.bytes();
        }
        return sum;
    }

private:
    CachePointOptions options_;
    Lookup lookup_;

    SceneLights lights_;
    std::vector<CachePoint> points_;
};

template <typename Lookup>
CachePointSampler<Lookup>::CachePointSampler(const Params& params) : lookup_(params) {
    const auto count = [&](const char* name, int value, int most, const char* doc) {
        return static_cast<std::uint32_t>(
            params.int32(name, value, {.min = 1, .max = static_cast<double>(most)}, doc));
    };
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
    lights_ = SceneLights(scene);
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
CachePointSampler<Lookup>::Distribution::Distribution(const CachePointSampler& sampler,
                                                      const Receiver& receiver)
    : sampler_(&sampler),
      at_(receiver),
      infinite_(sampler.lights_.infinite_share()),
      tree_(sampler.options_.has_tail ? 1 - infinite_ : 0) {
    if (sampler.points_.empty()) return;
    const CachePoint& point = sampler.points_[sampler.lookup_.find(receiver)];
    near_ = WeightsAt(point.near, at_);
    float total = near_.total() + point.infinite;
    for (std::size_t k = 0; k <= CachePoint::axes; ++k) {
        const bool all_around = k == CachePoint::all_around;
        const float along =
            all_around ? 1 : at_.n[static_cast<int>(k / 2)] * (k % 2 == 0 ? 1.0f : -1.0f);
        const bool used = all_around == (at_.two_sided > 0);
        facing_[k] = used ? std::max(along, 0.0f) : 0.0f;
        total += facing_[k] * point.lists[k].total();
    }
    if (!(total > 0)) return;
    point_ = &point;
    tree_ = point.tail;
    scale_ = (1 - point.tail) / total;
    infinite_ = point.infinite * scale_;
}

template <typename Lookup>
float CachePointSampler<Lookup>::Distribution::weight_in_lists(std::uint32_t light) const {
    float weight = near_.weight_of(at_, light).value_or(0.0f);
    for (std::size_t k = 0; k < point_->lists.size(); ++k) {
        if (facing_[k] > 0) weight += facing_[k] * point_->lists[k].weight_of(light);
    }
    return weight;
}

/// Probability of a light that is somewhere, by lists and tree together.
template <typename Lookup>
float CachePointSampler<Lookup>::Distribution::pmf_in_shares(std::uint32_t light) const {
    const float listed = point_ ? scale_ * weight_in_lists(light) : 0.0f;
    return tree_ > 0 ? listed + tree_ * sampler_->lights_.tree.pmf(at_, light) : listed;
}

/// The light at a place in [0, total weight).
template <typename Lookup>
std::optional<std::uint32_t> CachePointSampler<Lookup>::Distribution::draw_from_lists(
    double place) const {
    const auto near = static_cast<double>(near_.total());
    if (place < near) return near_.draw(at_, place).light;
    place -= near;
    const WeightTable* last = nullptr;
    double in_list = 0;
    for (std::size_t k = 0; k < point_->lists.size(); ++k) {
        const auto facing = static_cast<double>(facing_[k]);
        const double total = facing * static_cast<double>(point_->lists[k].total());
        if (!(total > 0)) continue;
        last = &point_->lists[k];
        in_list = place / facing;
        if (place < total) break;
        place -= total;
    }
    if (!last) return {};
    return last->draw(in_list).light;
}

template <typename Lookup>
std::optional<LightChoice> CachePointSampler<Lookup>::Distribution::sample(double u) const {
    const SceneLights& lights = sampler_->lights_;
    if (const auto only = lights.only_light()) return LightChoice{*only, 1};
    const auto infinite = static_cast<double>(infinite_);
    if (u < infinite) {
        const std::uint32_t i = lights.infinite_power.sample(std::min(u / infinite, 1 - 0x1p-53));
        return LightChoice{lights.infinite[i], infinite_pmf(i)};
    }
    const auto tree = static_cast<double>(tree_);
    if (point_ && u < 1 - tree) {
        const auto light = draw_from_lists((u - infinite) / static_cast<double>(scale_));
        if (!light) return {};
        return LightChoice{*light, pmf_in_shares(*light)};
    }
    if (!(tree > 0)) return {};
    const double rest = std::clamp((u - (1 - tree)) / tree, 0.0, 1 - 0x1p-53);
    const auto choice = lights.tree.sample(at_, rest);
    if (!choice) return {};
    return LightChoice{choice->light, pmf_in_shares(choice->light)};
}

template <typename Lookup>
float CachePointSampler<Lookup>::Distribution::pmf(std::uint32_t light) const {
    const SceneLights& lights = sampler_->lights_;
    if (const auto only = lights.only_light()) return light == *only ? 1.0f : 0.0f;
    if (const auto place = lights.place_at_infinity(light)) return infinite_pmf(*place);
    return pmf_in_shares(light);
}

}  // namespace lucerna
