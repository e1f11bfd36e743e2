// SPDX-License-Identifier: Apache-2.0
/// path: unidirectional path tracing (Kajiya 1986) with next event estimation, multiple importance
/// sampling (Veach 1997, 9) and Russian roulette.
///
/// Neighbouring pixels share their paths behind the second vertex (path_reuse.h). Finds all light
/// but what reaches the eye only through a specular surface from a delta light, and finds caustics
/// of small lights slowly: that is what photon mapping is for.
#include "core/render/sampling_integrator.h"
#include "plugins/integrators/path_noise.h"
#include "plugins/integrators/render_options.h"
#include "plugins/integrators/specular_chain.h"

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
          reuse_(params.int32("reuse", 0, {.min = 0, .max = 16},
                              "paths are shared by blocks of so many by so many pixels, a power of "
                              "two; 1: pixels do not share; 0: what a few paths show to be best")),
          emitter_samples_(
              params.int32("emitter_samples", 0, {.min = 0, .max = most_light_samples},
                           "samples of lights at the first vertex; 0: what a few paths show to be "
                           "best")),
          chain_(params.int32("specular_chain", -1, {.min = -1, .max = 64},
                              "light samples of an environment follow up to so many mirrors and "
                              "panes of glass; -1: what a few paths show to be best")),
          hide_emitters_(
              params.boolean("hide_emitters", false, "the camera looks through emitters")),
          light_sampler_(params.nested_or<LightSampler>("cache", "which lights to sample")) {
        accept_render_options(params);
        if (max_depth_ < 0) max_depth_ = std::numeric_limits<int>::max();
        check_block_size(params, reuse_);
    }

    void prepare(const Scene& scene) override;

    int light_bounces() const override { return std::max(max_depth_ - 2, -1); }
    int block_size() const override { return splitting_.block_size; }
    void sample(const Scene& scene, std::span<CameraSample> samples) const override;

private:
    static constexpr std::uint32_t camera_dimensions = 4;
    // For each bounce: direction, lobe and roulette, light samples. All in pairs, which the sampler
    // computes together.
    static constexpr std::uint32_t bsdf_dimensions = 4;

    /// A path on its way: the ray to the vertex that comes, and what is there.
    struct Path : TracedRay {
        Path(CameraSample& s, const PathSplitting& splitting)
            : TracedRay{s.ray},
              sample(&s),
              light_samples(static_cast<std::uint32_t>(splitting.light_samples)),
              chain(splitting.chain) {}

        PathVertex& here() { return vertices[turn]; }
        PathVertex& before() { return vertices[1 - turn]; }

        /// Radiance that arrives at the last vertex.
        void add(Color arriving) {
            if (beyond_second) {
                kept->next_radiance += beta_from_second * arriving;
            } else {
                sample->result.radiance += beta * arriving;
            }
        }

        /// Past a surface that is no vertex, which lets the fraction `transmittance` through.
        void go_straight(Color transmittance) {
            // Paths are shared from vertex to vertex, and nothing lies between.
            if (depth == 1 || (depth == 0 && transmittance != Color(1))) kept = nullptr;
            chain.end();
            beta *= transmittance;
            beta_from_second *= transmittance;
            ray = hit->spawn_ray(ray.d);
        }

        CameraSample* sample;
        std::uint32_t dimension = camera_dimensions;  ///< of the sample stream, at the next step
        std::uint32_t light_samples;                  ///< at the next step
        PathVertex vertices[2];                       ///< here() and before(), by turns
        int turn = 0;
        SpecularChain chain;     ///< since the vertex before
        int depth = 0;           ///< vertices before the one that comes
        float seen_through = 1;  ///< of what lies before the first vertex
        Color beta{1};
        float eta2 = 1;  ///< undoes the scaling of radiance by refraction, for Russian roulette
        Vector2 u_direction{0}, u_lobe_and_roulette{0};
        std::optional<LitSurface> surface;
        Vector2 u_light{0};  ///< place on the light
        LightEstimate light;
        ColorD direct{0};  ///< sum of light samples, in double: there may be many

        ReusablePath* kept = nullptr;  ///< for other pixels; null if they cannot use it
        bool beyond_second = false;    ///< what is found counts from the second vertex on:
        Color beta_from_second{1};
    };
    using Paths = std::vector<Path*>;

    void trace(const Scene& scene, std::span<CameraSample> samples, std::span<ReusablePath> kept,
               const PathSplitting& splitting) const;
    bool arrive(const Scene& scene, Path& path) const;
    void add_found_light(const Scene& scene, Path& path) const;
    static void keep_vertex(Path& path);
    Color arriving_radiance(const Scene& scene, const Path& path) const;
    Paths begin_light_sampling(const Paths& paths) const;
    void add_direct_light(const Scene& scene, const Paths& paths) const;
    void add_light_sample(const Scene& scene, const LightChoice& choice, Path& path) const;
    bool scatter(const Scene& scene, Path& path, int step) const;
    static void leave_kept_vertex(Path& path, const BSDFSample& next);
    static bool survive(Path& path);

    int max_depth_;
    int rr_depth_;
    int reuse_, emitter_samples_, chain_;
    bool hide_emitters_;
    const LightSampler& light_sampler_;
    PathSplitting splitting_;
};

