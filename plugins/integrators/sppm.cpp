// SPDX-License-Identifier: Apache-2.0
/// sppm: stochastic progressive photon mapping (Hachisuka and Jensen 2009) with a radius that needs
/// no memory (Knaus and Zwicker 2011, "Progressive Photon Mapping: A Probabilistic Approach").
///
/// Sample i of every pixel looks into its own map of photons, number i, within the radius
///
///     r_i² = r_0² ∏ (j + α) / (j + 1)  for j = 1 … i,
///
/// so variance falls as i^−α and bias as i^(α−1); their sum is least for α = 2/3. Where photons are
/// dense, less will do: the distance of photon number `lookup_size`, but no less than r_i / 6. So
/// bias and variance are more alike in the focus of a caustic and around it. Caustics have a map of
/// their own, since the density of other photons says nothing of them. Photons in media have the
/// radius r_i: the beam estimate blurs in two dimensions, too (Jarosz et al. 2011, "Progressive
/// Photon Beams"; Knaus and Zwicker 2011, 5). Passes know nothing of each other: they can be split
/// over machines, and merged, as samples of any render.
#include "plugins/integrators/photon_camera.h"
#include "plugins/integrators/photon_estimate.h"
#include "plugins/integrators/render_options.h"

namespace lucerna {

namespace {

/// r_i² / r_0², in closed form: Γ(i + 1 + α) / (Γ(1 + α) Γ(i + 2)).
double radius2_factor(std::uint64_t i, double alpha) {
    const double n = static_cast<double>(i);
    return std::exp(std::lgamma(n + 1 + alpha) - std::lgamma(1 + alpha) - std::lgamma(n + 2));
}

class SPPMIntegrator final : public Integrator {
public:
    explicit SPPMIntegrator(const Params& params)
        : limits_(params),
          photons_(params.integer("photon_count", 250000, {.min = 1, .max = 1e9},
                                  "photons that leave the lights in each pass")),
          initial_radius_(params.real("initial_radius", 0, non_negative,
                                      "largest of the first pass [scene units]; 0: about six "
                                      "pixels, four in media")),
          alpha_(params.real("alpha", 2.0 / 3, {.min = 0, .max = 1, .open_min = true},
                             "how slowly the radius shrinks; 1 keeps it")),
          lookup_{
              .count = params.int32("lookup_size", 16, {.min = 0, .max = PhotonLookup::max_count},
                                    "nearest photons of an estimate; 0: all within the radius"),
              .filter = params.choice<PhotonFilter>("filter", PhotonFilter::cone,
                                                    {{"none", PhotonFilter::none},
                                                     {"cone", PhotonFilter::cone},
                                                     {"gaussian", PhotonFilter::gaussian}},
                                                    "weight of photons over the distance")},
          structure_(params.choice<PhotonStructure>(
              "structure", PhotonStructure::grid,
              {{"grid", PhotonStructure::grid}, {"kdtree", PhotonStructure::kdtree}},
              "that photons are kept in")),
          hide_emitters_(
              params.boolean("hide_emitters", false, "the camera looks through emitters")),
          emitter_samples_(emitter_samples(params)),
          light_sampler_(params.nested_or<LightSampler>("cache", "which lights to sample")) {
        if (lookup_.count == 1) {
            params.error("lookup_size", "one photon gives a radius but no light: use 2 or more");
        }
        params.no_effect("max_passes", "the budget of the render is its limit");
        accept_render_options(params);
        params.no_effect("granularity", "photons are dealt out evenly");
    }

    bool renders_media() const override { return true; }
    int light_bounces() const override { return 1; }  // off glossy surfaces
    void render(RenderJob& job) const override;

private:
    struct Maps {
        PhotonMap caustics, indirect;
        BeamMap media;
    };

    /// In the first pass [scene units].
    struct Radii {
        float surfaces, media;
    };

    Maps photons(const RenderJob& job, const PhotonTracer& tracer, const Radii& first,
                 std::uint64_t index) const;
    Color photons_seen(const Maps& maps, const GatherPoint& point) const;
    void sample(RenderJob& job, std::uint64_t index, const Maps& maps) const;
    float first_radius(const RenderJob& job, float pixels, const Bounds3& lit) const;

