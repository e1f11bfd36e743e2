// SPDX-License-Identifier: Apache-2.0
/// cache: regions of the scene remember which lights matter around them.
///
/// Before rendering, paths from the camera find where lights will be sampled. These points fall
/// into cells (cell_grid.h); each cell learns with shadow rays which lights reach it and keeps the
/// K best, with their visibility v, and the share α of draws that the rest is worth
/// (light_cells.h). At a point x in cell c with the list S, contributions u_l(x) without shadows
/// (light_lanes.h), and P_tree of a light tree over all lights,
///
///   P(l | x) = (1 − α) v_l u_l(x) / Σ_S v u    for l in S,      α P_tree(l | x)    else
///
/// A light of S that the tree draws is not used: S is the list's. Where no cell is known, the tree
/// draws alone. Every light that can contribute has a probability, so no shadow ray that missed
/// biases an image. Lights at infinity are an entry of the list. The cell is that of a point up to
/// half a cell beside x, chosen by a hash of x, so that borders of cells do not show.
#include "core/interfaces/light_sampler.h"
#include "plugins/light_samplers/cell_grid.h"
#include "plugins/light_samplers/fine_bits.h"
#include "plugins/light_samplers/light_cells.h"
#include "plugins/light_samplers/pilot_paths.h"

namespace lucerna {

namespace {

constexpr std::size_t most_lights = 256;
constexpr std::size_t least_points = 3;  ///< fewer are not worth a cell

class CacheLightSampler final : public LightSampler {
public:
    explicit CacheLightSampler(const Params& params);

    void prepare(const Scene& scene) override;
    std::uint32_t draws() const override { return tree_.empty() && infinite_.empty() ? 0 : draws_; }
    std::optional<LightChoice> sample(const Receiver& at, std::uint32_t draw,
                                      float u) const override;
    float pmf(const Receiver& at, std::uint32_t light) const override;

private:
    /// How draws are shared out at a point.
    struct Shares {
        const LightCell* cell = nullptr;  ///< null: no list
        float infinite = 0;
        float list = 0;  ///< for each unit of weight
        float tree = 1;
        alignas(32) float weights[most_lights];  ///< of the lights of the cell
    };

    void make_cells(const CellContext& context, const Workers& workers);
    const LightCell* find_cell(const Receiver& at) const;
    void share_out(const Receiver& at, Shares& shares) const;
    std::optional<LightChoice> sample_list(const Shares& shares, double place) const;
    float infinite_pmf(std::uint32_t light) const;

    std::uint32_t draws_;
    CellOptions options_;
    PilotPaths pilots_;
    float cell_size_;
    std::size_t most_cells_;
    bool jitter_;

