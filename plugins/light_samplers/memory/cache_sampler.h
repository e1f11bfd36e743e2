// SPDX-License-Identifier: Apache-2.0
/// The light sampler over any cache: places of the scene that remember which lights reach them.
///
/// At a point x, let r be the record that the cache has for it (cache_record.h): near lights N with
/// the trust w in their visibility and contributions u(x) without shadows (light_lanes.h); lists k
/// of lights, or of clusters of lights, with weights e, whose worth at x is a factor f_k(x); and
/// weights e_l of the lights at infinity. With W the sum of them all and α the share of a light
/// tree,
///
///   P(l | x) = (1 − α) / W (Σ_k f_k e_k,l + [l ∈ N] w_l u_l(x))  + α P_tree(l | x)
///
/// where for a cluster c above l, e_k,l is e_k,c P_tree(l | x, c), and lights at infinity have
/// (1 − α) e_l / W. If the lists of a record are disjoint, a light that it remembers and the tree
/// draws is not used, so that one look-up tells the probability of any remembered light. Where
/// there is no record, or none of its lights can reach x, the tree and the lights at infinity share
/// the draws. Every light that can contribute has a probability, unless α is zero and the record
/// leaves it out.
///
/// A cache is constructed from parameters and has
///
///   Record                              a CacheRecord, with `factors`, `clusters`, `is_disjoint`
///   learn(scene, tree, infinite)        fills it
///   const Record* find(receiver) const  null: nothing is known there
///   bytes()
#pragma once

#include "core/interfaces/light_sampler.h"
#include "plugins/light_samplers/lights/infinite_share.h"
#include "plugins/light_samplers/lights/light_tree8.h"
#include "plugins/light_samplers/memory/cache_record.h"

namespace lucerna {

template <typename Cache>
class CacheSampler final : public LightSampler {
    using Record = typename Cache::Record;

    /// A draw: the light that it chose, or the walk down the tree that is left to do.
    struct Draw {
        std::optional<LightChoice> light{};
        std::optional<LightTree8::Walk> walk{};
        float pmf = 0;                   ///< of the walk
        const Record* others = nullptr;  ///< whose lights are not for the walk to find
    };

public:
    explicit CacheSampler(const Params& params) : cache_(params) {}

    void prepare(const Scene& scene) override {
        tree_ = LightTree8(scene);
        infinite_ = InfiniteLights(scene, tree_.unit());
        only_.reset();
        if (tree_.count() + infinite_.size() == 1) {
            only_ = tree_.empty() ? infinite_.lights.front() : tree_[0].link[0];
        }
        if (!only_) cache_.learn(scene, tree_, infinite_);
    }

    /// The shares of the lists and of the tree at a point.
    class Distribution {
    public:
        Distribution(const CacheSampler& sampler, const Receiver& receiver, const Record* record);

        std::optional<LightChoice> sample(double u) const {
            Draw one = begin(u);
            while (one.walk && sampler_->tree_.step(*one.walk)) {
            }
            return end(one);
        }
        float pmf(std::uint32_t light) const;

        /// `sample` is the first, the walk, and the last.
        Draw begin(double u) const;
        std::optional<LightChoice> end(const Draw& draw) const;

    private:
        Draw begin_in_lists(double place) const;
        std::optional<float> pmf_in_lists(std::uint32_t light) const;
        float finite_pmf(std::uint32_t light) const;
        /// The probability of a light of the tree that one list, or the tree, draws with `pmf`.
        float sum_over_lists(std::uint32_t light, float pmf) const {
            return Record::is_disjoint ? pmf : finite_pmf(light);
        }
        /// Whether the record has learnt what lights at infinity bring.
        bool learnt_infinite() const { return record_ && record_->infinite.size() > 0; }
        float infinite_pmf(std::uint32_t i) const {
            if (learnt_infinite()) return list_ * record_->infinite.weight_of(i);
            return infinite_ * static_cast<float>(sampler_->infinite_.by_irradiance.pmf(i));
        }

        const CacheSampler* sampler_;
        const Record* record_ = nullptr;  ///< null: no list
        ReceiverRegion at_;
        float infinite_;  ///< share of lights at infinity
        float list_ = 0;  ///< for each unit of weight
        float tree_;      ///< share of the tree
        decltype(Record::factors(at_)) factors_;
        WeightsAt near_;
    };
    Distribution at(const Receiver& receiver) const {
        return {*this, receiver, cache_.find(receiver)};
    }
    void at_many(std::span<const Receiver* const> receivers,
                 std::span<LightDistribution* const> out) const;
    void sample_many(std::span<LightDraw> draws) const;

