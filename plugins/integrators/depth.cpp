// SPDX-License-Identifier: Apache-2.0
/// depth: distance from the camera to the nearest surface, as grey; zero where there is none.
#include "core/scene/scene.h"

namespace lucerna {

namespace {

class DepthIntegrator final : public SamplingIntegrator {
public:
    explicit DepthIntegrator(const Params&) {}

    void sample(const Scene& scene, std::span<CameraSample> samples) const override {
        for (CameraSample& sample : samples) {
            const std::optional<Interaction> at = scene.intersect(sample.ray);
            sample.result.radiance = Color(at ? at->t : 0.0f);
            sample.result.alpha = at ? 1.0f : 0.0f;
        }
    }
};

}  // namespace

const PluginInfo plugin = describe<DepthIntegrator>("distance to the nearest surface");

}  // namespace lucerna
