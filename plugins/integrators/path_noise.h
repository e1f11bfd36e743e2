// SPDX-License-Identifier: Apache-2.0
/// How many light samples a path takes at its first vertex, how many pixels share their paths, and
/// whether light samples follow specular chains: what a few paths show to be most efficient.
///
/// With n light samples and blocks of m pixels, the variance and the time of a sample are about
///
///     V = V_own − V_light + V_light / n + V_shared m^−0.6
///     T = T_path + (n − 1) T_light + T_keep + ⌈m / 16⌉ T_join             (T_path alone if m = 1)
///
/// V_own is that of all light that is not shared, V_light its part from the choice of points on
/// lights at the first vertex. Shared light gains less than m^−1, as the paths of a block have more
/// in common than their second vertices: the exponent fits Cornell boxes, rooms and halls. Time is
/// counted in rays, so that the choice does not depend on the machine. What chains change in V and
/// T_path is only measured.
#pragma once

#include "core/base/parallel.h"
#include "core/math/sequences.h"
#include "core/scene/ray_statistics.h"
#include "plugins/integrators/path_reuse.h"
#include "plugins/integrators/specular_chain.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lucerna {

/// Variances of one path relative to the squared mean of its pixel, and its time.
struct PathNoise {
    double own = 0, light = 0, shared = 0;
    double rays = 0;  ///< that a path takes

    /// Variance times time.
    double inefficiency(int light_samples, int block_size) const {
        // Shading included; a path is joined to sixteen pixels at a time.
        constexpr double light_rays = 1.5, keep_rays = 1.3, join_rays = 1.8;
        const double pixels = sqr(static_cast<double>(block_size));
        const double variance =
            std::max(own - light, 0.0) + light / light_samples + shared * std::pow(pixels, -0.6);
        const double groups = std::ceil(pixels / static_cast<double>(lane_count));
        const double sharing = block_size > 1 ? keep_rays + groups * join_rays : 0.0;
        const double time = rays + (light_samples - 1) * light_rays + sharing;
        return variance * time;
    }
};

struct PathSplitting {
    int light_samples = 1;  ///< at the first vertex
    int block_size = 1;     ///< pixels along each side
    int chain = 0;          ///< longest specular chain that light samples follow (specular_chain.h)
};

/// The most efficient combination for one length of chains; numbers of `given` that are not 0 stay.
inline PathSplitting best_splitting(const PathNoise& noise, PathSplitting given) {
    PathSplitting best{.light_samples = 1, .block_size = 1, .chain = given.chain};
    double least = std::numeric_limits<double>::infinity();
    for (const int light_samples : {1, 2, 4, 8}) {
        for (const int block_size : {1, 4, 8}) {
            const PathSplitting tried{
                .light_samples = given.light_samples ? given.light_samples : light_samples,
                .block_size = given.block_size ? given.block_size : block_size,
                .chain = given.chain};
            const double value = noise.inefficiency(tried.light_samples, tried.block_size);
            if (!(value < least)) continue;
            least = value;
            best = tried;
        }
    }
    return best;
}

/// Traces paths through some pixels of the whole image, since a crop is to be a part of it.
class PathNoiseMeter {
public:
    explicit PathNoiseMeter(const Scene& scene) : scene_(scene) {}

    /// `trace(samples, kept, splitting)` fills the samples with what is not shared. What is given
    /// is not varied: light samples and a block above 0, a chain of 0 or more.
    template <typename Trace>
    PathSplitting find_best(PathSplitting given, Trace&& trace) const {
        // Very many tell no more of the rest than a few.
        PathSplitting one{.light_samples = std::clamp(given.light_samples, 1, 8),
                          .chain = std::max(given.chain, 0)};
        PathNoise noise = measure(one, trace);
        if (given.chain < 0) {
            one.chain = usual_chain;
            const PathNoise other = measure(one, trace);
            const bool pays = other.inefficiency(1, 1) < noise.inefficiency(1, 1);
            if (pays) noise = other;
            given.chain = one.chain = pays ? usual_chain : 0;
        }
        if (given.light_samples == 0) {
            constexpr int several = 4;
            const PathNoise other =
                measure({.light_samples = several, .chain = given.chain}, trace);
            noise.light = std::clamp((noise.own - other.own) / (1 - 1.0 / several), 0.0, noise.own);
        }
        return best_splitting(noise, given);
    }

