// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/compare/report.h"

#include "core/plugin/registry.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>

namespace lucerna {

Json to_json(const Interval& interval) {
    Json json = Json::object();
    return json.set("value", interval.value).set("low", interval.low).set("high", interval.high);
}

namespace {

Json errors_json(const Summary& summary, const Metrics& metrics) {
    Json json = Json::object();
    json.set("mse", summary.mse(metrics)).set("relative_mse", summary.relmse(metrics));
    return json.set("trimmed_relative_mse", metrics.trimmed_relmse);
}

Json run_json(const Summary& summary, const Run& run) {
    Json json = errors_json(summary, run.metrics);
    json.set("measured_mse", run.metrics.mse).set("measured_relative_mse", run.metrics.relmse);
    json.set("trimmed_share", run.metrics.trimmed_share).set("flip", run.flip);
    json.set("repeat", run.repeat).set("seed", std::to_string(run.figures.seed));
    json.set("build_seconds", run.figures.build_seconds);
    json.set("render_seconds", run.render_seconds);
    json.set("samples_per_pixel", run.figures.samples);
    json.set("intersections", run.figures.rays.intersections);
    json.set("occlusions", run.figures.rays.occlusions);
    json.set("blocked", run.figures.rays.blocked);
    json.set("dropped_samples", run.figures.dropped_samples);
    json.set("peak_memory_bytes", run.memory);
    Json curve = Json::array();
    for (const CurvePoint& point : run.curve) {
        Json entry = errors_json(summary, point.metrics);
        entry.set("render_seconds", point.seconds);
        entry.set("total_seconds", point.seconds + run.figures.build_seconds);
        curve.append(entry.set("samples_per_pixel", point.samples));
    }
    return json.set("curve", curve);
}

Json bias_json(const BiasTest& bias) {
    Json json = Json::object();
    json.set("biased", bias.biased).set("brightness", to_json(bias.brightness));
    return json.set("local", to_json(bias.local)).set("confidence", 0.99);
}

Json variant_json(const Summary& summary, const VariantRuns& variant, const Figures& f) {
    Json json = Json::object();
    json.set("name", variant.variant.name).set("settings", variant.variant.overrides);
    json.set("mse", to_json(f.mse)).set("relative_mse", to_json(f.relmse));
    json.set("trimmed_relative_mse", to_json(f.trimmed_relmse));
    json.set("trimmed_share", f.trimmed_share).set("flip", to_json(f.flip));
    json.set("efficiency", to_json(f.efficiency));
    json.set("render_efficiency", to_json(f.render_efficiency));
    json.set("build_seconds", f.build_seconds).set("render_seconds", f.render_seconds);
    json.set("samples_per_pixel", f.samples).set("rays", f.rays);
    json.set("shadow_rays", f.shadow_rays).set("visible", f.visible);
    json.set("light_sampler_bytes", f.sampler_memory).set("peak_memory_bytes", f.memory);
    json.set("dropped_samples", f.dropped_samples);
    json.set("limited_by_reference", f.limited).set("bias", bias_json(f.bias));
    Json runs = Json::array();
    for (const Run& run : variant.runs) runs.append(run_json(summary, run));
    return json.set("runs", runs);
}

Json reference_json(const Reference& reference) {
    Json json = Json::object();
    json.set("file", reference.source).set("samples_per_pixel", reference.samples);
    json.set("render_seconds", reference.seconds);
    json.set("noise_known", reference.error.has_value());
    if (reference.error) {
        json.set("mse", reference.error->mse);
        json.set("relative_mse", to_json(Interval{reference.error->relative_mse,
                                                  reference.error->low, reference.error->high}));
    }
    return json;
}

Json budget_json(const RenderBudget& budget) {
    Json json = Json::object();
    json.set("seconds", budget.seconds).set("samples_per_pixel", budget.samples);
    return json.set("relative_mse", budget.error);
}

Json machine_json(const Machine& machine) {
    Json json = Json::object();
    json.set("processor", machine.processor).set("threads", machine.threads);
    json.set("system", machine.system).set("node", machine.node);
    return json.set("cores", machine.cores);
}

Json rounds_json(const ComparisonResult& result) {
    const std::vector<double> speeds = machine_speeds(result);
    Json rounds = Json::array();
    for (std::size_t i = 0; i < result.machines.size(); ++i) {
        Json round = machine_json(result.machines[i]);
        round.set("round", i + 1).set("relative_speed", speeds[i]);
        rounds.append(round.set("other_load", result.machines[i].other_load));
    }
    return rounds;
}

std::string utc_now() {
    const std::time_t now = std::time(nullptr);
    std::tm date{};
    gmtime_r(&now, &date);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &date);
    return text;
}

/// Machines that differ, and those that others used at the same time.
std::vector<std::string> machine_warnings(const ComparisonResult& result) {
    std::vector<std::string> lines;
    const std::vector<double> speeds = machine_speeds(result);
    if (result.by_parts) {
        const auto [slowest, fastest] = std::minmax_element(speeds.begin(), speeds.end());
        if (*fastest > 1.1 * *slowest) {
            lines.push_back(fmt::format(
                "the machines of the rounds differ in speed, by up to ×{:.3g}: times are medians "
                "over all of them; ratios are of runs on one machine",
                *fastest / *slowest));
        }
    }
    const auto busiest = std::max_element(
        result.machines.begin(), result.machines.end(),
        [](const Machine& a, const Machine& b) { return a.other_load < b.other_load; });
    if (busiest != result.machines.end() && busiest->other_load > 0.05) {
        lines.push_back(fmt::format(
            "other programs took up to {:.0f} % of the processors (round {}, on {}): times are not "
            "those of a machine that does nothing else",
            100 * busiest->other_load, busiest - result.machines.begin() + 1, busiest->node));
    }
    return lines;
}

}  // namespace

