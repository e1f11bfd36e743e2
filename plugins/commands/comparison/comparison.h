// SPDX-License-Identifier: Apache-2.0
/// What a comparison measures, and what follows from it.
#pragma once

#include "core/image/metrics.h"
#include "core/render/budget.h"
#include "core/render/statistics.h"
#include "plugins/commands/comparison/bias.h"
#include "plugins/commands/comparison/reference.h"
#include "plugins/commands/comparison/statistics.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace lucerna {

/// A scene with some parameters changed.
struct Variant {
    std::string name;
    std::vector<std::string> overrides;  ///< `--set PATH=VALUE`
};

struct CurvePoint {
    double seconds = 0;         ///< rendering until the end of this pass
    std::uint64_t samples = 0;  ///< per pixel
    Metrics metrics{};
};

/// One render of one variant.
struct Run {
    int repeat = 0;
    RenderFigures figures{};
    double render_seconds = 0;  ///< without the time that measuring took
    std::uint64_t memory = 0;   ///< most that was resident while building and rendering [bytes]
    Metrics metrics{};
    double flip = 0;
    std::vector<CurvePoint> curve{};  ///< ends with the finished picture

    double total_seconds() const { return figures.build_seconds + render_seconds; }
};

struct VariantRuns {
    Variant variant;
    std::vector<Run> runs{};
    Image picture{};     ///< of the first run
    BlockRuns blocks{};  ///< of all runs
};

/// All that was asked for and measured.
struct ComparisonResult {
    std::string scene, command;
    RenderBudget budget;
    std::uint64_t seed = 0;
    Reference reference;
    std::vector<VariantRuns> variants{};
    bool interrupted = false;
};

/// An error without the reference's own noise, which adds to it: MSE = bias² + variance +
/// Var(reference). At most half is taken away; beyond that the reference is too noisy to tell.
inline double without_reference(double error, double reference_error) {
    return std::max(error - reference_error, error / 2);
}

/// Share of the shadow rays that nothing blocked.
inline double visibility(const RayStatistics& rays) {
    if (rays.occlusions == 0) return 0;
    return 1 - static_cast<double>(rays.blocked) / static_cast<double>(rays.occlusions);
}

/// What is said of a variant.
struct Figures {
    Interval mse, relmse, trimmed_relmse, flip;
    Interval efficiency;         ///< 1 / (relMSE · seconds), building included, over the first's
    Interval render_efficiency;  ///< the same, building not counted
    double build_seconds = 0, render_seconds = 0, samples = 0, rays = 0, shadow_rays = 0;
    double visible = 0;                     ///< share of the shadow rays that nothing blocked
    double sampler_memory = 0, memory = 0;  ///< [bytes]; medians, these all
    double trimmed_share = 0;               ///< of the sum of relMSE in the worst 0.1 % of pixels
    std::uint64_t dropped_samples = 0;
    BiasTest bias;
    bool limited = false;  ///< the reference's own noise is more than half of some error
};

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

/// The figures of all variants.
class Summary {
public:
    explicit Summary(const ComparisonResult& result) : reference_(result.reference) {
        const Blocks reference(reference_.image);
        const std::vector<double> variances =
            block_variances(reference_.halves, reference.means().size());
        for (const VariantRuns& variant : result.variants) {
            all.push_back(figures(variant, result.variants.front()));
            all.back().bias = test_bias(variant.blocks, reference, variances);
        }
    }

    std::vector<Figures> all;

    double relmse(const Metrics& m) const { return without_reference(m.relmse, relmse_noise()); }
    double mse(const Metrics& m) const { return without_reference(m.mse, mse_noise()); }
    double relmse_noise() const { return reference_.error ? reference_.error->relative_mse : 0; }
    double mse_noise() const { return reference_.error ? reference_.error->mse : 0; }

private:
    Figures figures(const VariantRuns& variant, const VariantRuns& first) const {
        const auto over_runs = [&](const auto& value) {
            return geometric_mean(values(variant, value));
        };
        const auto over_first = [&](const auto& value) {
            if (&variant == &first) return Interval{1, 1, 1};
            return ratio_of_means(values(variant, value), values(first, value));
        };
        Figures f;
        f.mse = over_runs([&](const Run& run) { return mse(run.metrics); });
        f.relmse = over_runs([&](const Run& run) { return relmse(run.metrics); });
        f.trimmed_relmse = over_runs([](const Run& run) { return run.metrics.trimmed_relmse; });
        f.flip = over_runs([](const Run& run) { return run.flip; });
        f.efficiency = over_first(
            [&](const Run& run) { return 1 / (relmse(run.metrics) * run.total_seconds()); });
        f.render_efficiency = over_first(
            [&](const Run& run) { return 1 / (relmse(run.metrics) * run.render_seconds); });
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

    const Reference& reference_;
};

}  // namespace lucerna
