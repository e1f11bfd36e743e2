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
#include "plugins/light_samplers/cell_points.h"
#include "plugins/light_samplers/fine_bits.h"
#include "plugins/light_samplers/light_cells.h"
#include "plugins/light_samplers/pilot_paths.h"

#include <atomic>

namespace lucerna {

namespace {

constexpr std::size_t most_lights = 256;
constexpr std::size_t least_points = 3;  ///< fewer are not worth a cell
/// No more lights than these need no cells: all are weighed at each point.
constexpr std::size_t few_enough = LightLanes::width;

constexpr float least_infinite_rays = 64;  ///< of a cell, to lights at infinity

/// How draws are shared out at a point, as a thread last found it.
struct MixtureWeights {
    std::uint64_t owner = 0;  ///< the sampler
    Receiver at;
    const LightCell* cell = nullptr;  ///< null: no list
    float infinite = 0;
    float list = 0;  ///< for each unit of weight
    float tree = 1;
    alignas(32) float weights[most_lights];  ///< of the lanes of the cell
};

MixtureWeights& thread_weights() {
    thread_local MixtureWeights shares;
    return shares;
}

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
    std::uint32_t draws() const override { return lights_.count() > 0 ? draws_ : 0; }
    std::optional<LightChoice> sample(const Receiver& at, std::uint32_t draw,
                                      float u) const override;
    void sample_many(std::uint32_t draw, std::span<LightQuery> queries) const;
    float pmf(const Receiver& at, std::uint32_t light) const override;
    std::size_t bytes() const override {
        std::size_t sum = lights_.tree.bytes() + lights_.every.bytes() + grid_.bytes();
        for (const LightCell& cell : cells_) {
            sum += cell.bytes();
        }
        return sum;
    }

private:
    void make_cells(const Scene& scene);
    const LightCell* find_cell(const Receiver& at) const;
    const MixtureWeights& shares_at(const Receiver& at) const;
    const MixtureWeights& share_out(const Receiver& at, const LightCell* cell) const;
    const MixtureWeights& share_everywhere(MixtureWeights& shares) const;
    Draw begin(const Receiver& at, const MixtureWeights& shares, std::uint32_t draw, float u) const;
    Draw begin_in_lists(const MixtureWeights& shares, double place) const;
    std::optional<LightChoice> end(const Draw& draw) const;
    /// Whether the cell has learnt what lights at infinity bring.
    static bool learnt_infinite(const MixtureWeights& shares) {
        return shares.cell && shares.cell->infinite.size() > 0;
    }
    float infinite_pmf(const MixtureWeights& shares, std::uint32_t i) const {
        if (learnt_infinite(shares)) return shares.list * shares.cell->infinite.weight_of(i);
        return shares.infinite * static_cast<float>(lights_.infinite_power.pmf(i));
    }

    std::uint32_t draws_;
    CellOptions options_;
    PilotPaths pilots_;
    float cell_size_;
    std::size_t most_cells_;
    std::size_t few_;  ///< lights, of which cells remember all
    float jitter_;