void PathIntegrator::prepare(const Scene& scene) {
    splitting_ = {.light_samples = emitter_samples_, .block_size = reuse_, .chain = chain_};
    // Many light samples make a path's own light good, and reuse dear.
    const bool dark = scene.lights().empty();
    if (max_depth_ <= 2 || dark || emitter_samples_ > 8) splitting_.block_size = 1;
    if (emitter_samples_ == 0 && (max_depth_ <= 1 || dark)) splitting_.light_samples = 1;
    if (max_depth_ <= 2 || !may_light_chains(scene)) splitting_.chain = 0;
    if (splitting_.light_samples > 0 && splitting_.block_size > 0 && splitting_.chain >= 0) return;
    splitting_ = PathNoiseMeter(scene).find_best(
        splitting_,
        [&](std::span<CameraSample> samples, std::span<ReusablePath> kept,
            const PathSplitting& splitting) { trace(scene, samples, kept, splitting); });
}

/// Adds what is emitted where the ray ends.
void PathIntegrator::add_found_light(const Scene& scene, Path& path) const {
    if (path.depth == 0 && hide_emitters_) return;
    const Color found = path.hit ? found_emission(scene, path.before(), *path.hit, -path.ray.d)
                                 : found_environment(scene, path.before(), path.ray.d);
    // Emission that the second vertex sees is weighted for the direction the path came from.
    if (path.depth - path.chain.vertices() > 2) {
        path.add(path.chain.weight() * found);
    } else {
        path.sample->result.radiance += path.chain.weight() * path.beta * found;
    }
}

/// Follows the ray to the next vertex, adding what is emitted on the way; false if there is none.
/// Emitters that are hidden are no vertices, nor is what only lets light through. After the last
/// vertex that is allowed, only light that goes straight through counts.
bool PathIntegrator::arrive(const Scene& scene, Path& path) const {
    while (path.hit) {
        add_found_light(scene, path);
        const Interaction& at = *path.hit;
        if (path.depth == 0 && hide_emitters_ && at.shape->emitter()) {
            path.go_straight(Color(1));
        } else if (path.depth + 1 < max_depth_ && at.shape->bsdf()->lobes() != Lobe::null) {
            return true;
        } else {
            const Color transmittance = straight_transmittance(at, -path.ray.d);
            if (is_black(transmittance)) return false;
            path.seen_through *= luminance(transmittance);
            path.go_straight(transmittance);
        }
        path.hit = scene.intersect(path.ray);
    }
    add_found_light(scene, path);
    if (path.depth == 0) {
        const bool sky = !hide_emitters_ && !scene.infinite_lights().empty();
        path.sample->result.alpha = sky ? 1.0f : 1 - path.seen_through;
    }
    return false;
}

/// Keeps the first two vertices for other pixels.
void PathIntegrator::keep_vertex(Path& path) {
    ReusablePath& kept = *path.kept;
    (path.depth == 0 ? kept.first : kept.second).set(*path.surface, nullptr);
}

