// SPDX-License-Identifier: Apache-2.0
/// ptracer: light tracing. Particles from the lights are connected to the camera wherever they
/// meet a surface (Arvo 1986; Dutré, Lafortune and Willems 1993).
///
/// Unbiased, and good at caustics: the check on photon mapping. It cannot find what is seen in a
/// mirror or through glass; those surfaces are black. Lights themselves are seen by camera rays.
/// Sample i of all pixels is one pass of as many particles as the whole image has pixels: with a
/// crop window, too, which is then exactly a part of it.
#include "plugins/integrators/photon_camera.h"
#include "plugins/integrators/render_options.h"

#include "core/render/render_job.h"

#include <span>

namespace lucerna {

namespace {

struct Splat {
    Vector2 position;  ///< on the whole film [pixels]
    Color value;
};

/// An image that is made of splats. Rows are dealt out in bands, so that each pixel sums in the
/// order of the particles whatever the number of threads.
class SplatImage {
public:
    using Bands = std::vector<std::vector<Splat>>;

    SplatImage(const RFilter& filter, const CropWindow& window)
        : filter_(filter), offset_(window.offset), size_(window.size) {
        constexpr int steps = 4096;
        double integral = 0;
        for (int i = 0; i < steps; ++i) {
            const double x = (2 * (i + 0.5) / steps - 1) * static_cast<double>(filter_.radius());
            integral += static_cast<double>(filter_.evaluate(static_cast<float>(x)));
        }
        integral *= 2 * static_cast<double>(filter_.radius()) / steps;
        normalization_ = static_cast<float>(1 / sqr(integral));
        pixels_.resize(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y));
    }

    Bands empty_bands() const {
        return Bands(static_cast<std::size_t>((size_.y + band_rows - 1) / band_rows));
    }

    void add(Bands& bands, const Splat& splat) const {
        const Vector2 p = splat.position - Vector2(offset_);
        const float reach = filter_.radius() + 1;
        if (!(p.x > -reach && p.x < static_cast<float>(size_.x) + reach)) return;
        if (!(p.y > -reach && p.y < static_cast<float>(size_.y) + reach)) return;
        const int first = std::max(static_cast<int>(p.y - reach), 0) / band_rows;
        const int last = std::min(static_cast<int>(p.y + reach), size_.y - 1) / band_rows;
        for (int band = first; band <= last; ++band) {
            bands[static_cast<std::size_t>(band)].push_back(splat);
        }
    }

    /// Replaces the image by the splats of all chunks, times `scale`.
    void draw(std::span<const Bands> chunks, float scale, const Workers& workers) {
        const auto bands = static_cast<std::int64_t>(empty_bands().size());
        workers.run(bands, [&](std::int64_t b) {
            const int first = static_cast<int>(b) * band_rows;
            const int end = std::min(first + band_rows, size_.y);
            std::fill(row(first), row(end), Color(0));
            for (const Bands& chunk : chunks) {
                for (const Splat& splat : chunk[static_cast<std::size_t>(b)]) {
                    draw(splat, scale * normalization_, first, end);
                }
            }
        });
    }

    Color operator[](std::size_t pixel) const { return pixels_[pixel]; }

private:
    static constexpr int band_rows = 16;

    std::vector<Color>::iterator row(int y) {
        return pixels_.begin() + std::ptrdiff_t{y} * size_.x;
    }

    void draw(const Splat& splat, float scale, int first, int end) {
        const float radius = filter_.radius();
        const auto from = [&](float x) { return static_cast<int>(std::floor(x - radius)); };
        const auto to = [&](float x) { return static_cast<int>(std::ceil(x + radius)); };
        const Vector2 p = splat.position;
        first += offset_.y;
        end += offset_.y;
        const int left = offset_.x, right = offset_.x + size_.x;
        for (int y = std::max(from(p.y), first); y < std::min(to(p.y), end); ++y) {
            const float wy = filter_.evaluate(static_cast<float>(y) + 0.5f - p.y);
            if (wy == 0) continue;
            for (int x = std::max(from(p.x), left); x < std::min(to(p.x), right); ++x) {
                const float wx = filter_.evaluate(static_cast<float>(x) + 0.5f - p.x);
                row(y - offset_.y)[x - offset_.x] += splat.value * (wx * wy * scale);
            }
        }
    }

    const RFilter& filter_;
    Vector2i offset_, size_;
    float normalization_ = 1;
    std::vector<Color> pixels_;
};

class ParticleTracer final : public Integrator {
public:
    explicit ParticleTracer(const Params& params)
        : limits_(params),
          hide_emitters_(
              params.boolean("hide_emitters", false, "the camera looks through emitters")) {
        params.no_effect("granularity", "particles are dealt out evenly");
        accept_render_options(params);
    }

    void render(RenderJob& job) const override;
    bool unfiltered() const override { return true; }

private:
    void trace(const RenderJob& job, const PhotonTracer& tracer, std::uint64_t first,
               std::span<SplatImage> images) const;
    void connect(const Scene& scene, const PhotonHit& hit, Vector2 u_lens, const SplatImage& image,
                 SplatImage::Bands& bands) const;
    void see_lights(const Scene& scene, const Ray& ray, PixelSample& result) const;