    LightTree8 tree_;
    std::vector<std::uint32_t> infinite_;
    DiscreteDistribution infinite_power_;
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
    options_.rays = count("shadow_rays", 384, 1 << 16, "shadow rays that a cell learns from");
    options_.candidates = count("candidates", 256, 1 << 16, "lights that a cell considers");
    pilots_.count = count("paths", 1 << 17, 1 << 24, "paths from the camera that find cells");
    pilots_.bounces =
        params.int32("bounces", 2, {.min = 0, .max = 16}, "after which those paths end");
    cell_size_ = params.real("cell_size", 1.0 / 32, {.min = 1e-4, .max = 100},
                             "largest edge of a cell, relative to its distance to the camera");
    most_cells_ =
        count("max_cells", 16384, 1 << 20, "cells grow until they are no more than these");
    jitter_ = params.boolean("jitter", true, "whether points also use the cells beside them");
}

void CacheLightSampler::prepare(const Scene& scene) {
    LightList lights(scene);
    infinite_ = lights.infinite;
    infinite_power_ = DiscreteDistribution(lights.irradiance);
    const std::vector<double> irradiance = lights.irradiance;
    const double unit = lights.unit;
    const std::size_t finite = lights.finite.size();
    tree_ = LightTree8(std::move(lights), scene.lights().size());
    cells_.clear();
    grid_ = {};
    if (finite == 0 || finite + infinite_.size() == 1) return;  // nothing to choose from
    double sum = 0;
    for (const double e : irradiance) sum += e;
    make_cells({scene, tree_, infinite_, infinite_power_, sum, unit, finite, options_}, Workers());
}

void CacheLightSampler::make_cells(const CellContext& context, const Workers& workers) {
    const Scene& scene = context.scene;
    const std::vector<Receiver> points = pilot_receivers(scene, pilots_, workers);
    const CropWindow crop = scene.sensor().film().crop();
    const Vector2 middle = Vector2(crop.offset) + 0.5f * Vector2(crop.size);
    const Vector3 eye = scene.sensor().sample_ray(middle, Vector2(0.5f)).o;

    struct Member {
        std::uint64_t key;
        std::uint32_t point;
        bool operator<(const Member& o) const {
            return key != o.key ? key < o.key : point < o.point;
        }
    };
    std::vector<Member> members(points.size());
    std::vector<std::uint64_t> keys;
    std::vector<std::size_t> starts, ends;
    for (float size = cell_size_;; size *= 2) {
        grid_ = CellGrid(eye, scene.bounds(), size);
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            members[i] = {grid_.key(points[i].p, points[i]), i};
        }
        std::sort(members.begin(), members.end());
        keys.clear();
        starts.clear();
        ends.clear();
        for (std::size_t i = 0, end = 0; i < members.size(); i = end) {
            while (end < members.size() && members[end].key == members[i].key) ++end;
            if (end - i < least_points) continue;
            keys.push_back(members[i].key);
            starts.push_back(i);
            ends.push_back(end);
        }
        if (keys.size() <= most_cells_ || size > 1e4f) break;
    }
    grid_.index(keys);
    cells_.resize(keys.size());
    workers.run(static_cast<std::int64_t>(keys.size()), [&](std::int64_t index) {
        const auto i = static_cast<std::size_t>(index);
        constexpr std::size_t most_points = 16;
        const std::size_t size = ends[i] - starts[i], used = std::min(size, most_points);
        std::vector<Receiver> chosen;
        for (std::size_t k = 0; k < used; ++k) {
            chosen.push_back(points[members[starts[i] + k * size / used].point]);
        }
        const float margin = jitter_ ? 0.5f * grid_.edge(chosen.front().p) : 0.0f;
        cells_[i] = CellBuilder(context, chosen, margin, keys[i]).build();
    });
}

const LightCell* CacheLightSampler::find_cell(const Receiver& at) const {
    if (cells_.empty()) return nullptr;
    std::uint32_t cell = CellGrid::none;
    if (jitter_) {
        const std::uint64_t bits = hash_of(at, 0x6a09e667);
        const Frame frame = Frame::from_normal(at.n);
        const float edge = grid_.edge(at.p);
        const Vector2 u(static_cast<float>(bits >> 40) * 0x1p-24f - 0.5f,
                        static_cast<float>(bits >> 8 & 0xffffff) * 0x1p-24f - 0.5f);
        cell = grid_.find(grid_.key(at.p + edge * (u.x * frame.s + u.y * frame.t), at));
    }
    if (cell == CellGrid::none) cell = grid_.find(grid_.key(at.p, at));
    return cell == CellGrid::none ? nullptr : &cells_[cell];
}

void CacheLightSampler::share_out(const Receiver& at, Shares& shares) const {
    const auto n = static_cast<float>(infinite_.size());
    shares.infinite = n / (n + (tree_.empty() ? 0.0f : 1.0f));
    shares.tree = 1 - shares.infinite;
    const LightCell* const cell = find_cell(at);
    if (!cell) return;
    const LitPoint lit(at);
    float total = cell->infinite;
    for (std::size_t b = 0; b < cell->lanes.size(); ++b) {
        float* const w = shares.weights + LightLanes::width * b;
        contributions(cell->lanes[b], lit, w);
        for (std::size_t k = 0; k < LightLanes::width; ++k) total += w[k];
    }
    if (!(total > 0)) return;
    shares.cell = cell;
    shares.tree = cell->tail;
    shares.list = (1 - cell->tail) / total;
    shares.infinite = cell->infinite * shares.list;
}

float CacheLightSampler::infinite_pmf(std::uint32_t i) const {
    return static_cast<float>(infinite_power_.pmf(i));
}

std::optional<LightChoice> CacheLightSampler::sample_list(const Shares& shares,
                                                          double place) const {
    std::size_t chosen = most_lights;
    double before = 0;
    for (std::size_t i = 0; i < shares.cell->lights.size(); ++i) {
        if (!(shares.weights[i] > 0)) continue;
        if (chosen != most_lights && place < before) break;
        chosen = i;
        before += static_cast<double>(shares.list * shares.weights[i]);
    }
    if (chosen == most_lights) return {};
    return LightChoice{shares.cell->lights[chosen],
                       static_cast<float>(draws_) * (shares.list * shares.weights[chosen])};
}

std::optional<LightChoice> CacheLightSampler::sample(const Receiver& at, std::uint32_t draw,
                                                     float u) const {
    Shares shares;
    share_out(at, shares);
    const auto scale = static_cast<float>(draws_);
    double place = fine_number(at, draw, draws_, u);
    const auto infinite = static_cast<double>(shares.infinite);
    if (place < infinite) {
        const std::uint32_t i = infinite_power_.sample(std::min(place / infinite, 1 - 0x1p-53));
        return LightChoice{infinite_[i], scale * (shares.infinite * infinite_pmf(i))};
    }
    const auto tree = static_cast<double>(shares.tree);
    if (shares.cell && place < 1 - tree) return sample_list(shares, place - infinite);
    const double rest = std::clamp((place - (1 - tree)) / tree, 0.0, 1 - 0x1p-53);
    const auto choice = tree_.sample(LitPoint(at), rest);
    if (!choice) return {};
    if (shares.cell) {
        const std::vector<std::uint32_t>& list = shares.cell->lights;
        if (std::find(list.begin(), list.end(), choice->light) != list.end()) return {};
    }
    return LightChoice{choice->light, scale * (shares.tree * choice->pmf)};
}

float CacheLightSampler::pmf(const Receiver& at, std::uint32_t light) const {
    Shares shares;
    share_out(at, shares);
    const auto scale = static_cast<float>(draws_);
    const auto found = std::lower_bound(infinite_.begin(), infinite_.end(), light);
    if (found != infinite_.end() && *found == light) {
        const auto i = static_cast<std::uint32_t>(found - infinite_.begin());
        return scale * (shares.infinite * infinite_pmf(i));
    }
    if (shares.cell) {
        const std::vector<std::uint32_t>& list = shares.cell->lights;
        const auto kept = std::find(list.begin(), list.end(), light);
        if (kept != list.end()) {
            return scale * (shares.list * shares.weights[kept - list.begin()]);
        }
    }
    return shares.tree > 0 ? scale * (shares.tree * tree_.pmf(LitPoint(at), light)) : 0.0f;
}

}  // namespace

const PluginInfo plugin =
    describe<CacheLightSampler>("regions remember which lights reach them, the rest is a tree");

}  // namespace lucerna