/// What the shadow ray of a light sample leaves of its radiance, or what it finds behind mirrors
/// and glass instead.
Color PathIntegrator::arriving_radiance(const Scene& scene, const Path& path) const {
    const LightSample& sample = path.light.sample;
    const Color direct =
        is_black(sample.radiance)
            ? Color(0)
            : sample.radiance * scene.transmittance(path.surface->receiver, sample);
    const int longest = std::min(path.chain.longest(), max_depth_ - path.depth - 2);
    const bool from_environment = !sample.delta && sample.distance == infinity;
    if (longest <= 0 || !from_environment || !is_black(direct)) return direct;
    return radiance_through_chain(scene, path.hit->spawn_ray(sample.wi), longest);
}

/// Sets up the vertices of paths for light sampling; returns those at which it finds something.
PathIntegrator::Paths PathIntegrator::begin_light_sampling(const Paths& paths) const {
    Paths lit;
    lit.reserve(paths.size());
    for (Path* path : paths) {
        SampleStream& stream = path->sample->stream;
        stream.jump_to(path->dimension);
        path->dimension += bsdf_dimensions + path->light_samples * light_dimensions;
        path->u_direction = stream.next_2d();
        path->u_lobe_and_roulette = stream.next_2d();
        const LitSurface& surface =
            path->surface.emplace(*path->hit, *path->hit->shape->bsdf(), -path->ray.d);
        path->direct = ColorD(0);
        if (path->depth == 0 && !surface.samples_lights) path->kept = nullptr;
        if (path->kept && path->depth < 2) keep_vertex(*path);
        if (surface.samples_lights) lit.push_back(path);
    }
    return lit;
}

/// Direct light at the vertices of all paths, each step for all of them.
void PathIntegrator::add_direct_light(const Scene& scene, const Paths& paths) const {
    const Paths lit = begin_light_sampling(paths);
    if (lit.empty()) return;
    std::vector<const Receiver*> receivers;
    std::vector<LightDistribution*> distributions;
    for (Path* path : lit) {
        receivers.push_back(&path->surface->receiver);
        distributions.push_back(&path->here().lights);
    }
    light_sampler_.batch().at(light_sampler_, receivers, distributions);
    const std::uint32_t light_samples = lit.front()->light_samples;  // the same for all
    std::vector<LightDraw> draws(lit.size());
    for (std::uint32_t k = 0; k < light_samples; ++k) {
        for (std::size_t i = 0; i < lit.size(); ++i) {
            Path& path = *lit[i];
            const float u = path.sample->stream.next_2d().x;
            draws[i] = {.lights = distributions[i],
                        .u = light_number(*receivers[i], k, light_samples, u)};
            path.u_light = path.sample->stream.next_2d();
        }
        choose_lights(scene, light_sampler_, draws);
        for (std::size_t i = 0; i < lit.size(); ++i) {
            std::optional<LightChoice>& choice = draws[i].choice;
            if (choice &&
                !sample_li(scene, *choice, *receivers[i], lit[i]->u_light, lit[i]->light.sample)) {
                choice.reset();
            }
        }
        for (std::size_t i = 0; i < lit.size(); ++i) {
            if (draws[i].choice) add_light_sample(scene, *draws[i].choice, *lit[i]);
        }
    }
    for (Path* path : lit) path->add(Color(path->direct / static_cast<double>(light_samples)));
}

/// Adds what a light sample brings, or keeps it, if other paths may use it.
void PathIntegrator::add_light_sample(const Scene& scene, const LightChoice& choice,
                                      Path& path) const {
    LightEstimate& light = path.light;
    const bool for_others = path.depth == 1 && path.kept;
    const auto count = static_cast<float>(path.light_samples);
    if (!weigh_light(choice, *path.surface, count, 1, for_others, light)) return;
    const Color arriving = arriving_radiance(scene, path);
    if (is_black(arriving)) return;
    if (for_others) {
        light.sample.radiance = arriving;
        path.kept->lights.emplace_back(light, abs_cos_theta(light.wi_local));
    } else {
        path.direct += ColorD(arriving * light.response);
    }
}