    std::uint64_t id_ = 0;
    SceneLights lights_;
    std::optional<LightChoice> only_;  ///< in a scene that has one light
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
    draws_ = count("light_samples", 1, 1024, "lights chosen at each point");
    options_.lights = count("lights", 64, static_cast<int>(most_lights), "lights kept in a cell");
    few_ = static_cast<std::size_t>(params.int32(
        "remember_all", static_cast<int>(few_lights), {.min = 0, .max = 1 << 16},
        "cells remember every light if there are no more than these, instead of clusters"));
    options_.coverage =
        params.real("coverage", 0.9, unit_interval,
                    "of what the candidates bring, by the lights that are weighed at points");
    options_.candidates =
        count("candidates", 512, 1 << 16,
              "lights of which a cell learns the visibility, if it remembers all lights");
    options_.clusters = count("clusters", 1536, 1 << 16,
                              "of lights, and lights, that a cell remembers if it does not");
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
    static std::atomic<std::uint64_t> count{0};
    id_ = ++count;
    lights_ = SceneLights(scene, std::max(few_, few_enough));
    only_.reset();
    if (const auto light = lights_.only_light()) {
        only_ = LightChoice{*light, static_cast<float>(draws_)};
    }
    cells_.clear();
    grid_ = {};
    everywhere_.reset();
    const bool looks = scene.integrator().light_bounces() >= 0;
    if (!looks || (lights_.finite == 0 && lights_.infinite.size() <= few_enough)) return;
    if (lights_.every.blocks() == 1 && lights_.infinite.size() <= few_enough) {
        everywhere_.emplace();
        everywhere_->near = lights_.every;
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
    std::vector<FarLights> others(cells_.size());
    const bool knows_all = lights_.finite <= few_ && lights_.every.blocks() > 0;
    const std::size_t count = knows_all ? options_.candidates : options_.clusters;
    const auto rays =
        static_cast<std::size_t>(static_cast<float>(count) * options_.rays_per_candidate);
    const auto infinite_rays = static_cast<std::size_t>(
        std::max(least_infinite_rays,
                 static_cast<float>(lights_.infinite.size()) * options_.rays_per_candidate));
    for_each_cell([&](std::size_t i, LightStudy& study) {
        known[i] = study.cut(count, rays);
        if (knows_all) others[i] = unoccluded_weights(study, lights_);
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
        cells_[i] =
            CellBuilder(lights_, options_).build(joined(known, i), joined(infinite, i), others[i]);
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

const MixtureWeights& CacheLightSampler::shares_at(const Receiver& at) const {
    const MixtureWeights& last = thread_weights();
    if (last.owner == id_ && is_same_place(last.at, at)) return last;
    return share_out(at, find_cell(at));
}

const MixtureWeights& CacheLightSampler::share_out(const Receiver& at,
                                                   const LightCell* cell) const {
    MixtureWeights& shares = thread_weights();
    shares.owner = id_;
    shares.at = at;
    shares.cell = nullptr;
    shares.infinite = lights_.infinite_share();
    shares.tree = 1 - shares.infinite;
    if (!cell) return shares;
    cell->near.weigh(ReceiverRegion(at), shares.weights);
    if (everywhere_) return share_everywhere(shares);
    const float total = cell->infinite.total() + cell->far.total() + cell->clusters.total() +
                        cell->near.total(shares.weights);
    if (!(total > 0)) return shares;
    shares.cell = cell;
    shares.tree = cell->tail;
    shares.list = (1 - cell->tail) / total;
    shares.infinite = cell->infinite.total() * shares.list;
    return shares;
}

/// Between the lights at infinity and all others, which have been weighed.
const MixtureWeights& CacheLightSampler::share_everywhere(MixtureWeights& shares) const {
    const float total = everywhere_->near.total(shares.weights);
    if (total > 0) {
        shares.cell = &*everywhere_;
        shares.list = (1 - shares.infinite) / total;
    } else {
        shares.infinite = lights_.infinite.empty() ? 0.0f : 1.0f;
    }
    shares.tree = 0;
    return shares;
}

/// The draw at a place in [0, total weight of the lists).
Draw CacheLightSampler::begin_in_lists(const MixtureWeights& shares, double place) const {
    const LightCell& cell = *shares.cell;
    const float scale = shares.list * static_cast<float>(draws_);
    const auto far = static_cast<double>(cell.far.total());
    const auto clusters = static_cast<double>(cell.clusters.total());
    if (place >= far + clusters) {
        const std::size_t lane = cell.near.draw(shares.weights, place - (far + clusters));
        if (lane < cell.near.lights().size()) {
            return {.light = LightChoice{cell.near.lights()[lane], scale * shares.weights[lane]}};
        }
    }
    if (place >= far && cell.clusters.size() > 0) {
        const FarLights::Choice cluster = cell.clusters.draw(place - far);
        return {.walk = LightTree8::Walk(ReceiverRegion(shares.at), cluster.rest, cluster.light),
                .pmf = scale * cluster.weight};
    }
    if (cell.far.size() == 0) return {};
    const FarLights::Choice far_light = cell.far.draw(place);
    return {.light = LightChoice{far_light.light, scale * far_light.weight}};
}

Draw CacheLightSampler::begin(const Receiver& at, const MixtureWeights& shares, std::uint32_t draw,
                              float u) const {
    const auto scale = static_cast<float>(draws_);
    double place = fine_number(at, draw, draws_, u);
    const auto infinite = static_cast<double>(shares.infinite);
    if (place < infinite) {
        const double rest = std::min(place / infinite, 1 - 0x1p-53);
        const std::uint32_t i =
            learnt_infinite(shares)
                ? shares.cell->infinite.draw(rest * double{shares.cell->infinite.total()}).light
                : lights_.infinite_power.sample(rest);
        return {.light = LightChoice{lights_.infinite[i], scale * infinite_pmf(shares, i)}};
    }
    const auto tree = static_cast<double>(shares.tree);
    if (shares.cell && place < 1 - tree) {
        return begin_in_lists(shares, (place - infinite) / static_cast<double>(shares.list));
    }
    if (lights_.tree.empty() || !(tree > 0)) return {};
    const double rest = std::clamp((place - (1 - tree)) / tree, 0.0, 1 - 0x1p-53);
    return {.walk = LightTree8::Walk(ReceiverRegion(at), rest),
            .pmf = scale * shares.tree,
            .others = shares.cell};
}

std::optional<LightChoice> CacheLightSampler::end(const Draw& draw) const {
    if (!draw.walk) return draw.light;
    const auto choice = draw.walk->choice();
    if (!choice || (draw.others && draw.others->holds(choice->light, lights_.tree))) return {};
    return LightChoice{choice->light, draw.pmf * choice->pmf};
}

std::optional<LightChoice> CacheLightSampler::sample(const Receiver& at, std::uint32_t draw,
                                                     float u) const {
    if (only_) return only_;
    Draw one = begin(at, shares_at(at), draw, u);
    while (one.walk && lights_.tree.step(*one.walk)) {
    }
    return end(one);
}

void CacheLightSampler::sample_many(std::uint32_t draw, std::span<LightQuery> queries) const {
    if (only_) {
        for (LightQuery& query : queries) query.choice = only_;
        return;
    }
    if (everywhere_) {
        for (LightQuery& query : queries) {
            query.choice =
                begin(*query.at, share_out(*query.at, &*everywhere_), draw, query.u).light;
        }
        return;
    }
    constexpr std::size_t most = 16;  // whose nodes stay in the first cache
    for (; queries.size() > most; queries = queries.subspan(most)) {
        sample_many(draw, queries.first(most));
    }
    const LightCell* cells[most];
    for (std::size_t i = 0; i < queries.size(); ++i) {
        cells[i] = find_cell(*queries[i].at);
        if (cells[i]) cells[i]->prefetch(LightCell::Prefetch::addresses);
    }
    for (std::size_t i = 0; i < queries.size(); ++i) {
        if (cells[i]) cells[i]->prefetch(LightCell::Prefetch::data);
    }
    Draw draws[most];
    LightTree8::Walk* walks[most];
    std::size_t count = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const Receiver& at = *queries[i].at;
        draws[i] = begin(at, share_out(at, cells[i]), draw, queries[i].u);
        if (draws[i].walk) walks[count++] = &*draws[i].walk;
    }
    lights_.tree.finish(std::span(walks, count));
    for (std::size_t i = 0; i < queries.size(); ++i) queries[i].choice = end(draws[i]);
}

float CacheLightSampler::pmf(const Receiver& at, std::uint32_t light) const {
    if (only_) return light == only_->light ? only_->pmf : 0.0f;
    const MixtureWeights& shares = shares_at(at);
    const auto scale = static_cast<float>(draws_);
    const auto found = std::lower_bound(lights_.infinite.begin(), lights_.infinite.end(), light);
    if (found != lights_.infinite.end() && *found == light) {
        const auto i = static_cast<std::uint32_t>(found - lights_.infinite.begin());
        return scale * infinite_pmf(shares, i);
    }
    if (shares.cell && lights_.tree.holds(light)) {
        const std::size_t lane = shares.cell->near.find(light);
        if (lane < shares.cell->near.lights().size()) {
            return shares.list * scale * shares.weights[lane];
        }
        const float far = shares.cell->far.weight_of(light);
        if (far > 0) return shares.list * scale * far;
        // This is zero, too, for a light that the cluster does not hold.
        if (const auto cluster = shares.cell->clusters.last_up_to(lights_.tree.node_of(light))) {
            const float pmf = lights_.tree.pmf(ReceiverRegion(at), light, cluster->light);
            if (pmf > 0) return shares.list * scale * cluster->weight * pmf;
        }
    }
    return shares.tree > 0 ? scale * shares.tree * lights_.tree.pmf(ReceiverRegion(at), light)
                           : 0.0f;
}

}  // namespace

const PluginInfo plugin =
    describe<CacheLightSampler>("regions remember which lights reach them, the rest is a tree");

}  // namespace lucerna