std::vector<std::string> warnings(const ComparisonResult& result, const Summary& summary) {
    std::vector<std::string> lines;
    if (result.interrupted) lines.push_back("interrupted: there are fewer repeats than asked for");
    if (!result.reference.error) {
        lines.push_back(
            "the reference's own noise is not known: it is part of all errors, and a bias that is "
            "found may be the reference's");
    }
    if (result.budget.error) {
        lines.push_back(
            "renders that stop at their own estimate of the error stop a little early "
            "when they are lucky");
    }
    for (const std::string& line : machine_warnings(result)) lines.push_back(line);
    for (std::size_t i = 0; i < summary.all.size(); ++i) {
        const Figures& f = summary.all[i];
        const std::string& name = result.variants[i].variant.name;
        if (f.limited) {
            lines.push_back(name +
                            ": the reference is nearly as noisy as these pictures; raise "
                            "--reference-spp");
        }
        if (f.trimmed_share > 0.1) {
            lines.push_back(fmt::format(
                "{}: the worst 0.1 % of the pixels hold {:.0f} % of the "
                "error; intervals hold the median run, and another run can be far worse",
                name, 100 * f.trimmed_share));
        }
        if (f.dropped_samples > 0) {
            lines.push_back(fmt::format("{}: {} samples were not finite and are missing", name,
                                        f.dropped_samples));
        }
    }
    return lines;
}

Json to_json(const ComparisonResult& result, const Summary& summary) {
    const Image& picture = result.reference.image;
    Json json = Json::object();
    json.set("schema", 1).set("scene", result.scene).set("command", result.command);
    json.set("version", core_version()).set("date", utc_now());
    json.set("machine", machine_json(result.machines.front()))
        .set("budget", budget_json(result.budget));
    json.set("repeats", result.variants.front().runs.size());
    json.set("seed", std::to_string(result.seed));
    const auto degrees = static_cast<double>(result.variants.front().runs.size()) - 1;
    json.set("by_parts", result.by_parts).set("rounds", rounds_json(result));
    json.set("student_t", student_quantile(0.95, degrees));
    json.set("median_rank", median_rank(result.variants.front().runs.size()));
    json.set("width", picture.width).set("height", picture.height);
    json.set("epsilon", compare_images(picture, picture).epsilon);
    json.set("reference", reference_json(result.reference));
    Json variants = Json::array();
    for (std::size_t i = 0; i < summary.all.size(); ++i) {
        variants.append(variant_json(summary, result.variants[i], summary.all[i]));
    }
    return json.set("variants", variants).set("warnings", warnings(result, summary));
}

