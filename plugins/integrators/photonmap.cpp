// SPDX-License-Identifier: Apache-2.0
/// photonmap: photon mapping (Jensen 1996) with k-d tree or hash grid, final gathering, and a map
/// for caustics.
///
/// Two passes. Photons leave the lights, scatter, and are stored where they meet diffuse surfaces;
/// then radiance there is read from their density. Light that comes to a surface directly is
/// sampled, caustics (L S+ D) have a map of their own if the scene can have any, and `final_gather`
/// rays look at the map from one bounce away. Photons that media scatter have maps of their own
/// (photon_media.h). See docs/photon_mapping.md.
#include "plugins/integrators/photon_camera.h"
#include "plugins/integrators/photon_estimate.h"
#include "plugins/integrators/render_options.h"

#include <cstdio>

namespace lucerna {

namespace {

enum class Show { radiance, photons, caustics, global };

/// The photon itself is the nearest.
constexpr int most_nearest = PhotonLookup::max_count - 1;

/// Radii are fractions of the radius of the scene.
struct MapSettings {
    std::int64_t photons;
    float radius;
    bool in_media = false;  ///< instead of on surfaces
};

class PhotonMapIntegrator final : public Integrator {
public:
    explicit PhotonMapIntegrator(const Params& params);

    bool renders_media() const override { return true; }
    int light_bounces() const override { return 1; }  // off glossy surfaces
    void render(RenderJob& job) const override;

private:
    struct Maps {
        PhotonMap global, caustic;
        BeamMap medium, medium_caustic;
    };

    StoredPhotons trace(const RenderJob& job, const PhotonTracer& tracer,
                        const MapSettings& settings, PhotonKinds kinds) const;
    float radius(const RenderJob& job, const MapSettings& settings) const;
    PhotonMap surface_map(const RenderJob& job, const PhotonTracer& tracer,
                          const MapSettings& settings, PhotonKinds kinds) const;
    BeamMap medium_map(const RenderJob& job, const PhotonTracer& tracer,
                       const MapSettings& settings, PhotonKinds kinds) const;
    void build_on_surfaces(const RenderJob& job, const PhotonTracer& tracer, Maps& maps) const;
    void build_in_media(const RenderJob& job, const PhotonTracer& tracer, Maps& maps) const;
    std::optional<MediumView> media(const Scene& scene, const Maps& maps) const;
    Color radiance(const PhotonMap& map, const Interaction& at, Vector3 wo, int edges) const;
    Color dots(const PhotonMap& map, const Interaction& at, Vector3 wo) const;
    Color gather(const Scene& scene, const Maps& maps, const MediumView* media,
                 const GatherPoint& point, SampleStream& stream) const;
    Color gather_ray(const Scene& scene, const Maps& maps, const MediumView* media,
                     const GatherPoint& point, SampleStream& stream) const;
    Color seen(const Scene& scene, const Maps& maps, const MediumView* media,
               const GatherPoint& point, SampleStream& stream) const;

