// SPDX-License-Identifier: Apache-2.0
/// depth: distance from the lens of the camera to the nearest surface, as grey and as the layer
/// "depth", which keeps 32 bits; zero where there is none.
#include "core/render/sampling_integrator.h"
#include "core/scene/scene.h"
#include "plugins/integrators/render_options.h"

namespace lucerna {

namespace {

class DepthIntegrator final : public SamplingIntegrator {
public:
    explicit DepthIntegrator(const Params& params) {
        accept_render_options(params);
        params.no_effect("hide_emitters", "surfaces that emit have a depth as all others");
    }

    std::vector<std::string> layers() const override { return {"depth"}; }

    void sample(const Scene& scene, std::span<CameraSample> samples) const override {
        for (CameraSample& sample : samples) {
            const std::optional<Interaction> at = scene.intersect(sample.ray);
            const float depth = at ? scene.sensor().distance_from_lens(sample.ray) + at->t : 0.0f;
            sample.result.radiance = Color(depth);
            sample.result.layers[0] = depth;
            sample.result.alpha = at ? 1.0f : 0.0f;
        }
    }
};

}  // namespace

const PluginInfo plugin = describe<DepthIntegrator>("distance to the nearest surface");

}  // namespace lucerna