std::string to_csv(const ComparisonResult& result, const Summary& summary) {
    std::string text =
        "variant,repeat,seed,samples_per_pixel,build_seconds,render_seconds,mse,relative_mse,"
        "measured_mse,measured_relative_mse,trimmed_relative_mse,trimmed_share,flip,"
        "intersections,occlusions,blocked,dropped_samples,peak_memory_bytes,node,other_load\n";
    for (const VariantRuns& variant : result.variants) {
        std::string name;
        for (const char c : variant.variant.name) name += c == '"' ? "\"\"" : std::string(1, c);
        for (std::size_t i = 0; i < variant.runs.size(); ++i) {
            const Run& run = variant.runs[i];
            const Machine& machine = result.machines[i];
            const Metrics& m = run.metrics;
            text += fmt::format("\"{}\",{},{},{},{:.6f},{:.6f},{:.9g},{:.9g},{:.9g},{:.9g},", name,
                                run.repeat, run.figures.seed, run.figures.samples,
                                run.figures.build_seconds, run.render_seconds, summary.mse(m),
                                summary.relmse(m), m.mse, m.relmse);
            text += fmt::format("{:.9g},{:.6g},{:.9g},{},{},{},{},{},\"{}\",{:.4f}\n",
                                m.trimmed_relmse, m.trimmed_share, run.flip,
                                run.figures.rays.intersections, run.figures.rays.occlusions,
                                run.figures.rays.blocked, run.figures.dropped_samples, run.memory,
                                machine.node, machine.other_load);
        }
    }
    return text;
}

namespace {

/// "×7.3 [6.9, 7.8]"
std::string factor_text(const Interval& ratio) {
    return fmt::format("×{:.3g} [{:.3g}, {:.3g}]", ratio.value, ratio.low, ratio.high);
}

std::string bias_text(const BiasTest& bias) {
    if (bias.biased) {
        return fmt::format("BIASED: brightness {:+.2f} %, locally {:.2f} %",
                           100 * bias.brightness.value, 100 * bias.local.value);
    }
    const double widest = std::max(bias.brightness.high, -bias.brightness.low);
    return fmt::format("none found (< {:.2g} %, locally < {:.2g} %)", 100 * widest,
                       100 * bias.local.high);
}

}  // namespace

std::string table(const ComparisonResult& result, const Summary& summary) {
    std::size_t width = 7;
    for (const VariantRuns& v : result.variants) width = std::max(width, v.variant.name.size());
    std::string text = fmt::format("{:{}}  {:>7} {:>8} {:>8}  {:>32} {:>8} {:>8}  {:<22} {}\n",
                                   "variant", width, "spp", "build s", "render s", "relMSE [95 %]",
                                   "ꟻLIP", "visible", "efficiency [95 %]", "bias");
    for (std::size_t i = 0; i < summary.all.size(); ++i) {
        const Figures& f = summary.all[i];
        const std::string error =
            fmt::format("{:.3g} [{:.3g}, {:.3g}]", f.relmse.value, f.relmse.low, f.relmse.high);
        const std::string visible =
            f.shadow_rays > 0 ? fmt::format("{:.1f} %", 100 * f.visible) : "";
        text += fmt::format("{:{}}  {:>7} {:>8.2f} {:>8.2f}  {:>32} {:>8.4f} {:>8}  {:<22} {}\n",
                            result.variants[i].variant.name, width, f.samples, f.build_seconds,
                            f.render_seconds, error, f.flip.value, visible,
                            i == 0 ? "×1" : factor_text(f.efficiency), bias_text(f.bias));
    }
    return text;
}

std::string machine_table(const ComparisonResult& result) {
    std::string text = "\nround  speed  others  threads  node, processor\n";
    const std::vector<double> speeds = machine_speeds(result);
    for (std::size_t i = 0; i < result.machines.size(); ++i) {
        const Machine& m = result.machines[i];
        text += fmt::format("{:>5}  {:>5}  {:>4.0f} %  {:>2} of {:>2}  {}, {}\n", i + 1,
                            fmt::format("×{:.2f}", speeds[i]), 100 * m.other_load, m.threads,
                            m.cores, m.node, m.processor);
    }
    return text;
}

}  // namespace lucerna
