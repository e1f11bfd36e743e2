// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/compare/light_oracle.h"

#include "core/base/parallel.h"
#include "core/scene/scatter.h"

#include <algorithm>
#include <limits>
#include <unordered_map>

namespace lucerna {

OracleOptions OracleOptions::for_lights(std::size_t lights, std::uint32_t points) {
    constexpr double most_samples = 1e8;  // on lights, shadows not counted
    OracleOptions options{.points = points};
    if (static_cast<double>(lights) * points * options.samples > most_samples) {
        options.samples = 2;
    }
    const double affordable =
        most_samples / (static_cast<double>(std::max<std::size_t>(lights, 1)) * options.samples);
    options.points = std::clamp(static_cast<std::uint32_t>(std::min(affordable, 1e6)),
                                std::min(points, 16u), points);
    return options;
}

namespace {

/// The first point of a path from the camera, after `bounces` that were not specular, at which
/// lights are sampled.
std::optional<OraclePoint> oracle_point(const Scene& scene, int bounces, Rng& rng) {
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

}  // namespace

std::vector<OraclePoint> oracle_points(const Scene& scene, int bounces, std::uint32_t count,
                                       std::uint64_t seed) {
    std::vector<OraclePoint> points;
    constexpr std::uint64_t attempts = 64;  // for each point
    for (std::uint64_t i = 0; i < attempts * count && points.size() < count; ++i) {
        Rng rng(hash64({seed, static_cast<std::uint64_t>(bounces)}), i);
        if (auto point = oracle_point(scene, bounces, rng)) points.push_back(std::move(*point));
    }
    return points;
}

LightOracle::LightOracle(const Scene& scene, const OracleOptions& options)
    : scene_(scene), options_(options) {}

LightMoments LightOracle::evaluate(const OraclePoint& point, std::uint64_t index) const {
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

LightOracle::Sampled LightOracle::sample(const OraclePoint& point, const Receiver& from,
                                         std::uint32_t light, std::uint64_t index,
                                         bool shadows) const {
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

double LightOracle::estimate(const OraclePoint& point, const Receiver& from, const Light& light,
                             Vector2 u, bool shadows) const {
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

std::vector<LightMoments> evaluate_all(const Scene& scene, const OracleOptions& options,
                                       const std::vector<OraclePoint>& points) {
    std::vector<LightMoments> moments(points.size());
    const LightOracle oracle(scene, options);
    Workers().run(static_cast<std::int64_t>(points.size()), [&](std::int64_t i) {
        const auto k = static_cast<std::size_t>(i);
        moments[k] = oracle.evaluate(points[k], k);
    });
    return moments;
}

OracleKind::OracleKind(std::vector<LightMoments> all) : moments_(std::move(all)) {
    const std::size_t count = moments_.size();
    std::erase_if(moments_, [](const LightMoments& m) { return m.entries.empty(); });
    dark_ = static_cast<std::uint32_t>(count - moments_.size());
    for (const LightMoments& m : moments_) {
        mean_ += m.sum / static_cast<double>(moments_.size());
    }
}

template <typename Variance>
OracleFigures OracleKind::figures(const Variance& variance) const {
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

OracleFigures OracleKind::bound() const {
    return figures([](const LightMoments& m, double&) { return m.bound; });
}

OracleFigures OracleKind::unoccluded() const {
    return figures([](const LightMoments& m, double&) { return m.unoccluded; });
}

namespace {

/// For each light that is drawn, the mean over draws of LightChoice::weight², zero if the light is
/// another one. Empty: weights are 1 / pmf, and the means are, too.
std::unordered_map<std::uint32_t, double> squared_weights(const LightDistribution& lights) {
    constexpr int draws = 1 << 16, tried = 16;
    std::unordered_map<std::uint32_t, double> means;
    bool exact = true;
    for (int i = 0; i < tried; ++i) {
        const auto choice = lights.sample((i + 0.5) / tried);
        exact &= !choice || choice->is_exact();
    }
    for (int i = 0; i < draws && !exact; ++i) {
        const auto choice = lights.sample((i + 0.5) / draws);
        if (choice) means[choice->light] += sqr(static_cast<double>(choice->weight)) / draws;
    }
    return means;
}

}  // namespace

double LightMoments::variance_of(const LightSampler& sampler, double& lost) const {
    const LightDistribution lights = sampler.at(at);
    const auto squares = squared_weights(lights);
    return variance(
        [&](std::uint32_t light) {
            const auto pmf = static_cast<double>(lights.pmf(light));
            if (squares.empty() || !(pmf > 0)) return pmf;
            const auto found = squares.find(light);
            return found == squares.end() ? std::numeric_limits<double>::infinity()
                                          : 1 / found->second;
        },
        lost);
}

OracleFigures OracleKind::judge(const LightSampler& sampler) const {
    return figures(
        [&](const LightMoments& m, double& lost) { return m.variance_of(sampler, lost); });
}

}  // namespace lucerna
