// SPDX-License-Identifier: Apache-2.0
/// cache: regions of the scene remember which lights matter around them.
///
/// Before rendering, paths from the camera find where lights will be sampled. These points fall
/// into cells (cell_grid.h); each cell learns with shadow rays which lights reach it, and remembers
/// near lights N, far lights F and clusters C of lights, with the trust w in their visibility
/// (light_cells.h). At a point x of the cell, with contributions u(x) without shadows
/// (light_lanes.h) and their means f over the cell,
///
///   W P(l | x) = (1 − α) w_l u_l(x)                 l in N,     W = Σ_N w u(x) + Σ_F w f + Σ_C w f
///                (1 − α) w_l f_l                    l in F
///                (1 − α) w_c f_c P_tree(l | x, c)   l in a cluster c of C
///                α W P_tree(l | x)                  l anywhere else
///
/// A light that the cell remembers and the tree draws is not used: it is the lists'. Where no cell
/// is known, the tree draws alone. Every light that can contribute has a probability, so no shadow
/// ray that missed biases an image. Lights at infinity, patches of environment maps among them, are
/// a list of their own that holds all of them, weighed like F. The cell is that
/// of a point up to half a cell beside x, chosen by a hash of x, so that borders of cells do not
/// show.
#include "core/interfaces/light_sampler.h"
#include "plugins/light_samplers/learning/pilot_paths.h"
#include "plugins/light_samplers/memory/cell_points.h"
#include "plugins/light_samplers/memory/jitter.h"
#include "plugins/light_samplers/memory/light_cells.h"

namespace lucerna {

namespace {

constexpr std::size_t least_points = 3;  ///< fewer are not worth a cell
/// No more lights than these need no cells: all are weighed at each point.
constexpr std::size_t few_enough = LightLanes::width;

constexpr float least_infinite_rays = 64;  ///< of a cell, to lights at infinity

/// A draw: the light that it chose, or the walk down the tree that is left to do.
struct Draw {
    std::optional<LightChoice> light{};
    std::optional<LightTree8::Walk> walk{};
    float pmf = 0;                      ///< of the walk
    const LightCell* others = nullptr;  ///< whose lights are not for the walk to find
};

class CacheLightSampler final : public LightSampler {
public:
    explicit CacheLightSampler(const Params& params);

    void prepare(const Scene& scene) override;

    /// The shares of the lists and of the tree at a point.
    class Distribution {
    public:
        Distribution(const CacheLightSampler& sampler, const Receiver& receiver,
                     const LightCell* cell);

        std::optional<LightChoice> sample(double u) const {
            Draw one = begin(u);
            while (one.walk && sampler_->lights_.tree.step(*one.walk)) {
            }
            return end(one);
        }
        float pmf(std::uint32_t light) const;

        /// `sample` is the first, the walk, and the last.
        Draw begin(double u) const;
        std::optional<LightChoice> end(const Draw& draw) const;

    private:
        Draw begin_in_lists(double place) const;
        /// Whether the cell has learnt what lights at infinity bring.
        bool learnt_infinite() const { return cell_ && cell_->infinite.size() > 0; }
        float infinite_pmf(std::uint32_t i) const {
            if (learnt_infinite()) return list_ * cell_->infinite.weight_of(i);
            return infinite_ * static_cast<float>(sampler_->lights_.infinite_power.pmf(i));
        }

        const CacheLightSampler* sampler_;
        const LightCell* cell_ = nullptr;  ///< null: no list
        ReceiverRegion at_;
        float infinite_;  ///< share of lights at infinity
        float list_ = 0;  ///< for each unit of weight
        float tree_;      ///< share of the tree
        WeightsAt weights_;
    };
    Distribution at(const Receiver& receiver) const {
        return {*this, receiver, find_cell(receiver)};
    }
    void at_many(std::span<const Receiver* const> receivers,
                 std::span<LightDistribution* const> out) const;
    void sample_many(std::span<LightDraw> draws) const;

    std::size_t bytes() const override {
        std::size_t sum = lights_.tree.bytes() + grid_.bytes();
        for (const LightCell& cell : cells_) {
            sum += cell.bytes();
        }
        return sum;
    }

private:
    void make_cells(const Scene& scene);
    const LightCell* find_cell(const Receiver& at) const;

