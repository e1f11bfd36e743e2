// SPDX-License-Identifier: Apache-2.0
/// cache_kdtree: cache points, the closest found in a k-d tree.
#include "plugins/light_samplers/memory/cache_points.h"
#include "plugins/light_samplers/memory/cache_sampler.h"

namespace lucerna {

namespace {

class KdTreeLookup {
public:
    explicit KdTreeLookup(const Params&) {}

    void build(const std::vector<Vector3>& points, const Bounds3&) { tree_ = PointKdTree(points); }
    std::uint32_t find(const Receiver& at) const { return tree_.closest(at.p); }

private:
    PointKdTree tree_;
};

}  // namespace

const PluginInfo plugin = describe<CacheSampler<CachePoints<KdTreeLookup>>>(
    "cache points remember lights; the closest is found in a k-d tree");

}  // namespace lucerna
