// SPDX-License-Identifier: Apache-2.0
/// lanczos: the sinc filter, which keeps all detail that pixels can hold, windowed by its own
/// central lobe (Lanczos 1956; Duchon 1979). Sharp; rings at edges of high contrast.
///
///   f(x) = sinc(x) sinc(x / lobes) for |x| < lobes,   sinc(x) = sin(πx) / πx
#include "core/interfaces/rfilter.h"
#include "core/math/vector.h"

namespace lucerna {

namespace {

float sinc(float x) {
    const float t = pi * x;
    return std::abs(t) < 1e-3f ? 1 - t * t / 6 : std::sin(t) / t;
}

class LanczosFilter final : public RFilter {
public:
    explicit LanczosFilter(const Params& params)
        : radius_(static_cast<float>(
              params.int32("lobes", 3, {.min = 1, .max = 64}, "lobes on either side"))) {}

    float radius() const override { return radius_; }
    float evaluate(float x) const override {
        return std::abs(x) < radius_ ? sinc(x) * sinc(x / radius_) : 0.0f;
    }

private:
    float radius_;
};

}  // namespace

const PluginInfo plugin = describe<LanczosFilter>("the windowed sinc filter");

}  // namespace lucerna
