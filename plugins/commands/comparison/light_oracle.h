// SPDX-License-Identifier: Apache-2.0
/// How much noise the choice of a light makes at single points of a scene, by asking all lights.
///
/// Let f be the estimate that one sample on light l gives of its light towards the viewer (BSDF,
/// radiance, cosine, visibility, over the density of the sample; as luminance), m₁(l) = E f,
/// m₂(l) = E f², and c = Σ m₁. A sampler that draws l with probability P(l) has the variance
///
///     Var(P) = Σ m₂(l) / P(l) − c²
///     the bound, at P ∝ √m₂:  (Σ √m₂)² − c²            (by the inequality of Cauchy and Schwarz)
///
/// so that one evaluation of all lights judges every sampler that tells its probabilities. What
/// remains at the bound is the noise of the samples on the lights. `unoccluded` is P ∝ √m₂ where m₂
/// knows no shadows: the best that looks at geometry alone. Samplers that draw k lights are judged
/// by one draw: P is the expected number of times that a light is drawn, over k.
///
/// The m are estimated from two independent, stratified halves A and B of samples; c² is c_A c_B,
/// without bias. In scenes of very many lights only some of them, with probabilities q in
/// proportion to √m₂ without shadows, are tested for shadows, and count 1 / q times (Horvitz and
/// Thompson 1952); where a sum is squared, what that adds, Σ (1 / q − 1) x² / q, is taken away.
#pragma once

#include "core/base/parallel.h"
#include "core/interfaces/light_sampler.h"
#include "core/interfaces/sensor.h"
#include "core/math/sequences.h"
#include "core/scene/scatter.h"
#include "core/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lucerna {

struct OracleOptions {
    std::uint32_t points = 200;    ///< of each kind
    std::uint32_t samples = 4;     ///< on each light; even
    std::uint32_t tested = 16384;  ///< expected number of lights tested for shadows, at most
    std::uint64_t seed = 0;

    /// Fewer points and samples where there are so many lights that the work would not end soon.
    static OracleOptions for_lights(std::size_t lights, std::uint32_t points) {
        constexpr double most_samples = 1e8;  // on lights, shadows not counted
        OracleOptions options{.points = points};
        if (static_cast<double>(lights) * points * options.samples > most_samples) {
            options.samples = 2;
        }
        const double affordable =
            most_samples /
            (static_cast<double>(std::max<std::size_t>(lights, 1)) * options.samples);
        options.points = std::clamp(static_cast<std::uint32_t>(std::min(affordable, 1e6)),
                                    std::min(points, 16u), points);
        return options;
    }
};

/// A point at which lights are sampled, and from where it is seen.
struct OraclePoint {
    Interaction at;
    Vector3 wo;  ///< world
    Receiver receiver() const { return at.receiver(wo, at.shape->bsdf()->sides()); }
};

/// The first point of a path from the camera, after `bounces` that were not specular, at which
/// lights are sampled.
inline std::optional<OraclePoint> oracle_point(const Scene& scene, int bounces, Rng& rng) {
    constexpr int longest = 32;
    const CropWindow crop = scene.sensor().film().crop();
    const Vector2 place = rng.next_float2();
    const Vector2 u_lens = rng.next_float2();
    Ray ray = scene.sensor().sample_ray(Vector2(crop.offset) + place * Vector2(crop.size), u_lens);
    for (int edge = 0; edge < longest; ++edge) {
        const std::optional<Interaction> at = scene.intersect(ray);
        if (!at) return {};
        const Vector3 wo = -ray.d;
        const BSDF& bsdf = *at->shape->bsdf();
        if (bounces == 0 && any(bsdf.lobes() & smooth_lobes)) return OraclePoint{*at, wo};
        const float u_lobe = rng.next_float();
        const Vector2 u = rng.next_float2();
        const std::optional<ScatteredRay> next = scatter(*at, wo, u_lobe, u);
        if (!next) return {};
        if (!next->sample.specular()) --bounces;
        if (bounces < 0) return {};
        ray = next->ray;
    }
    return {};
}