    PathLimits limits_;
    std::int64_t photons_;
    float initial_radius_, alpha_;
    PhotonLookup lookup_;
    PhotonStructure structure_;
    bool hide_emitters_;
    std::uint32_t emitter_samples_;
    const LightSampler& light_sampler_;
};

/// How wide a pixel is where the camera sees surfaces: the median over a grid of pixels. Empty if
/// it sees none.
std::optional<float> seen_width(const Scene& scene) {
    constexpr int grid = 32;
    const Sensor& sensor = scene.sensor();
    const Vector2 size(sensor.film().size());
    std::vector<float> widths;
    for (int i = 0; i < grid * grid; ++i) {
        const Vector2 pixel = (Vector2(i % grid, i / grid) + 0.5f) / float{grid} * size;
        const Ray ray = sensor.sample_ray(pixel, Vector2(0.5f));
        const Ray beside = sensor.sample_ray(pixel + Vector2(1, 0), Vector2(0.5f));
        const std::optional<Interaction> at = scene.intersect(ray);
        if (at) widths.push_back(glm::length(beside.o + at->t * beside.d - at->p));
    }
    if (widths.empty()) return {};
    const auto middle = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
    std::nth_element(widths.begin(), middle, widths.end());
    return *middle;
}

/// Unless it is given, so many pixels where the camera sees surfaces; but not so small that few
/// photons are found: a disk holds at least two of each pass, if they are spread over a sphere
/// around what is `lit`. Small images have large pixels, but need not show more blur.
float SPPMIntegrator::first_radius(const RenderJob& job, float pixels, const Bounds3& lit) const {
    if (initial_radius_ > 0) return initial_radius_;
    constexpr float fewest_pixels = 128;
    const Vector2i size = job.film().size();
    const auto across = static_cast<float>(std::max(size.x, size.y));
    const float lit_radius = lit.radius();
    const float least = (lit_radius > 0 ? lit_radius : 1) *
                        std::sqrt(8 / std::max(static_cast<float>(photons_), 32.0f));
    const float seen = seen_width(job.scene()).value_or(0);
    return std::max(pixels * seen * std::min(across / fewest_pixels, 1.0f), least);
}

/// The maps of pass `index`, of all that light sampling does not find.
SPPMIntegrator::Maps SPPMIntegrator::photons(const RenderJob& job, const PhotonTracer& tracer,
                                             const Radii& first, std::uint64_t index) const {
    const PhotonPass pass{.key = hash64({job.seed(), index, 0x5bb3}),
                          .count = static_cast<std::uint64_t>(photons_),
                          .max_depth = limits_.max_depth - 1,
                          .rr_depth = limits_.rr_depth,
                          .kinds = PhotonKind::caustic | PhotonKind::indirect,
                          .in_media = has_scattering_media(job.scene()),
                          .caustics_apart = true};
    StoredPhotons stored;
    if (!tracer.dark()) {
        store_photons(
            tracer, pass, job.workers(), [&] { return job.interrupted(); }, stored);
    }
    const auto shrink =
        static_cast<float>(std::sqrt(radius2_factor(index, static_cast<double>(alpha_))));
    const auto map = [&](std::vector<Photon>& photons) {
        return PhotonMap(std::move(photons), stored.emitted, structure_, shrink * first.surfaces,
                         job.workers());
    };
    return {map(stored.caustics), map(stored.photons),
            BeamMap(std::move(stored.in_media), stored.emitted, shrink * first.media, 0,
                    job.workers())};
}

Color SPPMIntegrator::photons_seen(const Maps& maps, const GatherPoint& point) const {
    constexpr float least_radius = 1.0f / 6;
    PhotonLookup lookup = lookup_;
    lookup.least_radius = least_radius * maps.caustics.radius();
    lookup.max_depth = limits_.max_depth - point.edges;
    const BSDF& bsdf = *point.at.shape->bsdf();
    return photon_radiance(maps.caustics, lookup, bsdf, point.at, point.wo) +
           photon_radiance(maps.indirect, lookup, bsdf, point.at, point.wo);
}

/// Sample `index` of every pixel.
void SPPMIntegrator::sample(RenderJob& job, std::uint64_t index, const Maps& maps) const {
    const Scene& scene = job.scene();
    std::optional<MediumView> media;
    if (scene.has_media()) {
        media.emplace(scene, light_sampler_,
                      MediumView::Settings{.max_depth = limits_.max_depth, .lookup = lookup_});
        media->add(maps.media);
    }
    const CameraPathTracer walk(scene, light_sampler_,
                                {.max_depth = limits_.max_depth,
                                 .hide_emitters = hide_emitters_,
                                 .light_samples = emitter_samples_,
                                 .media = media ? &*media : nullptr});
    job.sample_pixels(
        {index, index + 1}, [&](const Ray& ray, SampleStream& stream, PixelSample& result) {
            walk(ray, stream, result, [&](const GatherPoint& point) {
                return photons_seen(maps, point) +
                       sample_lights(scene, light_sampler_, emitter_samples_, point, stream);
            });
        });
}

void SPPMIntegrator::render(RenderJob& job) const {
    const PhotonTracer tracer(job.scene());
    const Radii radii{.surfaces = first_radius(job, 6, job.scene().bounds()),
                      .media = first_radius(job, 4, media_bounds(job.scene()))};
    warn_of_emission(job.scene(), "sppm");
    job.run_passes([&](SampleRange range) {
        for (std::uint64_t i = range.begin; i < range.end && !job.interrupted(); ++i) {
            const Maps maps = photons(job, tracer, radii, i);
            if (job.interrupted()) return;
            sample(job, i, maps);
        }
    });
}

}  // namespace

const PluginInfo plugin =
    describe<SPPMIntegrator>("progressive photon mapping: consistent, in constant memory");

}  // namespace lucerna