    PathLimits limits_;
    bool hide_emitters_;
};

/// The flux that arrives, reflected towards the camera. The cosines of shading and geometric
/// normal belong to the adjoint BSDF (Veach 1997, 5.3.2).
void ParticleTracer::connect(const Scene& scene, const PhotonHit& hit, Vector2 u_lens,
                             const SplatImage& image, SplatImage::Bands& bands) const {
    const Interaction& at = hit.at;
    const BSDF& bsdf = *at.shape->bsdf();
    if (!any(bsdf.lobes() & smooth_lobes) || (hide_emitters_ && at.shape->emitter())) return;
    const std::optional<SensorConnection> seen = scene.sensor().connect(at.p, u_lens);
    if (!seen) return;
    const Vector3 wo = at.to_local(hit.w), wi = at.to_local(seen->wi);
    const float wo_n = glm::dot(hit.w, at.n), wi_n = glm::dot(seen->wi, at.n);
    if (!(wo_n * wo.z > 0 && wi_n * wi.z > 0)) return;
    const Color f = bsdf.evaluate(at, wo, wi, TransportMode::importance).f;
    if (is_black(f)) return;
    Ray ray = at.spawn_ray(seen->wi);
    ray.tmax = seen->distance;
    const Color arriving = scene.transmittance(ray, hide_emitters_);
    if (is_black(arriving)) return;
    image.add(bands, {seen->position, hit.power * f * arriving *
                                          ((wo.z / wo_n) * std::abs(wi_n) * seen->importance)});
}

std::uint64_t particles_of_pass(const RenderJob& job) {
    const Vector2i film = job.state().layout().full_size;
    return static_cast<std::uint64_t>(film.x) * static_cast<std::uint64_t>(film.y);
}

constexpr std::uint64_t chunk_size = 2048;  // particles that one thread traces

/// Makes the image of each pass from number `first` on.
void ParticleTracer::trace(const RenderJob& job, const PhotonTracer& tracer, std::uint64_t first,
                           std::span<SplatImage> images) const {
    const std::uint64_t count = particles_of_pass(job);
    const std::uint64_t chunks_of_pass = (count + chunk_size - 1) / chunk_size;
    std::vector<SplatImage::Bands> chunks(images.size() * chunks_of_pass, images[0].empty_bands());
    job.workers().run(std::ssize(chunks), [&](std::int64_t number) {
        if (job.interrupted() || tracer.dark()) return;
        const auto chunk = static_cast<std::uint64_t>(number);
        const PhotonPass pass{.key = hash64({job.seed(), first + chunk / chunks_of_pass, 0x97ac}),
                              .count = count,
                              .max_depth = limits_.max_depth - 1,
                              .rr_depth = limits_.rr_depth,
                              .kinds = ~0u};
        const SplatImage& image = images[chunk / chunks_of_pass];
        SplatImage::Bands& bands = chunks[chunk];
        PhotonEnergy energy;
        const std::uint64_t begin = chunk % chunks_of_pass * chunk_size;
        const std::uint64_t end = std::min(begin + chunk_size, pass.count);
        tracer.trace(pass, begin, end, energy, [&](const PhotonHit& hit) {
            const std::uint64_t lens = hash64({pass.key, static_cast<std::uint64_t>(hit.depth)});
            connect(job.scene(), hit, sobol_owen_2d(hit.photon, lens), image, bands);
        });
    });
    for (std::size_t i = 0; i < images.size(); ++i) {
        images[i].draw({&chunks[i * chunks_of_pass], chunks_of_pass}, 1 / static_cast<float>(count),
                       job.workers());
    }
}

void ParticleTracer::see_lights(const Scene& scene, const Ray& ray, PixelSample& result) const {
    Color beta(1);
    std::optional<Interaction> at = scene.intersect(ray);
    for (; at && !is_black(beta); at = scene.intersect(at->spawn_ray(ray.d))) {
        const Emitter* const emitter = at->shape->emitter();
        if (emitter && hide_emitters_) continue;
        if (emitter) result.radiance += beta * emitter->radiance(*at, -ray.d);
        beta *= straight_transmittance(*at, -ray.d);
    }
    if (at || is_black(beta)) return;
    if (!hide_emitters_) result.radiance += beta * scene.environment(ray.d);
    const bool sky = !hide_emitters_ && !scene.infinite_lights().empty();
    result.alpha = sky ? 1.0f : 1 - luminance(beta);
}

void ParticleTracer::render(RenderJob& job) const {
    const PhotonTracer tracer(job.scene());
    // Passes of small images are traced together, so that there is work for all threads.
    constexpr std::uint64_t enough_particles = 16 * chunk_size;
    const std::uint64_t together =
        std::max<std::uint64_t>(enough_particles / particles_of_pass(job), 1);
    std::vector<SplatImage> images(
        std::min<std::uint64_t>(together, 64),
        SplatImage(job.film().rfilter(), job.state().layout().sampled()));
    job.run_passes([&](SampleRange range) {
        for (std::uint64_t first = range.begin; first < range.end; first += images.size()) {
            const std::uint64_t count = std::min<std::uint64_t>(images.size(), range.end - first);
            trace(job, tracer, first, {images.data(), count});
            for (std::uint64_t i = 0; i < count; ++i) {
                if (job.interrupted()) return;
                const SplatImage& image = images[i];
                job.sample_pixels({first + i, first + i + 1},
                                  [&](const Ray& ray, SampleStream&, PixelSample& result) {
                                      see_lights(job.scene(), ray, result);
                                      result.unfiltered = image[result.pixel];
                                  });
            }
        }
    });
}

}  // namespace

const PluginInfo plugin = describe<ParticleTracer>("light tracing: particles splatted on the film");

}  // namespace lucerna
