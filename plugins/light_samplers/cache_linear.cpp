// SPDX-License-Identifier: Apache-2.0
/// cache_linear: cache points, the closest found by looking at all of them: the first idea, kept
/// for comparison.
#include "plugins/light_samplers/memory/cache_points.h"
#include "plugins/light_samplers/memory/cache_sampler.h"

namespace lucerna {

namespace {

class LinearLookup {
public:
    explicit LinearLookup(const Params&) {}

    void build(const std::vector<Vector3>& points, const Bounds3&) { points_ = points; }
    std::uint32_t find(const Receiver& at) const {
        std::uint32_t closest = 0;
        float least = infinity;
        for (std::uint32_t i = 0; i < points_.size(); ++i) {
            const Vector3 d = points_[i] - at.p;
            const float distance2 = glm::dot(d, d);
            if (!(distance2 < least)) continue;
            least = distance2;
            closest = i;
        }
        return closest;
    }

private:
    std::vector<Vector3> points_;
};

}  // namespace

const PluginInfo plugin = describe<CacheSampler<CachePoints<LinearLookup>>>(
    "cache points remember lights; the closest is found by looking at all");

}  // namespace lucerna
