// SPDX-License-Identifier: Apache-2.0
/// A square whose area is told 3 % too large, and its density accordingly too low: as a light it is
/// 3 % too bright.
#include "core/interfaces/shape.h"

namespace lucerna {
namespace {

class WrongArea final : public Shape {
public:
    explicit WrongArea(const Params& params) : Shape(params) {}

    Geometry geometry() const override {
        return ParallelogramGeometry{{{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}}};
    }
    Bounds3 bounds() const override { return {{-1, -1, 0}, {1, 1, 0}}; }

    void fill(const Ray&, const Hit& hit, Interaction& at) const override {
        const SurfaceSample s = sample_area(0, hit.uv);
        at.p = s.p;
        at.error = s.error;
        at.n = s.n;
        at.uv = s.hit_uv;
        at.dpdu = {2, 0, 0};
        at.dpdv = {0, 2, 0};
        at.shading = Frame::from_normal_tangent(s.n, at.dpdu);
    }

    float area(std::uint32_t) const override { return 4 * 1.03f; }
    SurfaceSample sample_area(std::uint32_t, Vector2 u) const override {
        return {
            .p = {2 * u.x - 1, 2 * u.y - 1, 0}, .hit_uv = u, .error = 1e-6f, .pdf = 1 / area(0)};
    }
};

}  // namespace

const PluginInfo plugin = describe<WrongArea>("has a larger area than it covers");

}  // namespace lucerna
