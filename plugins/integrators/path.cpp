// SPDX-License-Identifier: Apache-2.0
/// path: unidirectional path tracing (Kajiya 1986) with next event estimation, multiple importance
/// sampling (Veach 1997, 9) and Russian roulette.
///
/// Finds all light but what reaches the eye only through a specular surface from a delta light,
/// and finds caustics of small lights slowly: that is what photon mapping is for.
#include "plugins/integrators/light_sampling.h"

#include <limits>

namespace lucerna {

namespace {

class PathIntegrator final : public SamplingIntegrator {
public:
    explicit PathIntegrator(const Params& params)
        : max_depth_(params.int32("max_depth", -1, {.min = -1},
                                  "longest path in edges: 1 shows only emitters, 2 direct light; "
                                  "-1 is unlimited")),
          rr_depth_(params.int32("rr_depth", 5, {.min = 1},
                                 "edges before Russian roulette may end a path")),
          hide_emitters_(
              params.boolean("hide_emitters", false, "whether the camera sees emitters")),
          light_sampler_(params.nested_or<LightSampler>("cache", "which lights to sample")) {}

    void prepare(const Scene&) override {
        dimensions_ = bsdf_dimensions + light_dimensions(light_sampler_);
    }

    int light_bounces() const override {
        return max_depth_ < 0 ? std::numeric_limits<int>::max() : std::max(max_depth_ - 2, -1);
    }
    void sample(const Scene& scene, const Ray& camera_ray, SampleStream& stream,
                PixelSample& result) const override;

private:
    /// The last vertex, as far as emission found by chance depends on it.
    struct Vertex {
        Receiver receiver;
        float pdf = 0;
        bool specular = true;  ///< light sampling could not have found the next vertex
    };
    static constexpr std::uint32_t camera_dimensions = 4;
    // Of a bounce: lobe, direction, light samples, roulette.
    static constexpr std::uint32_t bsdf_dimensions = 4;

    Color environment(const Scene& scene, const Vertex& before, Vector3 d) const;
    Color emission(const Scene& scene, const Vertex& before, const Interaction& at,
                   Vector3 wo) const;

    int max_depth_;
    int rr_depth_;
    bool hide_emitters_;
    const LightSampler& light_sampler_;
    std::uint32_t dimensions_ = 0;
};

/// Light from infinity, weighted against having been sampled at the vertex before.
Color PathIntegrator::environment(const Scene& scene, const Vertex& before, Vector3 d) const {
    Color sum(0);
    for (const std::uint32_t i : scene.infinite_lights()) {
        const Light& light = scene.lights()[i];
        const Color radiance = light.emitter->environment(d);
        if (is_black(radiance)) continue;
        float weight = 1;
        if (!before.specular) {
            const float density = light_sampler_.pmf(before.receiver, i) *
                                  light.emitter->pdf_li(light, before.receiver, d, nullptr);
            weight = power_heuristic(before.pdf, density);
        }
        sum += weight * radiance;
    }
    return sum;
}

/// Light that a surface emits, weighted against having been sampled at the vertex before.
Color PathIntegrator::emission(const Scene& scene, const Vertex& before, const Interaction& at,
                               Vector3 wo) const {
    if (!at.shape->emitter()) return Color(0);
    const Color radiance = at.shape->emitter()->radiance(at, wo);
    if (is_black(radiance) || before.specular) return radiance;
    return radiance * power_heuristic(before.pdf, light_density(light_sampler_, scene,
                                                                before.receiver, -wo, at));
}

void PathIntegrator::sample(const Scene& scene, const Ray& camera_ray, SampleStream& stream,
                            PixelSample& result) const {
    Ray ray = camera_ray;
    Vertex vertex;
    Color beta(1);
    float eta2 = 1;  // undoes the scaling of radiance by refraction, for Russian roulette
    const int max_depth = max_depth_ < 0 ? std::numeric_limits<int>::max() : max_depth_;

    for (int depth = 0; depth < max_depth; ++depth) {
        const bool show = depth > 0 || !hide_emitters_;
        const std::optional<Interaction> hit = scene.intersect(ray);
        if (!hit) {
            if (show) result.radiance += beta * environment(scene, vertex, ray.d);
            if (depth == 0) result.alpha = show && !scene.infinite_lights().empty() ? 1.0f : 0.0f;
            return;
        }
        const Interaction& at = *hit;
        const Vector3 wo = -ray.d;
        if (show) result.radiance += beta * emission(scene, vertex, at, wo);
        if (depth + 1 >= max_depth) return;

        // Light sampled directly
        const std::uint32_t dimension =
            camera_dimensions + static_cast<std::uint32_t>(depth) * dimensions_;
        stream.jump_to(dimension);
        const float u_lobe = stream.next_1d();
        const Vector2 u_direction = stream.next_2d();
        const BSDF& bsdf = *at.shape->bsdf();
        if (any(bsdf.lobes() & smooth_lobes)) {
            result.radiance +=
                beta * sample_lights(scene, light_sampler_, bsdf, at, wo, 1, 1, stream);
        }

        // Continue along a direction of the BSDF
        const std::optional<BSDFSample> next =
            bsdf.sample(at, at.to_local(wo), u_lobe, u_direction, TransportMode::radiance);
        if (!next || is_black(next->weight)) return;
        const Vector3 wi = next->lobe == Lobe::null ? ray.d : at.to_world(next->wi);
        if (next->lobe != Lobe::null && !same_side(at, wi, next->wi)) return;
        beta *= next->weight;
        if (is_black(beta)) return;  // underflow: nothing that follows can be seen
        eta2 *= sqr(next->eta);
        vertex = {.receiver = at.receiver(wo, bsdf.sides()),
                  .pdf = next->pdf,
                  .specular = next->specular()};
        ray = at.spawn_ray(wi);

        // End dim paths, without changing the mean
        if (depth + 1 >= rr_depth_) {
            const float survival = std::min(max_component(beta) * eta2, 0.95f);
            stream.jump_to(dimension + dimensions_ - 1);
            if (!(stream.next_1d() < survival)) return;
            beta /= survival;
        }
    }
}

}  // namespace

const PluginInfo plugin =
    describe<PathIntegrator>("path tracing with next event estimation and MIS");

}  // namespace lucerna
