// SPDX-License-Identifier: Apache-2.0
/// hg: scatters forwards or backwards (Henyey and Greenstein 1941).
///
///     f(cos θ) = (1 − g²) / (4π (1 + g² − 2 g cos θ)^1.5)
///
/// θ is the angle by which light turns, and g the mean of its cosine.
#include "plugins/phases/around.h"

namespace lucerna {
namespace {

class HenyeyGreenstein final : public Phase {
public:
    explicit HenyeyGreenstein(const Params& params)
        : g_(params.real("g", 0.8, {.min = -1, .max = 1, .open_min = true, .open_max = true},
                         "mean cosine: > 0 scatters forwards, < 0 backwards")) {}

    PhaseValue evaluate(Vector3, Vector3 wo, Vector3 wi) const override {
        const float f = value(wo, wi);
        return {.f = f, .pdf = f};
    }

    PhaseSample sample(Vector3, Vector3 wo, float, Vector2 u) const override {
        const Vector3 wi = turned(wo, std::clamp(inverse(u.x), -1.0, 1.0), u.y);
        return {.wi = wi, .weight = 1, .pdf = value(wo, wi)};
    }

private:
    /// 1 + g² − 2 g cos θ = (1 − |g|)² + |g| |wo ± wi|²: for |g| near 1 a cosine is too coarse.
    float value(Vector3 wo, Vector3 wi) const {
        const double g = static_cast<double>(g_), h = std::abs(g);
        const Vector3d from_peak = Vector3d(wo) + (g > 0 ? 1.0 : -1.0) * Vector3d(wi);
        const double d = (1 - h) * (1 - h) + h * glm::dot(from_peak, from_peak);
        return static_cast<float>((1 - g * g) / (4 * std::numbers::pi * d * std::sqrt(d)));
    }

    /// The cosine below which the share u of light is scattered.
    double inverse(float u) const {
        const double g = static_cast<double>(g_), x = 2 * static_cast<double>(u) - 1;
        if (std::abs(g) < 1e-3) return x + 1.5 * g * (1 - x * x);
        const double s = (1 - g * g) / (1 + g * x);
        return (1 + g * g - s * s) / (2 * g);
    }

    float g_;
};

}  // namespace

const PluginInfo plugin =
    describe<HenyeyGreenstein>("scatters forwards or backwards, by one number");

}  // namespace lucerna
