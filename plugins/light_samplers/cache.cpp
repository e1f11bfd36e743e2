// SPDX-License-Identifier: Apache-2.0
/// cache: regions of the scene remember which lights matter around them.
///
/// Before rendering, paths from the camera find where lights will be sampled. These points fall
/// into cells (cell_grid.h); each cell learns with shadow rays which lights reach it, and remembers
/// near lights, far lights and clusters of lights, with the trust in their visibility
/// (light_cell.h): cache_sampler.h tells how it draws from them. Where no cell is known, the light
/// tree draws alone. Every light that can contribute has a probability, so no shadow ray that
/// missed biases an image. Lights at infinity, patches of environment maps among them, are a list
/// of their own that holds all of them. The cell is that of a point up to half a cell beside x,
/// chosen by a hash of x, so that borders of cells do not show.
#include "plugins/light_samplers/learning/light_study.h"
#include "plugins/light_samplers/memory/cache_sampler.h"
#include "plugins/light_samplers/memory/cell_points.h"
#include "plugins/light_samplers/memory/jitter.h"
#include "plugins/light_samplers/memory/light_cell.h"

namespace lucerna {

namespace {

constexpr std::size_t least_points = 3;  ///< fewer are not worth a cell
/// No more lights than these need no cells: all are weighed at each point.
constexpr std::size_t few_enough = LightLanes::width;

constexpr float least_infinite_rays = 64;  ///< of a cell, to lights at infinity

class CellCache {
public:
    using Record = LightCell;

    explicit CellCache(const Params& params);

    void learn(const Scene& scene, const LightTree8& tree, const InfiniteLights& infinite);
    const LightCell* find(const Receiver& at) const;

    std::size_t bytes() const {
        std::size_t sum = grid_.bytes();
        for (const LightCell& cell : cells_) sum += cell.bytes();
        return sum;
    }

private:
    void learn_cells(const Scene& scene, const LightTree8& tree, const InfiniteLights& infinite);

    CellOptions options_;
    PilotPaths pilots_;
    float cell_size_;
    std::size_t most_cells_;
    float jitter_;

    /// In a scene with few lights, all of them.
    std::optional<LightCell> everywhere_;
    CellGrid grid_;
    std::vector<LightCell> cells_;
};

CellCache::CellCache(const Params& params) {
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
    pilots_ = pilot_paths(params, 1 << 17);
    cell_size_ = params.real(
        "cell_size", 1.0 / 64, {.min = 1e-4, .max = 100},
        "largest edge of a cell, relative to its distance to the camera; four times that "
        "if there are only lights at infinity");
    most_cells_ = count("max_cells", 8192, 1 << 20, "cells grow until they are no more than these");
    jitter_ = params.real("jitter", 1, unit_interval,
                          "size of the region around a point, in cells, whose cells it uses");
}

void CellCache::learn(const Scene& scene, const LightTree8& tree, const InfiniteLights& infinite) {
    cells_.clear();
    grid_ = {};
    everywhere_.reset();
    const bool looks = scene.integrator().light_bounces() >= 0;
    if (!looks || (tree.empty() && infinite.size() <= few_enough)) return;
    if (tree.count() > few_enough || infinite.size() > few_enough) {
        learn_cells(scene, tree, infinite);
        return;
    }
    std::vector<WeighedLight> all;
    for (std::uint32_t light = 0; light < scene.lights().size(); ++light) {
        if (tree.holds(light)) all.push_back({light, tree.lane(light)});
    }
    everywhere_.emplace();
    everywhere_->near = WeighedLights(all);
    everywhere_->has_all = true;
    everywhere_->tail = 0;
}

void CellCache::learn_cells(const Scene& scene, const LightTree8& tree,
                            const InfiniteLights& infinite) {
    const Workers workers(scene.threads());
    const std::vector<Receiver> points = pilot_receivers(scene, pilots_.within(scene), workers);
    // What is seen of lights at infinity changes less from place to place.
    const float size = tree.empty() ? 4 * cell_size_ : cell_size_;
    Cells made = make_cells(scene, points, size, least_points, most_cells_, true);
    grid_ = std::move(made.grid);
    const CellPoints& cells = made.points;
    cells_.resize(cells.keys.size());
    const auto for_each_cell = [&](const auto& task) {
        workers.run(static_cast<std::int64_t>(cells_.size()),
                    [&](std::int64_t i) { task(static_cast<std::size_t>(i)); });
    };
    std::vector<Candidates> known(cells_.size()), seen(cells_.size());  // seen: at infinity
    const auto infinite_rays = static_cast<std::size_t>(std::max(
        least_infinite_rays, static_cast<float>(infinite.size()) * options_.rays_per_candidate));
    for_each_cell([&](std::size_t i) {
        const std::vector<Receiver> chosen = cells.choose(points, i);
        const float margin = 0.5f * jitter_ * grid_.edge(chosen.front().p);
        LightStudy study(scene, tree, chosen, margin, false, cells.keys[i]);
        known[i] = study.cut(options_.clusters, options_.rays_per_candidate);
        seen[i] = study.infinite(infinite, infinite_rays);
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
    for_each_cell([&](std::size_t i) {
        cells_[i] = make_cell(joined(known, i), joined(seen, i), tree, infinite, options_);
    });
}

const LightCell* CellCache::find(const Receiver& at) const {
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

}  // namespace

const PluginInfo plugin = describe<CacheSampler<CellCache>>(
    "regions remember which lights reach them, the rest is a tree");

}  // namespace lucerna