    /// The noise for one splitting.
    template <typename Trace>
    PathNoise measure(const PathSplitting& splitting, Trace&& trace) const {
        return measure(splitting, trace, true);
    }
    /// The same for paths that are not to be shared.
    template <typename Trace>
    PathNoise measure_alone(const PathSplitting& splitting, Trace&& trace) const {
        return measure(splitting, trace, false);
    }

private:
    template <typename Trace>
    PathNoise measure(const PathSplitting& splitting, Trace&& trace, bool keeps) const;

    static constexpr std::uint32_t pixel_count = 256;
    static constexpr std::uint32_t sample_count = 8;  ///< of a sequence: they may be stratified

    /// Sums of one sequence of samples.
    struct Sums {
        double own = 0, shared = 0;
    };
    /// Two sequences in one pixel.
    struct Pixel {
        Sums first, second;
        std::uint64_t rays = 0;
    };

    std::vector<CameraSample> camera_samples(std::uint32_t pixel, std::uint32_t sequence) const;
    static PathNoise summary(std::span<const Pixel> pixels);

    const Scene& scene_;
};

inline std::vector<CameraSample> PathNoiseMeter::camera_samples(std::uint32_t pixel,
                                                                std::uint32_t sequence) const {
    const Sensor& sensor = scene_.sensor();
    const Vector2 size(sensor.film().size());
    const Vector2 corner = glm::min(glm::floor(sobol_owen_2d(pixel, 0) * size), size - 1.0f);
    std::vector<CameraSample> samples;
    for (std::uint32_t i = 0; i < sample_count; ++i) {
        CameraSample& sample =
            samples.emplace_back(sensor.sampler(), hash64({pixel, sequence}), std::uint64_t{i});
        const Vector2 u = sample.stream.next_2d();
        sample.ray = sensor.sample_ray(corner + u, sample.stream.next_2d());
    }
    return samples;
}

template <typename Trace>
PathNoise PathNoiseMeter::measure(const PathSplitting& splitting, Trace&& trace, bool keeps) const {
    std::vector<Pixel> pixels(pixel_count);
    const auto sums = [&](std::uint32_t pixel, std::uint32_t sequence) {
        std::vector<CameraSample> samples = camera_samples(pixel, sequence);
        std::vector<ReusablePath> kept(keeps ? samples.size() : 0);
        trace(std::span(samples), std::span(kept), splitting);
        const auto sum = [&] {
            double total = 0;
            for (const CameraSample& s : samples) {
                total += static_cast<double>(luminance(s.result.radiance));
            }
            return total;
        };
        const double own = sum();
        for (const ReusablePath& path : kept) add_alone(path);
        return Sums{.own = own, .shared = sum() - own};
    };
    Workers(scene_.threads()).run(pixel_count, [&](std::int64_t i) {
        Pixel& pixel = pixels[static_cast<std::size_t>(i)];
        const std::uint64_t before = thread_ray_statistics().rays();
        pixel.first = sums(static_cast<std::uint32_t>(i), 0);
        pixel.second = sums(static_cast<std::uint32_t>(i), 1);
        pixel.rays = thread_ray_statistics().rays() - before;
    });
    return summary(pixels);
}

/// Without the hundredth of the pixels that has the most noise: rare events are no measure.
inline PathNoise PathNoiseMeter::summary(std::span<const Pixel> pixels) {
    double mean = 0;
    const auto total = [](const Pixel& p) {
        return p.first.own + p.first.shared + p.second.own + p.second.shared;
    };
    for (const Pixel& pixel : pixels) mean += total(pixel) / pixel_count;
    std::vector<PathNoise> all;
    for (const Pixel& pixel : pixels) {
        // In units of the squared mean of the pixel, or of a tenth of the image's.
        const double square = 0.25 * (sqr(total(pixel)) + 0.01 * sqr(mean)) / sample_count;
        if (!(square > 0)) continue;
        all.push_back({.own = 0.5 * sqr(pixel.first.own - pixel.second.own) / square,
                       .shared = 0.5 * sqr(pixel.first.shared - pixel.second.shared) / square,
                       .rays = static_cast<double>(pixel.rays) / (2 * sample_count)});
    }
    std::sort(all.begin(), all.end(), [](const PathNoise& a, const PathNoise& b) {
        return a.own + a.shared < b.own + b.shared;
    });
    all.resize(all.size() - all.size() / 100);
    PathNoise result;
    for (const PathNoise& noise : all) {
        const auto count = static_cast<double>(all.size());
        result.own += noise.own / count;
        result.shared += noise.shared / count;
        result.rays += noise.rays / count;
    }
    return result;
}

}  // namespace lucerna