/// Continues along a direction of the BSDF; false if the path ends. What is found straight through
/// the surface is weighted against light sampling at the vertex before.
bool PathIntegrator::scatter(const Scene& scene, Path& path, int step) const {
    const Interaction& at = *path.hit;
    const LitSurface& surface = *path.surface;
    const std::uint32_t light_samples = std::exchange(path.light_samples, 1);
    const std::optional<ScatteredRay> next =
        lucerna::scatter(at, -path.ray.d, path.u_lobe_and_roulette.x, path.u_direction);
    if (!next) return false;
    const BSDFSample& sample = next->sample;
    if (is_black(path.beta * sample.weight)) return false;  // underflow: nothing can be seen
    if (sample.lobe == Lobe::null) {
        if (path.depth == 0) path.kept = nullptr;
        path.go_straight(sample.weight);
    } else {
        path.beta *= sample.weight;
        path.beta_from_second *= sample.weight;
        path.eta2 *= sqr(sample.eta);
        if (!sample.specular()) {
            path.chain.begin();
        } else {
            path.chain.pass(scene, path.before(), path.ray.d, at);
        }
        if (!sample.specular()) path.turn = 1 - path.turn;  // the lights here are those before
        PathVertex& before = path.before();
        before.receiver = surface.receiver;
        before.pdf = sample.pdf;
        before.light_samples = static_cast<float>(light_samples);
        before.specular = sample.specular();
        path.ray = next->ray;
        if (path.kept && path.depth < 2) leave_kept_vertex(path, sample);
        ++path.depth;
    }
    const bool roulette = step + 1 >= rr_depth_ && (step > 0 || !path.kept);
    return !roulette || survive(path);
}

/// Hands on the direction in which a path leaves a vertex that is kept. A direction of a delta lobe
/// is of no use to others.
void PathIntegrator::leave_kept_vertex(Path& path, const BSDFSample& next) {
    if (path.depth == 0) {
        path.kept->to_second = {.weight = next.weight, .pdf = next.pdf};
        if (next.specular()) path.kept = nullptr;
    } else if (!next.specular()) {
        path.kept->next_local = next.wi;
        path.kept->next_f_cosine = next.weight * next.pdf;
        path.kept->next_pdf = next.pdf;
        path.beyond_second = true;
        path.beta_from_second = Color(1);
    }
}

/// Ends dim paths, without changing the mean.
bool PathIntegrator::survive(Path& path) {
    const float survival = survival_probability(path.beta, path.eta2);
    if (!(path.u_lobe_and_roulette.y < survival)) return false;
    path.beta /= survival;
    path.beta_from_second /= survival;
    return true;
}

/// All paths step by step together: while one waits for memory, the others go on. What `kept`, if
/// it is not empty, has for other pixels is not in the samples yet.
void PathIntegrator::trace(const Scene& scene, std::span<CameraSample> samples,
                           std::span<ReusablePath> kept, const PathSplitting& splitting) const {
    std::vector<Path> paths;
    paths.reserve(samples.size());
    Paths active;
    for (CameraSample& sample : samples) {
        active.push_back(&paths.emplace_back(sample, splitting));
    }
    for (std::size_t i = 0; i < kept.size(); ++i) {
        kept[i].radiance = &samples[i].result.radiance;
        paths[i].kept = &kept[i];
    }
    for (int step = 0; !active.empty(); ++step) {
        const std::vector<TracedRay*> rays(active.begin(), active.end());
        scene.intersect(rays);
        std::erase_if(active, [&](Path* path) { return !arrive(scene, *path); });
        add_direct_light(scene, active);
        std::erase_if(active, [&](Path* path) { return !scatter(scene, *path, step); });
    }
}

void PathIntegrator::sample(const Scene& scene, std::span<CameraSample> samples) const {
    if (max_depth_ == 0) return;
    std::vector<ReusablePath> kept(splitting_.block_size > 1 ? samples.size() : 0);
    trace(scene, samples, kept, splitting_);
    reuse_paths(scene, samples, kept, false);
}

}  // namespace

const PluginInfo plugin =
    describe<PathIntegrator>("path tracing with next event estimation and MIS");

}  // namespace lucerna
