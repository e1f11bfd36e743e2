// SPDX-License-Identifier: Apache-2.0
/// path: unidirectional path tracing (Kajiya 1986) with next event estimation, multiple importance
/// sampling (Veach 1997, 9) and Russian roulette.
///
/// Finds all light but what reaches the eye only through a specular surface from a delta light,
/// and finds caustics of small lights slowly: that is what photon mapping is for.
#include "plugins/integrators/light_sampling.h"

#include <limits>
#include <vector>

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
    void sample(const Scene& scene, const Ray& ray, SampleStream& stream,
                PixelSample& result) const override;
    /// Samplers of many draws take long for one sample; whoever interrupts must not wait for more.
    std::size_t batch_size() const override { return light_sampler_.draws() <= 8 ? 64 : 1; }
    void sample_batch(const Scene& scene, std::span<CameraSample> samples) const override;

private:
    /// A path on its way: the ray to the vertex that comes, and what is there.
    struct Path : TracedRay {
        explicit Path(CameraSample& s) : TracedRay{s.ray}, sample(&s) {}

        CameraSample* sample;
        PathVertex before;
        Color beta{1};
        float eta2 = 1;  ///< undoes the scaling of radiance by refraction, for Russian roulette
        Vector2 u_direction{0}, u_lobe_and_roulette{0};
        std::optional<LitSurface> surface;
        Vector2 u_light{0};  ///< place on the light
        LightEstimate light;
        ColorD direct{0};
    };
    using Paths = std::vector<Path*>;

    static constexpr std::uint32_t camera_dimensions = 4;
    // Of a bounce: direction, lobe and roulette, light samples. All in pairs, which the sampler
    // computes together.
    static constexpr std::uint32_t bsdf_dimensions = 4;

    bool arrive(const Scene& scene, Path& path, int depth) const;
    void add_direct_light(const Scene& scene, const Paths& paths, int depth) const;
    bool scatter(Path& path, int depth) const;

    int max_depth_;
    int rr_depth_;
    bool hide_emitters_;
    const LightSampler& light_sampler_;
    std::uint32_t dimensions_ = 0;
};

/// Adds what is emitted where the ray ends; false if the path ends there, too.
bool PathIntegrator::arrive(const Scene& scene, Path& path, int depth) const {
    PixelSample& result = path.sample->result;
    const bool show = depth > 0 || !hide_emitters_;
    if (!path.hit) {
        if (show) {
            result.radiance +=
                path.beta * found_environment(scene, light_sampler_, path.before, path.ray.d);
        }
        if (depth == 0) result.alpha = show && !scene.infinite_lights().empty() ? 1.0f : 0.0f;
        return false;
    }
    const Vector3 wo = -path.ray.d;
    if (show) {
        result.radiance +=
            path.beta * found_emission(scene, light_sampler_, path.before, *path.hit, wo);
    }
    return true;
}

/// Light sampling at the vertices of all paths, then all shadow rays.
void PathIntegrator::add_direct_light(const Scene& scene, const Paths& paths, int depth) const {
    for (Path* path : paths) {
        SampleStream& stream = path->sample->stream;
        stream.jump_to(camera_dimensions + static_cast<std::uint32_t>(depth) * dimensions_);
        path->u_direction = stream.next_2d();
        path->u_lobe_and_roulette = stream.next_2d();
        path->surface.emplace(*path->hit, *path->hit->shape->bsdf(), -path->ray.d);
        path->direct = ColorD(0);  // in double: there may be a million draws
    }
    Paths lit, asking;
    lit.reserve(paths.size());
    for (Path* path : paths) {
        if (any(path->surface->lobes & smooth_lobes)) asking.push_back(path);
    }
    std::vector<LightQuery> queries(asking.size());
    for (std::uint32_t draw = 0; draw < light_sampler_.draws(); ++draw) {
        for (std::size_t i = 0; i < asking.size(); ++i) {
            Path& path = *asking[i];
            queries[i] = {.at = &path.surface->receiver, .u = path.sample->stream.next_2d().x};
            path.u_light = path.sample->stream.next_2d();
        }
        choose_lights(scene, light_sampler_, draw, queries);
        lit.clear();
        for (std::size_t i = 0; i < asking.size(); ++i) {
            Path* const path = asking[i];
            const std::optional<LightChoice>& choice = queries[i].choice;
            if (choice &&
                sample_light(scene, *choice, *path->surface, path->u_light, 1, 1, path->light)) {
                lit.push_back(path);
            }
        }
        for (Path* path : lit) {
            if (scene.occluded(path->surface->receiver, path->light.sample)) continue;
            path->direct += ColorD(path->light.value);
        }
    }
    for (Path* path : paths) path->sample->result.radiance += path->beta * Color(path->direct);
}

/// Continues along a direction of the BSDF; false if the path ends.
bool PathIntegrator::scatter(Path& path, int depth) const {
    const Interaction& at = *path.hit;
    const LitSurface& surface = *path.surface;
    const std::optional<BSDFSample> next =
        surface.bsdf.sample(at, surface.wo_local, path.u_lobe_and_roulette.x, path.u_direction,
                            TransportMode::radiance);
    if (!next || is_black(next->weight)) return false;
    const Vector3 wi = next->lobe == Lobe::null ? path.ray.d : at.to_world(next->wi);
    if (next->lobe != Lobe::null && !same_side(at, wi, next->wi)) return false;
    path.beta *= next->weight;
    if (is_black(path.beta)) return false;  // underflow: nothing that follows can be seen
    path.eta2 *= sqr(next->eta);
    path.before.receiver = surface.receiver;
    path.before.pdf = next->pdf;
    path.before.specular = next->specular();
    path.ray = at.spawn_ray(wi);
    if (depth + 1 < rr_depth_) return true;

    // End dim paths, without changing the mean
    const float survival = survival_probability(path.beta, path.eta2);
    if (!(path.u_lobe_and_roulette.y < survival)) return false;
    path.beta /= survival;
    return true;
}

/// All paths step by step together: while one waits for memory, the others go on.
void PathIntegrator::sample_batch(const Scene& scene, std::span<CameraSample> samples) const {
    const int max_depth = max_depth_ < 0 ? std::numeric_limits<int>::max() : max_depth_;
    std::vector<Path> paths;
    paths.reserve(samples.size());
    Paths active;
    for (CameraSample& sample : samples) active.push_back(&paths.emplace_back(sample));
    for (int depth = 0; depth < max_depth && !active.empty(); ++depth) {
        const std::vector<TracedRay*> rays(active.begin(), active.end());
        scene.intersect(rays);
        std::erase_if(active, [&](Path* path) { return !arrive(scene, *path, depth); });
        if (depth + 1 >= max_depth) return;
        add_direct_light(scene, active, depth);
        std::erase_if(active, [&](Path* path) { return !scatter(*path, depth); });
    }
}

void PathIntegrator::sample(const Scene& scene, const Ray& ray, SampleStream& stream,
                            PixelSample& result) const {
    CameraSample one{ray, stream, result};
    sample_batch(scene, std::span(&one, 1));
    result = one.result;
}

}  // namespace

const PluginInfo plugin =
    describe<PathIntegrator>("path tracing with next event estimation and MIS");

}  // namespace lucerna
