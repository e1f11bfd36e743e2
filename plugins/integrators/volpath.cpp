// SPDX-License-Identifier: Apache-2.0
/// volpath: path tracing through participating media, with next event estimation, multiple
/// importance sampling and Russian roulette.
///
/// Surfaces are treated as in `path` without path reuse and specular chains and with one pass of
/// light samples: by default, a scene without media gets the same bits. Media:
/// core/scene/medium_tracking.h. In scenes with media, neighbouring pixels share their paths behind
/// the second vertex where a homogeneous medium, or nothing, lies before it (path_reuse.h).
///
/// Light that arrives at a vertex is estimated by sampling lights, with an estimate of the
/// transmittance up to them, and by following the path. The power heuristic weights the two by
/// their densities of direction alone: both estimates of the transmittance are unbiased by
/// themselves. Direct light that a homogeneous medium scatters is sampled once more along each ray
/// (line_scattering.h).
#include "core/render/sampling_integrator.h"
#include "core/scene/medium_tracking.h"
#include "plugins/integrators/line_scattering.h"
#include "plugins/integrators/medium_lighting.h"
#include "plugins/integrators/path_noise.h"
#include "plugins/integrators/render_options.h"

#include <limits>

namespace lucerna {

namespace {

class VolumetricPathIntegrator final : public SamplingIntegrator {
public:
    explicit VolumetricPathIntegrator(const Params& params)
        : max_depth_(params.int32("max_depth", -1, {.min = -1},
                                  "longest path in edges: 1 shows only emitters, 2 direct light; "
                                  "-1 is unlimited")),
          rr_depth_(params.int32("rr_depth", 0, {.min = 0},
                                 "edges before Russian roulette may end a path; 0: 5, in scenes "
                                 "with media 1")),
          emitter_samples_(
              params.int32("emitter_samples", 0, {.min = 0, .max = most_light_samples},
                           "samples of lights at each vertex; 0: 1, in scenes with media 2")),
          reuse_(params.int32("reuse", 0, {.min = 0, .max = 16},
                              "paths are shared by blocks of so many by so many pixels, a power of "
                              "two; 1: pixels do not share; 0: 1, in scenes with media what a few "
                              "paths show to be best")),
          hide_emitters_(
              params.boolean("hide_emitters", false, "the camera looks through emitters")),
          light_sampler_(params.nested_or<LightSampler>("cache", "which lights to sample")) {
        accept_render_options(params);
        if (max_depth_ < 0) max_depth_ = std::numeric_limits<int>::max();
        check_block_size(params, reuse_);
    }

    void prepare(const Scene& scene) override;
    bool renders_media() const override { return true; }
    int light_bounces() const override { return std::max(max_depth_ - 2, -1); }
    int block_size() const override { return block_size_; }
    void sample(const Scene& scene, std::span<CameraSample> samples) const override;

private:
    // As in `path`. In scenes with media, each step takes six more: distances and seed.
    static constexpr std::uint32_t camera_dimensions = 4;
    static constexpr std::uint32_t bsdf_dimensions = 4, medium_dimensions = 6;

    enum class Vertex { none, surface, medium };

    struct Path {
        Path(const Scene& s, CameraSample& sample_, std::uint32_t count)
            : scene(s), sample(sample_), ray(sample_.ray), light_samples(count) {
            if (scene.has_media()) medium = scene.sensor().medium();
        }

        /// Radiance that arrives at the last vertex.
        void add(Color arriving) { add_seen(beta * arriving); }
        /// The same, times `beta` already.
        void add_seen(Color radiance) {
            if (beyond_second) {
                kept->next_radiance += radiance;
            } else {
                sample.result.radiance += beta_before * radiance;
            }
        }
        /// From here on, `beta` counts from 1.
        void restart() {
            beta_before *= beta;
            beta = Color(1);
        }

        /// Whether other paths can go to the vertex that comes as this one does.
        bool shares_second() const { return kept && depth == 1; }

