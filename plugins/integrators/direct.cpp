// SPDX-License-Identifier: Apache-2.0
/// direct: emission and direct light only, with chosen numbers of samples for each strategy,
/// combined by multiple importance sampling (Veach 1997, 9).
///
/// With `bsdf_samples` = 0 or `emitter_samples` = 0 it shows a single strategy.
#include "core/render/sampling_integrator.h"
#include "plugins/integrators/light_sampling.h"
#include "plugins/integrators/render_options.h"

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
        : emitter_samples_(params.int32("emitter_samples", samples,
                                        {.min = 0, .max = most_light_samples},
                                        "samples of the lights at each point")),
          bsdf_samples_(params.int32("bsdf_samples", samples, {.min = 0, .max = 1 << 16},
                                     "samples of the BSDF at each point")),
          hide_emitters_(
              params.boolean("hide_emitters", false, "the camera looks through emitters")),
          light_sampler_(params.nested_or<LightSampler>("cache", "which lights to sample")) {
        accept_render_options(params);
        if (emitter_samples_ + bsdf_samples_ == 0) {
            params.error("emitter_samples",
                         "one of emitter_samples and bsdf_samples must be "
                         "positive, or nothing is lit");
        }
    }

    void sample(const Scene& scene, const Ray& ray, SampleStream& stream,
                PixelSample& result) const;
    Color sample_bsdf(const Scene& scene, const LightDistribution& lights, const Interaction& at,
                      Vector3 wo, SampleStream& stream) const;
    Color radiance_from(const Scene& scene, const Interaction& at, Vector3 wo,
                        SampleStream& stream) const;

    int emitter_samples_;
    int bsdf_samples_;
    bool hide_emitters_;
    const LightSampler& light_sampler_;
};

/// One sample of the BSDF, and the light that it finds. What goes straight through the surface is
/// left to the camera ray.
Color DirectIntegrator::sample_bsdf(const Scene& scene, const LightDistribution& lights,
                                    const Interaction& at, Vector3 wo, SampleStream& stream) const {
    const Vector2 u_lobe = stream.next_2d();
    const Vector2 u = stream.next_2d();
    const std::optional<ScatteredRay> next = scatter(at, wo, u_lobe.x, u);
    if (!next || next->sample.lobe == Lobe::null) return Color(0);
    const BSDFSample& sample = next->sample;
    const Vector3 wi = next->ray.d;
    const Receiver receiver = at.receiver(wo, at.shape->bsdf()->sides());
    const auto mis_weight = [&](float density) {
        return sample.specular() ? 1.0f
                                 : power_heuristic(static_cast<float>(bsdf_samples_) * sample.pdf,
                                                   static_cast<float>(emitter_samples_) * density);
    };
    Color sum(0), beta = sample.weight;
    std::optional<Interaction> hit = scene.intersect(next->ray);
    for (; hit && !is_black(beta); hit = scene.intersect(hit->spawn_ray(wi))) {
        const Emitter* const emitter = hit->shape->emitter();
        const Color radiance = emitter ? emitter->radiance(*hit, -wi) : Color(0);
        if (!is_black(radiance)) {
            sum += beta * radiance * mis_weight(light_density(lights, scene, receiver, wi, *hit));
        }
        beta *= straight_transmittance(*hit, -wi);
    }
    if (hit || is_black(beta)) return sum;
    for (const std::uint32_t first : scene.infinite_lights()) {
        const std::uint32_t i = scene.light_along(first, wi);
        const Light& light = scene.lights()[i];
        const float density = lights.pmf(i) * light.emitter->pdf_li(light, receiver, wi, nullptr);
        sum += beta * light.emitter->environment(wi) * mis_weight(density);
    }
    return sum;
}

/// Emission of a surface, and light that it scatters, by both strategies.
Color DirectIntegrator::radiance_from(const Scene& scene, const Interaction& at, Vector3 wo,
                                      SampleStream& stream) const {
    const auto bsdf_samples = static_cast<float>(bsdf_samples_);
    LightDistribution lights;
    Color sum(0);
    if (!hide_emitters_ && at.shape->emitter()) sum = at.shape->emitter()->radiance(at, wo);
    if (emitter_samples_ > 0) {
        sum += sample_lights(scene, light_sampler_, *at.shape->bsdf(), at, wo,
                             static_cast<std::uint32_t>(emitter_samples_), bsdf_samples, stream,
                             lights);
    }
    for (int i = 0; i < bsdf_samples_; ++i) {
        sum += sample_bsdf(scene, lights, at, wo, stream) / bsdf_samples;
    }
    return sum;
}

/// All surfaces that the camera sees, one through the other.
void DirectIntegrator::sample(const Scene& scene, const Ray& ray, SampleStream& stream,
                              PixelSample& result) const {
    Color beta(1);
    std::optional<Interaction> at = scene.intersect(ray);
    for (; at && !is_black(beta); at = scene.intersect(at->spawn_ray(ray.d))) {
        if (hide_emitters_ && at->shape->emitter()) continue;
        result.radiance += beta * radiance_from(scene, *at, -ray.d, stream);
        beta *= straight_transmittance(*at, -ray.d);
    }
    if (at || is_black(beta)) return;
    if (!hide_emitters_) result.radiance += beta * scene.environment(ray.d);
    const bool sky = !hide_emitters_ && !scene.infinite_lights().empty();
    result.alpha = sky ? 1.0f : 1 - luminance(beta);
}

}  // namespace

const PluginInfo plugin = describe<DirectIntegrator>("emission and direct light only");

}  // namespace lucerna
