// SPDX-License-Identifier: Apache-2.0
/// depth: distance from the camera to the nearest surface, as grey; zero where there is none.
#include "core/scene/scene.h"

namespace lucerna {

namespace {

class DepthIntegrator final : public SamplingIntegrator {
public:
    explicit DepthIntegrator(const Params&) {}

    void sample(const Scene& scene, const Ray& ray, SampleStream&,
                PixelSample& result) const override {
        const std::optional<Interaction> at = scene.intersect(ray);
        result.radiance = Color(at ? at->t : 0.0f);
        result.alpha = at ? 1.0f : 0.0f;
    }
};

}  // namespace

const PluginInfo plugin = describe<DepthIntegrator>("distance to the nearest surface");

}  // namespace lucerna