        /// Past a surface that is no vertex, which lets the fraction `transmittance` through.
        void go_straight(Color transmittance) {
            if (depth == 1) kept = nullptr;  // paths are shared from vertex to vertex
            beta *= transmittance;
            medium = medium_beyond(*hit, ray.d, medium);
            ray = hit->spawn_ray(ray.d);
        }

        const Scene& scene;
        CameraSample& sample;
        Ray ray;
        std::optional<Interaction> hit{};
        const Medium* medium = nullptr;  ///< in which the ray starts
        float collision = 0;             ///< distance to it, if the vertex is in the medium
        float direct_weight = 1;         ///< of light sampling there
        Rng rng{0};                      ///< for media
        std::uint32_t light_samples;     ///< at each vertex
        std::uint32_t dimension = camera_dimensions;
        Vector2 u_direction{0}, u_lobe_and_roulette{0}, u_distance{0}, u_line{0};
        Receiver here;             ///< the surface at which the path is
        LightDistribution lights;  ///< at the vertex, if it samples lights
        PathVertex before;
        int depth = 0;                  ///< vertices before the one that comes
        float seen_through = 1;         ///< of what lies before the first vertex
        Color beta_before{1}, beta{1};  ///< their product is the throughput
        float eta2 = 1;  ///< undoes the scaling of radiance by refraction, for Russian roulette

        ReusablePath* kept = nullptr;  ///< for other pixels; null if they cannot use it
        bool beyond_second = false;    ///< what is found is kept, too
    };

    int choose_block_size(const Scene& scene) const;
    void trace(const Scene& scene, CameraSample& sample, ReusablePath* kept) const;
    void trace(const Scene& scene, std::span<CameraSample> samples,
               std::span<ReusablePath> kept) const;
    void draw_numbers(Path& path) const;
    Vertex arrive(Path& path) const;
    bool cross_medium(Path& path) const;
    void add_line_scattering(Path& path, const MediumSegment& way, LineScattering& line) const;
    void leave_scene(Path& path) const;
    void add_found_light(Path& path) const;
    template <typename... Where>
    static void keep_vertex(Path& path, const Where&... where);
    static void keep_light(const Path& path, LightEstimate light, Color arriving);
    static void leave_vertex(Path& path, const BSDFSample& next);
    void add_direct_light(Path& path) const;
    template <typename Where>
    void add_direct_light(Path& path, const Where& vertex, float weight) const;
    bool scatter_at_surface(Path& path) const;
    bool scatter_in_medium(Path& path, const LitPoint& point) const;

