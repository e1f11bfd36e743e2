// SPDX-License-Identifier: Apache-2.0
/// A phase function that loses 2 % of the light, and more of what comes from above: media absorb
/// light by their albedo alone.
#include "core/interfaces/phase.h"
#include "core/math/warp.h"

namespace lucerna {
namespace {

class Absorbing final : public Phase {
public:
    explicit Absorbing(const Params&) {}

    PhaseValue evaluate(Vector3, Vector3, Vector3 wi) const override {
        return {.f = scattered(wi) * density, .pdf = density};
    }
    PhaseSample sample(Vector3, Vector3, float, Vector2 u) const override {
        const Vector3 wi = square_to_uniform_sphere(u);
        return {.wi = wi, .weight = scattered(wi), .pdf = density};
    }

private:
    static constexpr float density = inv_pi / 4;
    static float scattered(Vector3 wi) { return 0.98f - 0.01f * wi.z; }
};

}  // namespace

const PluginInfo plugin = describe<Absorbing>("loses 2 % of the light");

}  // namespace lucerna
