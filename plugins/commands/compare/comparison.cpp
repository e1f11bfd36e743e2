// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/compare/comparison.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

/// An error without the reference's own noise, which adds to it: MSE = bias² + variance +
/// Var(reference). At most half is taken away; beyond that the reference is too noisy to tell.
double without_reference(double error, double reference_error) {
    return std::max(error - reference_error, error / 2);
}

/// Share of the shadow rays that nothing blocked.
double visibility(const RayStatistics& rays) {
    if (rays.occlusions == 0) return 0;
    return 1 - static_cast<double>(rays.blocked) / static_cast<double>(rays.occlusions);
}

template <typename Value>
std::vector<double> values(const VariantRuns& variant, const Value& value) {
    std::vector<double> result;
    for (const Run& run : variant.runs) result.push_back(value(run));
    return result;
}

template <typename Value>
double median_of(const VariantRuns& variant, const Value& value) {
    return median(values(variant, [&](const Run& run) { return static_cast<double>(value(run)); }));
}

}  // namespace

Summary::Summary(const ComparisonResult& result) : reference_(result.reference) {
    const Blocks reference(reference_.image);
    const std::vector<double> variances =
        block_variances(reference_.halves, reference.means().size());
    for (const VariantRuns& variant : result.variants) {
        all.push_back(figures(variant, result.variants.front()));
        all.back().bias = test_bias(variant.blocks, reference, variances);
    }
}

std::vector<double> machine_speeds(const ComparisonResult& result) {
    std::vector<double> speeds;
    for (std::size_t round = 0; round < result.machines.size(); ++round) {
        double sum = 0;
        for (const VariantRuns& variant : result.variants) {
            const Run& run = variant.runs[round];
            sum += std::log(static_cast<double>(run.figures.samples) / run.render_seconds);
        }
        speeds.push_back(sum / static_cast<double>(result.variants.size()));
    }
    double mean = 0;
    for (const double x : speeds) mean += x / static_cast<double>(speeds.size());
    for (double& x : speeds) x = std::exp(x - mean);
    return speeds;
}

double Summary::relmse(const Metrics& m) const {
    return without_reference(m.relmse, relmse_noise());
}

double Summary::mse(const Metrics& m) const { return without_reference(m.mse, mse_noise()); }

Figures Summary::figures(const VariantRuns& variant, const VariantRuns& first) const {
    const auto over_runs = [&](const auto& value) {
        return geometric_mean(values(variant, value));
    };
    const auto over_first = [&](const auto& value) {
        if (&variant == &first) return Interval{1, 1, 1};
        // Runs of one round are of one machine at one time; those of others may be of faster ones.
        return paired_ratio(values(variant, value), values(first, value));
    };
    Figures f;
    f.mse = over_runs([&](const Run& run) { return mse(run.metrics); });
    f.relmse = over_runs([&](const Run& run) { return relmse(run.metrics); });
    f.trimmed_relmse = over_runs([](const Run& run) { return run.metrics.trimmed_relmse; });
    f.flip = over_runs([](const Run& run) { return run.flip; });
    f.efficiency =
        over_first([&](const Run& run) { return 1 / (relmse(run.metrics) * run.total_seconds()); });
    f.render_efficiency =
        over_first([&](const Run& run) { return 1 / (relmse(run.metrics) * run.render_seconds); });
    f.build_seconds = median_of(variant, [](const Run& r) { return r.figures.build_seconds; });
    f.render_seconds = median_of(variant, [](const Run& r) { return r.render_seconds; });
    f.samples = median_of(variant, [](const Run& r) { return r.figures.samples; });
    f.rays = median_of(variant, [](const Run& r) { return r.figures.rays.rays(); });
    f.shadow_rays = median_of(variant, [](const Run& r) { return r.figures.rays.occlusions; });
    f.visible = median_of(variant, [](const Run& r) { return visibility(r.figures.rays); });
    f.sampler_memory =
        median_of(variant, [](const Run& r) { return r.figures.light_sampler_bytes; });
    f.memory = median_of(variant, [](const Run& r) { return r.memory; });
    f.trimmed_share = median_of(variant, [](const Run& r) { return r.metrics.trimmed_share; });
    for (const Run& run : variant.runs) {
        f.dropped_samples += run.figures.dropped_samples;
        f.limited = f.limited || run.metrics.relmse < 2 * relmse_noise();
    }
    return f;
}

}  // namespace lucerna