/// Up to `count` of them; fewer if paths rarely get so far.
inline std::vector<OraclePoint> oracle_points(const Scene& scene, int bounces, std::uint32_t count,
                                              std::uint64_t seed) {
    std::vector<OraclePoint> points;
    constexpr std::uint64_t attempts = 64;  // for each point
    for (std::uint64_t i = 0; i < attempts * count && points.size() < count; ++i) {
        Rng rng(hash64({seed, static_cast<std::uint64_t>(bounces)}), i);
        if (auto point = oracle_point(scene, bounces, rng)) points.push_back(std::move(*point));
    }
    return points;
}

/// What all lights do at one point.
struct LightMoments {
    struct Entry {
        std::uint32_t light;
        double first, second;  ///< m₁ and m₂
        double weight;         ///< 1 / q
    };
    Receiver at{};
    std::vector<Entry> entries{};  ///< of the lights that reach the point
    double sum = 0;                ///< c
    double square = 0;             ///< c²
    double bound = 0;              ///< least variance
    double unoccluded = 0;         ///< variance of the choice that knows no shadows

    /// Variance of a choice with these probabilities, called for the entries' lights. Lights of
    /// probability zero are left out: their share of c is `lost`.
    template <typename Probability>
    double variance(const Probability& probability, double& lost) const {
        double total = 0, missing = 0;
        for (const Entry& e : entries) {
            const double p = probability(e.light);
            (p > 0 ? total : missing) += p > 0 ? e.weight * e.second / p : e.weight * e.first;
        }
        lost = sum > 0 ? missing / sum : 0;
        return total - square;
    }
};

class LightOracle {
public:
    LightOracle(const Scene& scene, const OracleOptions& options)
        : scene_(scene), options_(options) {}

    LightMoments evaluate(const OraclePoint& point, std::uint64_t index) const {
        LightMoments result{.at = point.receiver()};
        std::vector<std::pair<std::uint32_t, double>> reaching;  // light, √m₂ without shadows
        double total = 0;
        for (std::uint32_t i = 0; i < scene_.lights().size(); ++i) {
            const Sampled sampled = sample(point, result.at, i, index, false);
            if (!(sampled.second > 0)) continue;
            reaching.emplace_back(i, std::sqrt(sampled.second));
            total += reaching.back().second;
        }
        Sums sums;
        Rng choice(hash64({options_.seed, index, 1}));
        const bool all = reaching.size() <= options_.tested;
        for (const auto& [light, root] : reaching) {
            const double q = all ? 1 : std::min(1.0, options_.tested * root / total);
            if (q < 1 && choice.next_double() >= q) continue;
            const Sampled seen = sample(point, result.at, light, index, true);
            if (!(seen.second > 0)) continue;
            sums.add(seen, 1 / q, root / total);
            result.entries.push_back({light, 0.5 * (seen.a + seen.b), seen.second, 1 / q});
        }
        result.sum = 0.5 * (sums.a + sums.b);
        result.square = sums.a * sums.b - sums.extra_square;
        result.bound = std::max(0.0, sums.root * sums.root - sums.extra_root - result.square);
        result.unoccluded = std::max(0.0, sums.unoccluded - result.square);
        return result;
    }

private:
    /// Mean of f in both halves of the samples on a light, and of f² in all of them.
    struct Sampled {
        double a = 0, b = 0, second = 0;
    };
    struct Sums {
        double a = 0, b = 0, root = 0, unoccluded = 0, extra_square = 0, extra_root = 0;

        void add(const Sampled& seen, double weight, double unoccluded_probability) {
            a += weight * seen.a;
            b += weight * seen.b;
            root += weight * std::sqrt(seen.second);
            unoccluded += weight * seen.second / unoccluded_probability;
            extra_square += weight * (weight - 1) * seen.a * seen.b;
            extra_root += weight * (weight - 1) * seen.second;
        }
    };

    Sampled sample(const OraclePoint& point, const Receiver& from, std::uint32_t light,
                   std::uint64_t index, bool shadows) const {
        Rng rng(hash64({options_.seed, index}), light);
        const std::uint32_t half = options_.samples / 2;
        Sampled result;
        for (std::uint32_t k = 0; k < 2 * half; ++k) {
            Vector2 u = rng.next_float2();
            u.x = std::min((static_cast<float>(k % half) + u.x) / static_cast<float>(half),
                           one_minus_epsilon);
            const double f = estimate(point, from, scene_.lights()[light], u, shadows);
            (k < half ? result.a : result.b) += f / half;
            result.second += f * f / (2 * half);
        }
        return result;
    }