    std::size_t bytes() const override { return tree_.bytes() + cache_.bytes(); }

private:
    Cache cache_;
    LightTree8 tree_;
    InfiniteLights infinite_;
    std::optional<std::uint32_t> only_;  ///< in a scene that has one light
};

template <typename Cache>
CacheSampler<Cache>::Distribution::Distribution(const CacheSampler& sampler,
                                                const Receiver& receiver, const Record* record)
    : sampler_(&sampler),
      at_(receiver),
      infinite_(infinite_share(sampler.infinite_.emitters, !sampler.tree_.empty())),
      tree_(1 - infinite_) {
    if (!record || sampler.only_) return;
    near_ = WeightsAt(record->near, at_);
    factors_ = Record::factors(at_);
    float total = record->infinite.total();
    for (std::size_t k = 0; k < factors_.size(); ++k) {
        total += factors_[k] * record->lists[k].total();
    }
    total += near_.total();
    if (!(total > 0)) {
        if (record->has_all) {  // so that only lights at infinity can reach the point
            tree_ = 0;
            infinite_ = sampler.infinite_.size() > 0 ? 1.0f : 0.0f;
        }
        return;
    }
    record_ = record;
    const float share = learnt_infinite() ? 1.0f : 1 - infinite_;
    tree_ = record->tail * share;
    list_ = (1 - record->tail) * share / total;
    if (learnt_infinite()) infinite_ = record->infinite.total() * list_;
}

/// The draw at a place in [0, total weight of the lists and of near lights).
template <typename Cache>
auto CacheSampler<Cache>::Distribution::begin_in_lists(double place) const -> Draw {
    std::size_t chosen = factors_.size();  // the last list of any weight that begins before it
    double begin = 0, end = 0;
    for (std::size_t k = 0; k < factors_.size(); ++k) {
        const WeightTable& list = record_->lists[k];
        const double weight = static_cast<double>(factors_[k]) * static_cast<double>(list.total());
        if (!(weight > 0)) continue;
        chosen = k;
        begin = end;
        end += weight;
        if (place < end) break;
    }
    if (place >= end && near_.total() > 0) {
        const WeightsAt::Choice near = near_.draw(at_, place - end);
        return {.light = LightChoice{near.light, sum_over_lists(near.light, list_ * near.weight)}};
    }
    if (chosen == factors_.size()) return {};
    const auto factor = static_cast<double>(factors_[chosen]);
    const WeightTable::Choice drawn = record_->lists[chosen].draw((place - begin) / factor);
    const float pmf = list_ * drawn.weight;
    if (chosen == Record::clusters) {
        return {.walk = LightTree8::Walk(at_, drawn.rest, drawn.light), .pmf = pmf};
    }
    return {.light = LightChoice{drawn.light, sum_over_lists(drawn.light, pmf)}};
}

template <typename Cache>
auto CacheSampler<Cache>::Distribution::begin(double u) const -> Draw {
    const LightTree8& all = sampler_->tree_;
    if (sampler_->only_) return {.light = LightChoice{*sampler_->only_, 1}};
    const auto infinite = static_cast<double>(infinite_);
    if (u < infinite) {
        const InfiniteLights& lights = sampler_->infinite_;
        const double rest = std::min(u / infinite, 1 - 0x1p-53);
        const std::uint32_t i =
            learnt_infinite()
                ? record_->infinite.draw(rest * double{record_->infinite.total()}).light
                : lights.by_irradiance.sample(rest);
        return {.light = LightChoice{lights.lights[i], infinite_pmf(i)}};
    }
    const auto tree = static_cast<double>(tree_);
    if (record_ && u < 1 - tree) {
        return begin_in_lists((u - infinite) / static_cast<double>(list_));
    }
    if (all.empty() || !(tree > 0)) return {};
    const double rest = std::clamp((u - (1 - tree)) / tree, 0.0, 1 - 0x1p-53);
    return {.walk = LightTree8::Walk(at_, rest), .pmf = tree_, .others = record_};
}

template <typename Cache>
std::optional<LightChoice> CacheSampler<Cache>::Distribution::end(const Draw& draw) const {
    if (!draw.walk) return draw.light;
    const auto choice = draw.walk->choice();
    if (!choice) return {};
    if constexpr (Record::is_disjoint) {
        if (draw.others && draw.others->holds(choice->light, sampler_->tree_)) return {};
    }
    return LightChoice{choice->light, sum_over_lists(choice->light, draw.pmf * choice->pmf)};
}

/// The probability by the lists of a light of the tree. Nothing if they do not hold it, for
/// disjoint ones.
template <typename Cache>
std::optional<float> CacheSampler<Cache>::Distribution::pmf_in_lists(std::uint32_t light) const {
    const std::optional<float> near = near_.weight_of(at_, light);
    if constexpr (Record::is_disjoint) {
        if (near) return list_ * *near;
        const float far = record_->lists[Record::far].weight_of(light);
        if (far > 0) return list_ * far;
        const LightTree8& tree = sampler_->tree_;
        // The last is zero, too, for a light that the cluster does not hold.
        const auto cluster = record_->lists[Record::clusters].last_up_to(tree.node_of(light));
        const float pmf = cluster ? tree.pmf(at_, light, cluster->light) : 0.0f;
        if (pmf > 0) return list_ * cluster->weight * pmf;
        return {};
    } else {
        float weight = near.value_or(0.0f);
        for (std::size_t k = 0; k < factors_.size(); ++k) {
            if (factors_[k] > 0) weight += factors_[k] * record_->lists[k].weight_of(light);
        }
        return list_ * weight;
    }
}

template <typename Cache>
float CacheSampler<Cache>::Distribution::pmf(std::uint32_t light) const {
    if (sampler_->only_) return light == *sampler_->only_ ? 1.0f : 0.0f;
    if (const auto place = sampler_->infinite_.place_of(light)) return infinite_pmf(*place);
    return sampler_->tree_.holds(light) ? finite_pmf(light) : 0.0f;
}

/// The probability of a light of the tree.
template <typename Cache>
float CacheSampler<Cache>::Distribution::finite_pmf(std::uint32_t light) const {
    const std::optional<float> listed = record_ ? pmf_in_lists(light) : std::nullopt;
    if (tree_ > 0 && !(Record::is_disjoint && listed)) {
        return listed.value_or(0.0f) + tree_ * sampler_->tree_.pmf(at_, light);
    }
    return listed.value_or(0.0f);
}

template <typename Cache>
void CacheSampler<Cache>::at_many(std::span<const Receiver* const> receivers,
                                  std::span<LightDistribution* const> out) const {
    constexpr std::size_t most = 16;  // whose records stay in the first cache
    const Record* records[most];
    for (std::size_t begin = 0; begin < receivers.size(); begin += most) {
        const std::size_t count = std::min(most, receivers.size() - begin);
        for (std::size_t i = 0; i < count; ++i) {
            records[i] = cache_.find(*receivers[begin + i]);
            if (records[i]) records[i]->prefetch();
        }
        for (std::size_t i = 0; i < count; ++i) {
            if (!records[i]) continue;
            records[i]->near.prefetch();
            records[i]->infinite.prefetch();
            if constexpr (Record::is_disjoint) records[i]->lists[Record::clusters].prefetch();
        }
        for (std::size_t i = 0; i < count; ++i) {
            out[begin + i]->set(Distribution(*this, *receivers[begin + i], records[i]));
        }
    }
}

template <typename Cache>
void CacheSampler<Cache>::sample_many(std::span<LightDraw> draws) const {
    constexpr std::size_t most = 16;  // whose nodes stay in the first cache
    for (; draws.size() > most; draws = draws.subspan(most)) sample_many(draws.first(most));
    Draw begun[most];
    LightTree8::Walk* walks[most];
    std::size_t count = 0;
    for (std::size_t i = 0; i < draws.size(); ++i) {
        begun[i] = draws[i].lights->get<Distribution>().begin(draws[i].u);
        if (begun[i].walk) walks[count++] = &*begun[i].walk;
    }
    tree_.finish(std::span(walks, count));
    for (std::size_t i = 0; i < draws.size(); ++i) {
        draws[i].choice = draws[i].lights->get<Distribution>().end(begun[i]);
    }
}

}  // namespace lucerna
