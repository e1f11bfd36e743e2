// SPDX-License-Identifier: Apache-2.0
/// slc: stochastic lightcuts (Yuksel 2019, 2021): a light below each node of an error-bounded cut.
///
/// With the bounds of power and cosines P = Φ cos θ' |cos θi'| (light_bvh.h), the nearest and the
/// farthest distance of a node, dₙ and d_f, and its contribution C (light_cut.h), the node of the
/// largest bound P / dₙ² is divided, until that is below `error` times Σ C, or the cut has as many
/// nodes as `parts` allows. The sum stands for the estimate of the light that the paper compares
/// with, so that the cut does not depend on chance. Below the cut a walk takes a child with the
/// mean of two probabilities, one in proportion to P / dₙ², the other to P / d_f²; where the point
/// is inside of both children, the first is in proportion to P. Distances are to spheres around the
/// lights, not to boxes.
#include "plugins/light_samplers/cut_light_sampler.h"

namespace lucerna {

namespace {

class StochasticLightcut {
public:
    explicit StochasticLightcut(const Params& params)
        : tolerance_(params.real("error", 0.02, non_negative,
                                 "bound of what a node contributes, relative to all of the cut, "
                                 "from which it is not divided")) {}

    void prepare(const LightBVH&) {}
    std::size_t bytes() const { return 0; }

    float tolerance() const { return tolerance_; }
    CutNode judge(const LightBVH& tree, std::uint32_t node, const Receiver& at) const {
        return {node, contribution(tree, node, at),
                tree[node].leaf ? 0.0f : largest_contribution(tree, node, at)};
    }
    LightBVH::Children children(const LightBVH& tree, std::uint32_t node, const Receiver& at) const;

private:
    float tolerance_;
};

LightBVH::Children StochasticLightcut::children(const LightBVH& tree, std::uint32_t node,
                                                const Receiver& at) const {
    struct Distances {
        float power, nearest, farthest;
    };
    const auto distances = [&](const LightBVH::Node& child) {
        const LightBVH::View seen = tree.view(child, at);
        const float d = std::sqrt(seen.distance2);
        return Distances{seen.power, std::max(d - child.radius, 0.0f), d + child.radius};
    };
    const Distances a = distances(tree[node + 1]), b = distances(tree[tree[node].link]);
    if (!(a.power > 0 && b.power > 0)) {
        return LightBVH::Children::in_proportion(a.power, b.power);
    }
    const auto by = [&](float distance_a, float distance_b) {
        const float larger = std::max(distance_a, distance_b);
        return LightBVH::Children::in_proportion(a.power * sqr(distance_b / larger),
                                                 b.power * sqr(distance_a / larger));
    };
    const bool inside = a.nearest == 0 && b.nearest == 0;
    const LightBVH::Children near = inside ? by(1, 1) : by(a.nearest, b.nearest);
    const LightBVH::Children far = by(a.farthest, b.farthest);
    return {0.5f * (near.first + far.first), 0.5f * (near.second + far.second)};
}

}  // namespace

const PluginInfo plugin = describe<CutLightSampler<StochasticLightcut>>(
    "stochastic lightcuts: a light below each node of an error-bounded cut");

}  // namespace lucerna