    CellOptions options_;
    PilotPaths pilots_;
    float cell_size_;
    std::size_t most_cells_;
    float jitter_;

    SceneLights lights_;
    std::optional<std::uint32_t> only_;  ///< in a scene that has one light
    /// In a scene with few lights, all of them.
    std::optional<LightCell> everywhere_;
    CellGrid grid_;
    std::vector<LightCell> cells_;
};

CacheLightSampler::CacheLightSampler(const Params& params) {
    const auto count = [&](const char* name, int value, int most, const char* doc) {
        return static_cast<std::uint32_t>(
            params.int32(name, value, {.min = 1, .max = static_cast<double>(most)}, doc));
    };
    options_.lights =
        count("lights", 64, static_cast<int>(WeightsAt::most_lights), "lights kept in a cell");
    options_.coverage =
        params.real("coverage", 0.9, unit_interval,
                    "of what the candidates bring, by the lights that are weighed at points");
    options_.clusters =
        count("clusters", 1024, 1 << 16, "of lights, and lights, that a cell remembers");
    options_.rays_per_candidate =
        params.real("rays_per_candidate", 1, {.min = 0, .max = 1024},
                    "shadow rays that a cell learns from, for each of those");
    options_.lent_rays = params.real("lent_rays", 4, non_negative,
                                     "shadow rays that what the cells around have learnt of a "
                                     "light counts for");
    options_.tail = params.real("tail_share", 0.01, {.min = 1e-3, .max = 0.9},
                                "share of draws for the lights that a cell does not remember");
    pilots_.count = count("paths", 1 << 17, 1 << 24,
                          "most paths from the camera that find cells; one for two pixels");
    pilots_.bounces =
        params.int32("bounces", 2, {.min = 0, .max = 16}, "after which those paths end");
    cell_size_ = params.real(
        "cell_size", 1.0 / 64, {.min = 1e-4, .max = 100},
        "largest edge of a cell, relative to its distance to the camera; four times that "
        "if there are only lights at infinity");
    most_cells_ = count("max_cells", 8192, 1 << 20, "cells grow until they are no more than these");
    jitter_ = params.real("jitter", 1, unit_interval,
                          "size of the region around a point, in cells, whose cells it uses");
}

void CacheLightSampler::prepare(const Scene& scene) {
    lights_ = SceneLights(scene);
    only_ = lights_.only_light();
    cells_.clear();
    grid_ = {};
    everywhere_.reset();
    const bool looks = scene.integrator().light_bounces() >= 0;
    if (!looks || (lights_.finite == 0 && lights_.infinite.size() <= few_enough)) return;
    if (lights_.finite <= few_enough && lights_.infinite.size() <= few_enough) {
        everywhere_.emplace();
        everywhere_->near = WeighedLights(lights_.tree);
        everywhere_->tail = 0;
    } else {
        make_cells(scene);
    }
}

void CacheLightSampler::make_cells(const Scene& scene) {
    const Workers workers(scene.threads());
    const std::vector<Receiver> points = pilot_receivers(scene, pilots_.within(scene), workers);
    const Vector3 eye = eye_of(scene);

    // What is seen of lights at infinity changes less from place to place.
    float size = lights_.finite > 0 ? cell_size_ : 4 * cell_size_;
    grid_ = CellGrid(eye, scene.bounds(), size);
    CellPoints cells(grid_, points, least_points);
    while (cells.keys.size() > most_cells_ && size < 1e4f) {
        size *= 1.25f;
        grid_ = CellGrid(eye, scene.bounds(), size);
        cells = CellPoints(grid_, points, least_points);
    }
    grid_.index(cells.keys);
    cells_.resize(cells.keys.size());
    const auto for_each_cell = [&](const auto& task) {
        workers.run(static_cast<std::int64_t>(cells_.size()), [&](std::int64_t index) {
            const auto i = static_cast<std::size_t>(index);
            const std::vector<Receiver> chosen = cells.choose(points, i);
            const float margin = 0.5f * jitter_ * grid_.edge(chosen.front().p);
            LightStudy study(scene, lights_, chosen, margin, false, cells.keys[i]);
            task(i, study);
        });
    };
    std::vector<Candidates> known(cells_.size()), infinite(cells_.size());
    const auto infinite_rays = static_cast<std::size_t>(
        std::max(least_infinite_rays,
                 static_cast<float>(lights_.infinite.size()) * options_.rays_per_candidate));
    for_each_cell([&](std::size_t i, LightStudy& study) {
        known[i] = study.cut(options_.clusters, options_.rays_per_candidate);
        infinite[i] = study.infinite(infinite_rays);
        std::sort(known[i].all.begin(), known[i].all.end(),
                  [](const Candidate& a, const Candidate& b) { return a.precedes(b); });
    });
    const auto joined = [&](const std::vector<Candidates>& all, std::size_t i) {
        std::vector<const Candidates*> around;
        for (const std::uint32_t k : grid_.neighbours(cells.keys[i])) around.push_back(&all[k]);
        Candidates mine = all[i];
        if (options_.lent_rays > 0) mine.borrow(around, options_.lent_rays);
        return mine;
    };
    workers.run(static_cast<std::int64_t>(cells_.size()), [&](std::int64_t index) {
        const auto i = static_cast<std::size_t>(index);
        cells_[i] = CellBuilder(lights_, options_).build(joined(known, i), joined(infinite, i));
    });
}

const LightCell* CacheLightSampler::find_cell(const Receiver& at) const {
    if (everywhere_) return &*everywhere_;
    if (cells_.empty()) return nullptr;
    std::uint32_t cell = CellGrid::none;
    if (jitter_ > 0) {
        const Vector3 p = jittered(at, grid_.relative(at.p), jitter_ * grid_.edge(at.p));
        cell = grid_.find(grid_.key(p, at));
    }
    if (cell == CellGrid::none) cell = grid_.find(grid_.key(at.p, at));
    return cell == CellGrid::none ? nullptr : &cells_[cell];
}

CacheLightSampler::Distribution::Distribution(const CacheLightSampler& sampler,
                                              const Receiver& receiver, const LightCell* cell)
    : sampler_(&sampler),
      at_(receiver),
      infinite_(sampler.lights_.infinite_share()),
      tree_(1 - infinite_) {
    if (!cell || sampler.only_) return;
    weights_ = WeightsAt(cell->near, at_);
    const float total =
        cell->infinite.total() + cell->far.total() + cell->clusters.total() + weights_.total();
    if (sampler.everywhere_) {  // lights at infinity, and all others, which have been weighed
        tree_ = 0;
        if (!(total > 0)) infinite_ = sampler.lights_.infinite.empty() ? 0.0f : 1.0f;
    }
    if (!(total > 0)) return;
    cell_ = cell;
    if (sampler.everywhere_) {
        list_ = (1 - infinite_) / total;
        return;
    }
    tree_ = cell->tail;
    list_ = (1 - cell->tail) / total;
    infinite_ = cell->infinite.total() * list_;
}

/// The draw at a place in [0, total weight of the lists).
Draw CacheLightSampler::Distribution::begin_in_lists(double place) const {
    const auto far = static_cast<double>(cell_->far.total());
    const auto clusters = static_cast<double>(cell_->clusters.total());
    if (place >= far + clusters && weights_.total() > 0) {
        const WeightsAt::Choice near = weights_.draw(at_, place - (far + clusters));
        return {.light = LightChoice{near.light, list_ * near.weight}};
    }
    if (place >= far && cell_->clusters.size() > 0) {
        const WeightTable::Choice cluster = cell_->clusters.draw(place - far);
        return {.walk = LightTree8::Walk(at_, cluster.rest, cluster.light),
                .pmf = list_ * cluster.weight};
    }
    if (cell_->far.size() == 0) return {};
    const WeightTable::Choice far_light = cell_->far.draw(place);
    return {.light = LightChoice{far_light.light, list_ * far_light.weight}};
}

Draw CacheLightSampler::Distribution::begin(double u) const {
    const SceneLights& lights = sampler_->lights_;
    if (sampler_->only_) return {.light = LightChoice{*sampler_->only_, 1}};
    const auto infinite = static_cast<double>(infinite_);
    if (u < infinite) {
        const double rest = std::min(u / infinite, 1 - 0x1p-53);
        const std::uint32_t i =
            learnt_infinite() ? cell_->infinite.draw(rest * double{cell_->infinite.total()}).light
                              : lights.infinite_power.sample(rest);
        return {.light = LightChoice{lights.infinite[i], infinite_pmf(i)}};
    }
    const auto tree = static_cast<double>(tree_);
    if (cell_ && u < 1 - tree) {
        return begin_in_lists((u - infinite) / static_cast<double>(list_));
    }
    if (lights.tree.empty() || !(tree > 0)) return {};
    const double rest = std::clamp((u - (1 - tree)) / tree, 0.0, 1 - 0x1p-53);
    return {.walk = LightTree8::Walk(at_, rest), .pmf = tree_, .others = cell_};
}

std::optional<LightChoice> CacheLightSampler::Distribution::end(const Draw& draw) const {
    if (!draw.walk) return draw.light;
    const auto choice = draw.walk->choice();
    if (!choice || (draw.others && draw.others->holds(choice->light, sampler_->lights_.tree))) {
        return {};
    }
    return LightChoice{choice->light, draw.pmf * choice->pmf};
}

float CacheLightSampler::Distribution::pmf(std::uint32_t light) const {
    const SceneLights& lights = sampler_->lights_;
    if (sampler_->only_) return light == *sampler_->only_ ? 1.0f : 0.0f;
    if (const auto place = lights.place_at_infinity(light)) return infinite_pmf(*place);
    if (cell_ && lights.tree.holds(light)) {
        if (const auto near = weights_.weight_of(at_, light)) return list_ * *near;
        const float far = cell_->far.weight_of(light);
        if (far > 0) return list_ * far;
        // This is zero, too, for a light that the cluster does not hold.
        if (const auto cluster = cell_->clusters.last_up_to(lights.tree.node_of(light))) {
            const float pmf = lights.tree.pmf(at_, light, cluster->light);
            if (pmf > 0) return list_ * cluster->weight * pmf;
        }
    }
    return tree_ > 0 ? tree_ * lights.tree.pmf(at_, light) : 0.0f;
}

void CacheLightSampler::at_many(std::span<const Receiver* const> receivers,
                                std::span<LightDistribution* const> out) const {
    constexpr std::size_t most = 16;  // whose cells stay in the first cache
    const LightCell* cells[most];
    for (std::size_t begin = 0; begin < receivers.size(); begin += most) {
        const std::size_t count = std::min(most, receivers.size() - begin);
        for (std::size_t i = 0; i < count; ++i) {
            cells[i] = find_cell(*receivers[begin + i]);
            if (cells[i] && !everywhere_) cells[i]->prefetch(LightCell::Prefetch::addresses);
        }
        for (std::size_t i = 0; i < count; ++i) {
            if (cells[i] && !everywhere_) cells[i]->prefetch(LightCell::Prefetch::data);
        }
        for (std::size_t i = 0; i < count; ++i) {
            out[begin + i]->set(Distribution(*this, *receivers[begin + i], cells[i]));
        }
    }
}

void CacheLightSampler::sample_many(std::span<LightDraw> draws) const {
    constexpr std::size_t most = 16;  // whose nodes stay in the first cache
    for (; draws.size() > most; draws = draws.subspan(most)) sample_many(draws.first(most));
    Draw begun[most];
    LightTree8::Walk* walks[most];
    std::size_t count = 0;
    for (std::size_t i = 0; i < draws.size(); ++i) {
        begun[i] = draws[i].lights->get<Distribution>().begin(draws[i].u);
        if (begun[i].walk) walks[count++] = &*begun[i].walk;
    }
    lights_.tree.finish(std::span(walks, count));
    for (std::size_t i = 0; i < draws.size(); ++i) {
        draws[i].choice = draws[i].lights->get<Distribution>().end(begun[i]);
    }
}

}  // namespace

const PluginInfo plugin =
    describe<CacheLightSampler>("regions remember which lights reach them, the rest is a tree");

}  // namespace lucerna