    int max_depth_;
    int rr_depth_;
    int emitter_samples_, reuse_;
    bool hide_emitters_;
    const LightSampler& light_sampler_;
    std::uint32_t light_samples_ = 1;
    int first_roulette_ = 5;
    int block_size_ = 1;
};

void VolumetricPathIntegrator::prepare(const Scene& scene) {
    // In fog most of the noise comes from light samples near lamps, and paths that go on forever
    // add little to it: measured with tests/benchmarks/media_against_mitsuba.py.
    const bool media = scene.has_media();
    const int usual_samples = media ? 2 : 1;
    light_samples_ =
        static_cast<std::uint32_t>(emitter_samples_ > 0 ? emitter_samples_ : usual_samples);
    first_roulette_ = rr_depth_ > 0 ? rr_depth_ : (media ? 1 : 5);
    block_size_ = choose_block_size(scene);
}

int VolumetricPathIntegrator::choose_block_size(const Scene& scene) const {
    // Many light samples make a path's own light good, and reuse dear.
    if (max_depth_ <= 2 || scene.lights().empty() || emitter_samples_ > 8) return 1;
    if (reuse_ > 0 || !scene.has_media()) return std::max(reuse_, 1);
    const PathNoiseMeter meter(scene);
    const auto trace_all = [&](std::span<CameraSample> samples, std::span<ReusablePath> kept,
                               const PathSplitting&) { trace(scene, samples, kept); };
    const PathSplitting given{.light_samples = 1, .block_size = 0};
    const PathNoise shared = meter.measure(given, trace_all);
    const int size = best_splitting(shared, given).block_size;
    // Light is sampled along rays, too, unless they lead to vertices for others.
    const PathNoise alone = meter.measure_alone(given, trace_all);
    return alone.inefficiency(1, 1) < shared.inefficiency(1, size) ? 1 : size;
}

/// The numbers of a step that are not for lights; those follow in the stream.
void VolumetricPathIntegrator::draw_numbers(Path& path) const {
    SampleStream& stream = path.sample.stream;
    const bool has_media = path.scene.has_media();
    stream.jump_to(path.dimension);
    path.dimension += bsdf_dimensions + path.light_samples * light_dimensions;
    path.u_direction = stream.next_2d();
    path.u_lobe_and_roulette = stream.next_2d();
    if (!has_media) return;
    path.dimension += medium_dimensions;
    path.u_distance = stream.next_2d();
    path.u_line = stream.next_2d();
    path.rng = seeded_by(stream.next_2d());
}

/// Adds what is emitted where the ray ends.
void VolumetricPathIntegrator::add_found_light(Path& path) const {
    if (path.depth == 0 && hide_emitters_) return;
    const Color found = path.hit ? found_emission(path.scene, path.before, *path.hit, -path.ray.d)
                                 : found_environment(path.scene, path.before, path.ray.d);
    if (path.depth > 2) {
        path.add(found);
    } else {
        path.sample.result.radiance += path.beta_before * path.beta * found;
    }
}

/// Direct light that is scattered anywhere along the ray.
void VolumetricPathIntegrator::add_line_scattering(Path& path, const MediumSegment& way,
                                                   LineScattering& line) const {
    Rng& rng = path.rng;
    aim_at_light(path.scene, light_sampler_, way, rng, line);
    const float u_strategy = path.u_line.x;
    const float t = line.sample(u_strategy, static_cast<double>(path.u_line.y));
    const Color throughput = line.throughput(t);
    if (is_black(throughput) || !is_finite(throughput)) return;
    const LitPoint point{.receiver = Receiver::in_medium(*way.medium, way.o, way.d, t),
                         .phase = way.medium->phase(),
                         .wo = -way.d};
    path.add_seen(throughput * sample_lights(path.scene, light_sampler_.at(point.receiver), point,
                                             {1, path.light_samples}, 1, rng,
                                             [&] { return rng.next_float2(); }));
}

/// Through the medium up to the surface that comes; true if the path is scattered before.
bool VolumetricPathIntegrator::cross_medium(Path& path) const {
    if (!path.medium) return false;
    const MediumSegment way{path.medium, path.ray.o, path.ray.d, path.hit ? path.hit->t : infinity};
    const bool may_scatter = path.depth + 1 < max_depth_;
    if (path.shares_second() && !path.medium->homogeneous()) path.kept = nullptr;
    std::optional<LineScattering> line;
    const bool samples_line =
        may_scatter && path.medium->homogeneous() && !path.scene.lights().empty();
    if (samples_line && !path.shares_second()) {
        line.emplace(way, path.beta);
        if (line->scatters()) {
            add_line_scattering(path, way, *line);
        } else {
            line.reset();
        }
    }
    MediumPath through{.beta = path.beta};
    const bool scattered = sample_collision(way, may_scatter, path.u_distance, path.rng, through);
    if (path.depth == 0) path.seen_through *= luminance(through.beta) / luminance(path.beta);
    if (path.shares_second()) {
        const float length = scattered ? through.t : way.length;
        path.kept->to_second.reach =
            HomogeneousEdge(*way.medium, way.o, way.d, length, path.beta).reach(scattered);
    }
    path.add_seen(through.radiance);
    path.beta = through.beta;
    path.collision = through.t;
    path.direct_weight = line && scattered ? line->collision_weight(through.t) : 1;
    // Behind a surface that is no vertex the way goes on with new numbers.
    path.u_distance = path.rng.next_float2();
    path.u_line = path.rng.next_float2();
    return scattered;
}

void VolumetricPathIntegrator::leave_scene(Path& path) const {
    add_found_light(path);
    if (path.depth > 0) return;
    const bool sky = !hide_emitters_ && !path.scene.infinite_lights().empty();
    path.sample.result.alpha = sky ? 1.0f : 1 - path.seen_through;
}

/// Follows the ray to the next vertex, adding what is emitted on the way. Emitters that are hidden
/// are no vertices, nor is what only lets light through. After the last vertex that is allowed,
/// only light that goes straight through counts.
VolumetricPathIntegrator::Vertex VolumetricPathIntegrator::arrive(Path& path) const {
    while (true) {
        path.hit = path.scene.intersect(path.ray);
        if (cross_medium(path)) return is_black(path.beta) ? Vertex::none : Vertex::medium;
        if (path.medium && is_black(path.beta)) return Vertex::none;
        if (!path.hit) break;
        add_found_light(path);
        const Interaction& at = *path.hit;
        if (path.depth == 0 && hide_emitters_ && at.shape->emitter()) {
            path.go_straight(Color(1));
        } else if (path.depth + 1 < max_depth_ && at.shape->bsdf()->lobes() != Lobe::null) {
            return Vertex::surface;
        } else {
            const Color transmittance = straight_transmittance(at, -path.ray.d);
            if (is_black(transmittance)) return Vertex::none;
            path.seen_through *= luminance(transmittance);
            path.go_straight(transmittance);
        }
    }
    leave_scene(path);
    return Vertex::none;
}

/// Keeps the first two vertices for other pixels.
template <typename... Where>
void VolumetricPathIntegrator::keep_vertex(Path& path, const Where&... where) {
    if (!path.kept || path.depth > 1) return;
    ReusablePath& kept = *path.kept;
    if (path.depth == 0) {
        kept.first.set(where...);
        kept.beta = path.beta;
    } else {
        kept.second.set(where...);
        kept.to_second.weight = path.beta;
    }
    path.restart();
}

/// Keeps a light sample at the second vertex.
void VolumetricPathIntegrator::keep_light(const Path& path, LightEstimate light, Color arriving) {
    if (is_black(arriving)) return;
    light.sample.radiance *= arriving;
    const auto count = static_cast<float>(path.light_samples);
    light.density *= count;
    light.weight /= count;
    path.kept->lights.emplace_back(light, path.kept->second.cosine(light.wi_local));
}

/// Hands on the direction in which a path leaves a vertex that is kept. A direction of a delta lobe
/// is of no use to others.
void VolumetricPathIntegrator::leave_vertex(Path& path, const BSDFSample& next) {
    if (path.kept && path.depth == 0) {
        path.kept->to_second.pdf = next.pdf;
        if (next.specular()) path.kept = nullptr;
    } else if (path.shares_second() && !next.specular()) {
        path.kept->next_local = next.wi;
        path.kept->next_f_cosine = next.weight * next.pdf;
        path.kept->next_pdf = next.pdf;
        path.beyond_second = true;
        path.restart();
    }
    ++path.depth;
}

/// Light sampling at a surface.
void VolumetricPathIntegrator::add_direct_light(Path& path) const {
    const Interaction& at = *path.hit;
    const LitSurface surface(at, *at.shape->bsdf(), -path.ray.d);
    path.here = surface.receiver;
    if (path.depth == 0 && !surface.samples_lights) path.kept = nullptr;
    keep_vertex(path, surface, path.medium);
    add_direct_light(path, SurfaceInMedium{surface, path.medium}, 1);
}

/// Adds the light samples at a vertex, or keeps them for other pixels, too.
template <typename Where>
void VolumetricPathIntegrator::add_direct_light(Path& path, const Where& vertex,
                                                float weight) const {
    if (vertex.samples_lights()) path.lights = light_sampler_.at(vertex.lit_from());
    const auto sample_each = [&](auto&& visit) {
        visit_light_samples(
            path.scene, path.lights, vertex, {path.light_samples, path.light_samples}, 1,
            path.shares_second(), path.rng, [&] { return path.sample.stream.next_2d(); }, visit);
    };
    if (path.shares_second()) {
        return sample_each(
            [&](const LightEstimate& light, Color arriving) { keep_light(path, light, arriving); });
    }
    DirectLight direct;
    sample_each(direct);
    path.add(weight * direct.mean(path.light_samples));
}

/// Continues along a direction of the BSDF; false if the path ends. What is found straight through
/// the surface is weighted against light sampling at the vertex before.
bool VolumetricPathIntegrator::scatter_at_surface(Path& path) const {
    const Interaction& at = *path.hit;
    const std::optional<ScatteredRay> next =
        scatter(at, -path.ray.d, path.u_lobe_and_roulette.x, path.u_direction);
    if (!next) return false;
    const BSDFSample& sample = next->sample;
    if (is_black(path.beta * sample.weight)) return false;  // underflow: nothing can be seen
    if (sample.lobe == Lobe::null) {
        if (path.depth == 0) path.kept = nullptr;
        path.go_straight(sample.weight);
        return true;
    }
    path.beta *= sample.weight;
    path.eta2 *= sqr(sample.eta);
    path.before = {.receiver = path.here,
                   .lights = path.lights,
                   .pdf = sample.pdf,
                   .light_samples = static_cast<float>(path.light_samples),
                   .specular = sample.specular()};
    path.ray = next->ray;
    path.medium = medium_beyond(at, path.ray.d, path.medium);
    leave_vertex(path, sample);
    return true;
}

/// Continues along a direction of the phase function; false if the path ends.
bool VolumetricPathIntegrator::scatter_in_medium(Path& path, const LitPoint& point) const {
    const PhaseSample sample = point.phase.sample(point.receiver.p, point.wo,
                                                  path.u_lobe_and_roulette.x, path.u_direction);
    if (!(sample.weight > 0)) return false;
    path.beta *= sample.weight;
    path.before = {.receiver = point.receiver,
                   .lights = path.lights,
                   .pdf = sample.pdf,
                   .light_samples = static_cast<float>(path.light_samples),
                   .specular = false};
    path.ray = {.o = point.receiver.p, .d = sample.wi};
    leave_vertex(path, {.wi = sample.wi,
                        .weight = Color(sample.weight),
                        .pdf = sample.pdf,
                        .lobe = Lobe::diffuse_reflection});
    return true;
}

/// What `kept`, if it is not null, has for other pixels is not in the sample yet.
void VolumetricPathIntegrator::trace(const Scene& scene, CameraSample& sample,
                                     ReusablePath* kept) const {
    Path path(scene, sample, light_samples_);
    path.kept = kept;
    if (kept) kept->radiance = &sample.result.radiance;
    for (int step = 0;; ++step) {
        draw_numbers(path);
        const Vertex vertex = arrive(path);
        if (vertex == Vertex::none) return;
        if (vertex == Vertex::surface) {
            add_direct_light(path);
            if (!scatter_at_surface(path)) return;
        } else {
            const LitPoint point{.receiver = Receiver::in_medium(*path.medium, path.ray.o,
                                                                 path.ray.d, path.collision),
                                 .phase = path.medium->phase(),
                                 .wo = -path.ray.d};
            keep_vertex(path, point);
            add_direct_light(path, point, path.direct_weight);
            if (!scatter_in_medium(path, point)) return;
        }
        if (step + 1 < first_roulette_ || (step == 0 && path.kept)) continue;
        const float survival = survival_probability(path.beta_before * path.beta, path.eta2);
        if (!(path.u_lobe_and_roulette.y < survival)) return;
        path.beta /= survival;
    }
}

void VolumetricPathIntegrator::trace(const Scene& scene, std::span<CameraSample> samples,
                                     std::span<ReusablePath> kept) const {
    for (std::size_t i = 0; i < samples.size(); ++i) {
        trace(scene, samples[i], kept.empty() ? nullptr : &kept[i]);
    }
}

void VolumetricPathIntegrator::sample(const Scene& scene, std::span<CameraSample> samples) const {
    if (max_depth_ == 0) return;
    std::vector<ReusablePath> kept(block_size_ > 1 ? samples.size() : 0);
    trace(scene, samples, kept);
    reuse_paths(scene, samples, kept, scene.has_media());
}

}  // namespace

const PluginInfo plugin = describe<VolumetricPathIntegrator>(
    "path tracing through fog, smoke and other participating media");

}  // namespace lucerna
