// SPDX-License-Identifier: Apache-2.0
/// isotropic: scatters equally into all directions.
#include "core/interfaces/phase.h"
#include "core/math/warp.h"

namespace lucerna {
namespace {

class Isotropic final : public Phase {
public:
    explicit Isotropic(const Params&) {}

    PhaseValue evaluate(Vector3, Vector3, Vector3) const override {
        return {.f = inv_pi / 4, .pdf = inv_pi / 4};
    }

    PhaseSample sample(Vector3, Vector3, float, Vector2 u) const override {
        return {.wi = square_to_uniform_sphere(u), .weight = 1, .pdf = inv_pi / 4};
    }
};

}  // namespace

const PluginInfo plugin = describe<Isotropic>("scatters equally into all directions");

}  // namespace lucerna