    PathLimits limits_;
    MapSettings global_, caustic_, medium_;
    int medium_nearest_ = 0;
    float dot_radius_;
    PhotonLookup lookup_;
    PhotonStructure structure_;
    bool direct_from_map_;
    int final_gather_;
    Show show_;
    bool hide_emitters_;
    std::uint32_t emitter_samples_;
    const LightSampler& light_sampler_;
};

PhotonMapIntegrator::PhotonMapIntegrator(const Params& params)
    : limits_(params),
      global_{params.integer("global_photons", 250000, {.min = 1, .max = 1e9},
                             "photons stored in the global map"),
              params.real("global_lookup_radius", 0.05, positive,
                          "largest radius of a lookup [radius of the scene]")},
      caustic_{params.integer("caustic_photons", 250000, {.min = 1, .max = 1e9},
                              "photons stored in the map of caustics, if there can be any"),
               params.real("caustic_lookup_radius", 0.0125, positive,
                           "largest radius of a lookup of caustics [radius of the scene]")},
      medium_{params.integer("volume_photons", 250000, {.min = 1, .max = 1e9},
                             "photons stored in each of the maps of media, caustics and others"),
              params.real("volume_lookup_radius", 0.05, positive,
                          "largest radius of a photon in a medium [radius of the scene]"),
              true},
      dot_radius_(params.real("dot_radius", 0.0015, positive,
                              "of a photon that is shown [radius of the scene]")),
      structure_(params.choice<PhotonStructure>(
          "structure", PhotonStructure::kdtree,
          {{"kdtree", PhotonStructure::kdtree}, {"grid", PhotonStructure::grid}},
          "that photons are kept in")),
      direct_from_map_(params.choice<bool>("direct_light", false,
                                           {{"sampled", false}, {"photons", true}},
                                           "how light that comes straight from a light is found")),
      final_gather_(params.int32("final_gather", 0, {.min = 0, .max = 4096},
                                 "rays that look at the global map from one bounce away, for each "
                                 "camera sample; 0: it is looked at directly")),
      show_(params.choice<Show>("show", Show::radiance,
                                {{"radiance", Show::radiance},
                                 {"photons", Show::photons},
                                 {"caustics", Show::caustics},
                                 {"global", Show::global}},
                                "the picture, the photons as dots, or one map alone")),
      hide_emitters_(params.boolean("hide_emitters", false, "the camera looks through emitters")),
      emitter_samples_(emitter_samples(params)),
      light_sampler_(params.nested_or<LightSampler>("cache", "which lights to sample")) {
    lookup_.count = params.int32("lookup_size", 120, {.min = 0, .max = PhotonLookup::max_count},
                                 "nearest photons of an estimate; 0: all within the radius");
    medium_nearest_ = params.int32("volume_lookup_size", 20, {.min = 0, .max = most_nearest},
                                   "neighbours that the sphere of a photon in a medium holds; 0: "
                                   "all spheres have the largest radius");
    if (lookup_.count == 1) {
        params.error("lookup_size", "one photon gives a radius but no light: use 2 or more");
    }
    lookup_.filter = params.choice<PhotonFilter>("filter", PhotonFilter::cone,
                                                 {{"none", PhotonFilter::none},
                                                  {"cone", PhotonFilter::cone},
                                                  {"gaussian", PhotonFilter::gaussian}},
                                                 "weight of photons over the distance");
    if (direct_from_map_ && final_gather_ > 0) {
        params.error("direct_light",
                     "with final_gather, direct light is always sampled: photons "
                     "are seen from one bounce away");
    }
    params.no_effect("direct_samples", "each camera sample samples the lights once");
    params.no_effect("glossy_samples", "each camera sample follows one glossy direction");
    accept_render_options(params);
    params.no_effect("granularity", "photons are dealt out evenly");
}

/// Emits until there are as many photons as are wanted, in passes whose size follows from the
/// share that was stored so far: the same for any number of threads.
StoredPhotons PhotonMapIntegrator::trace(const RenderJob& job, const PhotonTracer& tracer,
                                         const MapSettings& settings, PhotonKinds kinds) const {
    constexpr double most_emitted_per_stored = 100, most_in_vain = 1 << 20;
    constexpr double first_pass = 1 << 16, largest_pass = 1 << 24;
    const double wanted = static_cast<double>(settings.photons);
    PhotonPass pass{.max_depth = limits_.max_depth - 1,
                    .rr_depth = limits_.rr_depth,
                    .kinds = kinds,
                    .on_surfaces = !settings.in_media,
                    .in_media = settings.in_media};
    StoredPhotons stored;
    const std::vector<Photon>& photons = settings.in_media ? stored.in_media : stored.photons;
    (settings.in_media ? stored.in_media : stored.photons)
        .reserve(static_cast<std::size_t>(1.02 * wanted) + 1024);
    const bool possible = pass.max_depth >= (includes(kinds, PhotonKind::direct) ? 1 : 2);
    for (std::uint64_t i = 0; possible && !tracer.dark() && !job.interrupted(); ++i) {
        const double missing = wanted - static_cast<double>(photons.size());
        const double most = photons.empty() ? most_in_vain : most_emitted_per_stored * wanted;
        const double left = std::max(most, most_in_vain) - stored.emitted;
        if (missing <= 0 || left < 1) break;
        const double yield =
            std::max(static_cast<double>(photons.size()), 1.0) / std::max(stored.emitted, 1.0);
        const double size = i == 0 ? std::min(wanted, first_pass) : 1.01 * missing / yield + 64;
        pass.key = hash64({job.seed(), i, kinds, settings.in_media ? 0x9408u : 0x9407u});
        pass.count = static_cast<std::uint64_t>(std::min({size, left, largest_pass}));
        store_photons(
            tracer, pass, job.workers(), [&] { return job.interrupted(); }, stored);
    }
    if (photons.empty() && stored.emitted > 0 && !job.interrupted()) {
        const char* const what =
            settings.in_media ? "was scattered by a medium" : "met a diffuse surface";
        const char* const where = includes(kinds, PhotonKind::direct) ? ""
                                  : includes(kinds, PhotonKind::indirect)
                                      ? " after another"
                                      : " after a mirror or glass";
        fmt::print(stderr, "warning: photonmap: of {:.0f} photons none {}{}\n", stored.emitted,
                   what, where);
    }
    return stored;
}

/// [m]
float PhotonMapIntegrator::radius(const RenderJob& job, const MapSettings& settings) const {
    const float scene_radius = job.scene().bounds().radius();
    return settings.radius * (scene_radius > 0 ? scene_radius : 1);
}

PhotonMap PhotonMapIntegrator::surface_map(const RenderJob& job, const PhotonTracer& tracer,
                                           const MapSettings& settings, PhotonKinds kinds) const {
    StoredPhotons stored = trace(job, tracer, settings, kinds);
    return PhotonMap(std::move(stored.photons), stored.emitted, structure_, radius(job, settings),
                     job.workers());
}

BeamMap PhotonMapIntegrator::medium_map(const RenderJob& job, const PhotonTracer& tracer,
                                        const MapSettings& settings, PhotonKinds kinds) const {
    StoredPhotons stored = trace(job, tracer, settings, kinds);
    const int nearest = show_ == Show::photons ? 0 : medium_nearest_;
    return BeamMap(std::move(stored.in_media), stored.emitted, radius(job, settings), nearest,
                   job.workers());
}

/// Only maps that will be read, of photons that will be read.
void PhotonMapIntegrator::build_on_surfaces(const RenderJob& job, const PhotonTracer& tracer,
                                            Maps& maps) const {
    if (show_ == Show::photons) {
        maps.global = surface_map(job, tracer, {global_.photons, dot_radius_}, all_kinds);
        return;
    }
    if (show_ != Show::caustics) {
        const bool direct = direct_from_map_ || final_gather_ > 0 || show_ == Show::global;
        const auto kinds = direct ? PhotonKind::direct | PhotonKind::indirect
                                  : static_cast<unsigned>(PhotonKind::indirect);
        maps.global = surface_map(job, tracer, global_, kinds);
    }
    if (show_ != Show::global && has_caustics(job.scene().shapes())) {
        maps.caustic =
            surface_map(job, tracer, caustic_, static_cast<unsigned>(PhotonKind::caustic));
    }
}

/// The same for photons that media scatter. Direct light there is sampled on every ray, on those of
/// final gathering, too.
void PhotonMapIntegrator::build_in_media(const RenderJob& job, const PhotonTracer& tracer,
                                         Maps& maps) const {
    if (show_ == Show::photons) {
        maps.medium = medium_map(job, tracer, {medium_.photons, dot_radius_, true}, all_kinds);
        return;
    }
    if (show_ != Show::caustics) {
        const bool direct = direct_from_map_ || show_ == Show::global;
        const auto kinds = direct ? PhotonKind::direct | PhotonKind::indirect
                                  : static_cast<unsigned>(PhotonKind::indirect);
        maps.medium = medium_map(job, tracer, medium_, kinds);
    }
    if (show_ != Show::global && has_caustics(job.scene().shapes())) {
        maps.medium_caustic =
            medium_map(job, tracer, medium_, static_cast<unsigned>(PhotonKind::caustic));
    }
}

/// Empty if the scene has no media.
std::optional<MediumView> PhotonMapIntegrator::media(const Scene& scene, const Maps& maps) const {
    if (!scene.has_media()) return {};
    const bool picture = show_ == Show::radiance;
    std::optional<MediumView> view(std::in_place, scene, light_sampler_,
                                   MediumView::Settings{.max_depth = limits_.max_depth,
                                                        .lookup = lookup_,
                                                        .emission = picture,
                                                        .direct = picture && !direct_from_map_});
    view->add(maps.medium);
    view->add(maps.medium_caustic);
    return view;
}

Color PhotonMapIntegrator::radiance(const PhotonMap& map, const Interaction& at, Vector3 wo,
                                    int edges) const {
    PhotonLookup lookup = lookup_;
    lookup.max_depth = limits_.max_depth - edges;
    return photon_radiance(map, lookup, *at.shape->bsdf(), at, wo);
}

/// Photons as disks: a white surface under each, with the irradiance that it brings to the disk.
Color PhotonMapIntegrator::dots(const PhotonMap& map, const Interaction& at, Vector3 wo) const {
    if (map.photons().empty()) return Color(0);
    const PhotonReceiver receiver(*at.shape->bsdf(), at, wo);
    float radius2 = sqr(map.radius());
    const float limit2 = radius2;
    Color sum(0);
    map.search(at.p, radius2, [&](const Photon& photon, float d2) {
        if (receiver.distance2(photon, d2) < limit2) sum += photon.power();
    });
    return sum * (map.scale() * sqr(inv_pi) / limit2);
}

/// Takes a path to the end of a segment, through which it is edge number `edges`; returns what
/// comes along it from the medium.
Color cross(const MediumView& media, const MediumSegment& way, int edges, Rng& rng, Color& beta) {
    if (!way.medium) return Color(0);
    const MediumPath path = media.cross(way, beta, edges, rng.next_float2(), rng);
    beta = path.beta;
    return path.radiance;
}

/// Indirect light without caustics, from one bounce away.
Color PhotonMapIntegrator::gather(const Scene& scene, const Maps& maps, const MediumView* media,
                                  const GatherPoint& point, SampleStream& stream) const {
    Color sum(0);
    for (int i = 0; i < final_gather_; ++i) sum += gather_ray(scene, maps, media, point, stream);
    return sum / static_cast<float>(final_gather_);
}

/// A path on which every light is left to the maps and to light sampling. It ends where it meets
/// photons, unless it is so short that their density would smear over the corner it starts in.
Color PhotonMapIntegrator::gather_ray(const Scene& scene, const Maps& maps, const MediumView* media,
                                      const GatherPoint& point, SampleStream& stream) const {
    Color sum(0), beta(1);
    Interaction at = point.at;
    Vector3 wo = point.wo;
    int edges = point.edges;
    const Medium* medium = point.medium;
    bool may_be_smooth = true, may_be_specular = false;
    float distance = 0;  // from the last vertex
    while (edges + 1 < limits_.max_depth) {
        const Vector2 u = stream.next_2d();
        const Vector2 u_lobe_and_roulette = stream.next_2d();
        const std::optional<ScatteredRay> next = scatter(at, wo, u_lobe_and_roulette.x, u);
        if (!next || !(next->sample.specular() ? may_be_specular : may_be_smooth)) break;
        beta *= next->sample.weight;
        const bool straight = next->sample.lobe == Lobe::null;
        if (!straight && ++edges > 8) {
            const float survival = survival_probability(beta, 1);
            if (!(u_lobe_and_roulette.y < survival)) break;
            beta /= survival;
        }
        const std::optional<Interaction> hit = scene.intersect(next->ray);
        if (media) {
            medium = medium_beyond(at, next->ray.d, medium);
            sum += cross(*media, {medium, next->ray.o, next->ray.d, hit ? hit->t : infinity}, edges,
                         *point.rng, beta);
        }
        if (!hit || is_black(beta)) break;
        at = *hit;
        distance = straight ? distance + at.t : at.t;
        wo = -next->ray.d;
        may_be_smooth = may_be_specular = true;
        if (!stores_photons(*at.shape->bsdf())) continue;
        sum += beta * radiance(maps.caustic, at, wo, edges);
        if (distance < maps.global.radius()) {
            LightDistribution lights;
            const GatherPoint there{at, wo, edges, medium, point.rng, lights};
            sum += beta * sample_lights(scene, light_sampler_, 1, there, stream);
        } else {
            sum += beta * radiance(maps.global, at, wo, edges);
            may_be_smooth = false;
        }
    }
    return sum;
}

/// Radiance that leaves a surface that stores photons.
Color PhotonMapIntegrator::seen(const Scene& scene, const Maps& maps, const MediumView* media,
                                const GatherPoint& point, SampleStream& stream) const {
    const Interaction& at = point.at;
    const Vector3 wo = point.wo;
    const int edges = point.edges;
    switch (show_) {
        case Show::photons:
            return dots(maps.global, at, wo);
        case Show::caustics:
            return radiance(maps.caustic, at, wo, edges);
        case Show::global:
            return radiance(maps.global, at, wo, edges);
        case Show::radiance:
            break;
    }
    Color sum = radiance(maps.caustic, at, wo, edges);
    if (!direct_from_map_)
        sum += sample_lights(scene, light_sampler_, emitter_samples_, point, stream);
    return sum + (final_gather_ > 0 ? gather(scene, maps, media, point, stream)
                                    : radiance(maps.global, at, wo, edges));
}

void PhotonMapIntegrator::render(RenderJob& job) const {
    const Scene& scene = job.scene();
    const PhotonTracer tracer(scene);
    Maps maps;
    build_on_surfaces(job, tracer, maps);
    if (has_scattering_media(scene)) build_in_media(job, tracer, maps);
    warn_of_emission(scene, "photonmap");
    if (job.interrupted()) return;
    const std::optional<MediumView> view = media(scene, maps);
    const MediumView* const seen_media = view ? &*view : nullptr;
    const CameraPathTracer walk(scene, light_sampler_,
                                {.max_depth = limits_.max_depth,
                                 .hide_emitters = hide_emitters_,
                                 .lights = show_ == Show::radiance,
                                 .direct_light = !direct_from_map_,
                                 .light_samples = emitter_samples_,
                                 .gather_dimensions = 4 * static_cast<std::uint32_t>(final_gather_),
                                 .media = seen_media});
    job.render_samples([&](const Ray& ray, SampleStream& stream, PixelSample& result) {
        walk(ray, stream, result, [&](const GatherPoint& point) {
            return seen(scene, maps, seen_media, point, stream);
        });
    });
}

}  // namespace

const PluginInfo plugin =
    describe<PhotonMapIntegrator>("photon mapping: caustics and indirect light from photons");

}  // namespace lucerna
