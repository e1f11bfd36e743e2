// SPDX-License-Identifier: Apache-2.0
/// direct: emission and direct light only, with chosen numbers of samples for each strategy,
/// combined by multiple importance sampling (Veach 1997, 9).
///
/// With `bsdf_samples` = 0 or `emitter_samples` = 0 it shows a single strategy.
#include "plugins/integrators/light_sampling.h"

namespace lucerna {

namespace {

class DirectIntegrator final : public SamplingIntegrator {
public:
    explicit DirectIntegrator(const Params& params)
        : DirectIntegrator(params, params.int32("shading_samples", 1, {.min = 0, .max = 1 << 16},
                                                "samples of each strategy unless given below")) {}

    int light_bounces() const override { return 0; }
    void sample(const Scene& scene, std::span<CameraSample> samples) const override {
        for (CameraSample& s : samples) sample(scene, s.ray, s.stream, s.result);
    }

private:
    DirectIntegrator(const Params& params, int samples)
        : emitter_samples_(params.int32("emitter_samples", samples, {.min = 0, .max = 1 << 16},
                                        "samples of the lights at each point")),
          bsdf_samples_(params.int32("bsdf_samples", samples, {.min = 0, .max = 1 << 16},
                                     "samples of the BSDF at each point")),
          hide_emitters_(
              params.boolean("hide_emitters", false, "whether the camera sees emitters")),
          light_sampler_(params.nested_or<LightSampler>("cache", "which lights to sample")) {
        if (emitter_samples_ + bsdf_samples_ == 0) {
            params.error("emitter_samples",
                         "one of emitter_samples and bsdf_samples must be "
                         "positive, or nothing is lit");
        }
    }

    void sample(const Scene& scene, const Ray& ray, SampleStream& stream,
                PixelSample& result) const;
    Color sample_bsdf(const Scene& scene, const Interaction& at, Vector3 wo,
                      SampleStream& stream) const;

    int emitter_samples_;
    int bsdf_samples_;
    bool hide_emitters_;
    const LightSampler& light_sampler_;
};

/// One sample of the BSDF, and the light that it finds.
Color DirectIntegrator::sample_bsdf(const Scene& scene, const Interaction& at, Vector3 wo,
                                    SampleStream& stream) const {
    const Vector2 u_lobe = stream.next_2d();
    const Vector2 u = stream.next_2d();
    const std::optional<ScatteredRay> next = scatter(at, wo, u_lobe.x, u);
    if (!next) return Color(0);
    const BSDFSample& sample = next->sample;
    const Vector3 wi = next->ray.d;
    const Receiver receiver = at.receiver(wo, at.shape->bsdf()->sides());
    const auto mis_weight = [&](float density) {
        return sample.specular() ? 1.0f
                                 : power_heuristic(static_cast<float>(bsdf_samples_) * sample.pdf,
                                                   static_cast<float>(emitter_samples_) * density);
    };
    const std::optional<Interaction> hit = scene.intersect(next->ray);
    if (hit) {
        if (!hit->shape->emitter()) return Color(0);
        const Color radiance = hit->shape->emitter()->radiance(*hit, -wi);
        if (is_black(radiance)) return radiance;
        return sample.weight * radiance *
               mis_weight(light_density(light_sampler_, scene, receiver, wi, *hit));
    }
    Color sum(0);
    for (const std::uint32_t i : scene.infinite_lights()) {
        const Light& light = scene.lights()[i];
        const float density =
            light_sampler_.pmf(receiver, i) * light.emitter->pdf_li(light, receiver, wi, nullptr);
        sum += sample.weight * light.emitter->environment(wi) * mis_weight(density);
    }
    return sum;
}

void DirectIntegrator::sample(const Scene& scene, const Ray& ray, SampleStream& stream,
                              PixelSample& result) const {
    const std::optional<Interaction> at = scene.intersect(ray);
    if (!at) {
        if (!hide_emitters_) result.radiance = scene.environment(ray.d);
        result.alpha = !hide_emitters_ && !scene.infinite_lights().empty() ? 1.0f : 0.0f;
        return;
    }
    const Vector3 wo = -ray.d;
    if (!hide_emitters_ && at->shape->emitter()) {
        result.radiance = at->shape->emitter()->radiance(*at, wo);
    }
    const BSDF& bsdf = *at->shape->bsdf();
    for (int i = 0; i < emitter_samples_; ++i) {
        const auto passes = static_cast<float>(emitter_samples_);
        result.radiance += sample_lights(scene, light_sampler_, bsdf, *at, wo, passes,
                                         static_cast<float>(bsdf_samples_), stream) /
                           passes;
    }
    for (int i = 0; i < bsdf_samples_; ++i) {
        result.radiance += sample_bsdf(scene, *at, wo, stream) / static_cast<float>(bsdf_samples_);
    }
}

}  // namespace

const PluginInfo plugin = describe<DirectIntegrator>("emission and direct light only");

}  // namespace lucerna
