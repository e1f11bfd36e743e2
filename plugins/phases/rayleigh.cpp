// SPDX-License-Identifier: Apache-2.0
/// rayleigh: scattering by particles much smaller than the wavelength, such as air.
///
///     f(cos θ) = 3 / (16π) (1 + cos² θ)
///
/// The cumulative distribution is inverted by Cardano's formula (Frisvad 2011).
#include "plugins/phases/around.h"

namespace lucerna {
namespace {

class Rayleigh final : public Phase {
public:
    explicit Rayleigh(const Params&) {}

    PhaseValue evaluate(Vector3, Vector3 wo, Vector3 wi) const override {
        const float f = value(scattering_cosine(wo, wi));
        return {.f = f, .pdf = f};
    }

    PhaseSample sample(Vector3, Vector3 wo, float, Vector2 u) const override {
        const float z = 2 * (2 * u.x - 1);
        const float root = std::cbrt(std::abs(z) + std::sqrt(z * z + 1));
        const float cosine = std::copysign(std::min(root - 1 / root, 1.0f), z);
        return {
            .wi = turned(wo, static_cast<double>(cosine), u.y), .weight = 1, .pdf = value(cosine)};
    }

private:
    static float value(float cosine) { return 3 * inv_pi / 16 * (1 + cosine * cosine); }
};

}  // namespace

const PluginInfo plugin = describe<Rayleigh>("scattering by molecules, as in air");

}  // namespace lucerna