    double estimate(const OraclePoint& point, const Receiver& from, const Light& light, Vector2 u,
                    bool shadows) const {
        const std::optional<LightSample> to = light.emitter->sample_li(light, from, u);
        if (!to || !(to->pdf > 0) || is_black(to->radiance)) return 0;
        const Interaction& at = point.at;
        const Vector3 wi = at.to_local(to->wi);
        const Vector3 wo = at.to_local(point.wo);
        if (!same_side(at, point.wo, wo) || !same_side(at, to->wi, wi)) return 0;
        const Color f = at.shape->bsdf()->evaluate(at, wo, wi, TransportMode::radiance).f;
        const double value =
            static_cast<double>(luminance(f * to->radiance)) * std::abs(double(wi.z)) / to->pdf;
        if (!(value > 0) || !std::isfinite(value)) return 0;
        if (!shadows) return value;
        return value * static_cast<double>(luminance(scene_.transmittance(from, *to)));
    }

    const Scene& scene_;
    OracleOptions options_;
};

inline std::vector<LightMoments> evaluate_all(const Scene& scene, const OracleOptions& options,
                                              const std::vector<OraclePoint>& points) {
    std::vector<LightMoments> moments(points.size());
    const LightOracle oracle(scene, options);
    Workers().run(static_cast<std::int64_t>(points.size()), [&](std::int64_t i) {
        const auto k = static_cast<std::size_t>(i);
        moments[k] = oracle.evaluate(points[k], k);
    });
    return moments;
}

/// How relative variances are spread over the points: means are ruled by a few of them.
struct OracleFigures {
    double mean = 0;                            ///< of values cut at `cut`
    double median = 0, upper = 0, largest = 0;  ///< upper: nine tenths are below
    std::uint32_t blind = 0;  ///< points at which a light that contributes is never drawn
    double lost = 0;          ///< share of all light that is therefore missing

    static constexpr double cut = 1e4;
};

/// The points of one kind. Points that no light reaches are counted and left out.
class OracleKind {
public:
    explicit OracleKind(std::vector<LightMoments> all) : moments_(std::move(all)) {
        const std::size_t count = moments_.size();
        std::erase_if(moments_, [](const LightMoments& m) { return m.entries.empty(); });
        dark_ = static_cast<std::uint32_t>(count - moments_.size());
        for (const LightMoments& m : moments_) {
            mean_ += m.sum / static_cast<double>(moments_.size());
        }
    }

    const std::vector<LightMoments>& moments() const { return moments_; }
    std::uint32_t dark() const { return dark_; }
    OracleFigures bound() const {
        return figures([](const LightMoments& m, double&) { return m.bound; });
    }
    OracleFigures unoccluded() const {
        return figures([](const LightMoments& m, double&) { return m.unoccluded; });
    }
    OracleFigures judge(const LightSampler& sampler) const {
        const double draws = std::max(1u, sampler.draws());
        return figures([&](const LightMoments& m, double& lost) {
            return m.variance(
                [&](std::uint32_t light) {
                    return static_cast<double>(sampler.pmf(m.at, light)) / draws;
                },
                lost);
        });
    }

private:
    /// Mean of variance(moments, lost) over c² + (0.05 c̄)²: nearly dark points count for little.
    template <typename Variance>
    OracleFigures figures(const Variance& variance) const {
        OracleFigures result;
        if (moments_.empty()) return result;
        std::vector<double> values;
        double missing = 0, all = 0;
        for (const LightMoments& m : moments_) {
            double lost = 0;
            const double v = variance(m, lost);
            const double scale = m.sum * m.sum + 0.0025 * mean_ * mean_;
            values.push_back(std::max(0.0, v) / scale);
            result.blind += lost > 0 ? 1 : 0;
            missing += lost * m.sum;
            all += m.sum;
        }
        result.lost = missing / all;
        std::sort(values.begin(), values.end());
        for (const double v : values) {
            result.mean += std::min(v, OracleFigures::cut) / static_cast<double>(values.size());
        }
        result.median = values[values.size() / 2];
        result.upper = values[values.size() * 9 / 10];
        result.largest = values.back();
        return result;
    }

    std::vector<LightMoments> moments_;
    std::uint32_t dark_ = 0;
    double mean_ = 0;  ///< c̄
};

}  // namespace lucerna
