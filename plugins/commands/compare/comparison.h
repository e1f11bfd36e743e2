// SPDX-License-Identifier: Apache-2.0
/// What a comparison measures, and what follows from it.
#pragma once

#include "core/image/metrics.h"
#include "core/render/budget.h"
#include "core/render/statistics.h"
#include "plugins/commands/compare/bias.h"
#include "plugins/commands/compare/machine.h"
#include "plugins/commands/compare/reference.h"
#include "plugins/commands/compare/statistics.h"

#include <cstdint>
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
    std::vector<Machine> machines{};  ///< of each round
    bool interrupted = false;
    bool by_parts = false;  ///< rounds may have been timed on different machines
};

/// How fast the machine of each round was, relative to the geometric mean over the rounds: from the
/// samples per second of all variants. Empty without rounds.
std::vector<double> machine_speeds(const ComparisonResult& result);

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

/// The figures of all variants.
class Summary {
public:
    explicit Summary(const ComparisonResult& result);

    std::vector<Figures> all;

    /// Errors without the reference's own noise.
    double relmse(const Metrics& m) const;
    double mse(const Metrics& m) const;
    double relmse_noise() const { return reference_.error ? reference_.error->relative_mse : 0; }
    double mse_noise() const { return reference_.error ? reference_.error->mse : 0; }

private:
    Figures figures(const VariantRuns& variant, const VariantRuns& first) const;

    const Reference& reference_;
};

}  // namespace lucerna
