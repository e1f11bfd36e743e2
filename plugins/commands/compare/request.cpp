// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/compare/request.h"

#include "core/base/error.h"
#include "core/math/sequences.h"
#include "plugins/commands/compare/oracle.h"

#include <fmt/format.h>

#include <set>

namespace lucerna {

void declare_comparison(Arguments& arguments, Request& request) {
    arguments.positional("SCENE", request.scene, "an XML file in Mitsuba's format");
    arguments.option("--vary", "PATH=A,B,...", request.varied,
                     "the values to compare, for example "
                     "integrator.light_sampler=uniform,power,all; separated by semicolons if they "
                     "hold commas. Given more than once: all combinations. The first is what "
                     "efficiencies are relative to");
    arguments.option("--time", "SECONDS", request.budget.seconds, positive,
                     "each run renders so long, building not counted");
    arguments.option("--spp", "N", request.budget.samples, {.min = 1, .max = 1 << 30},
                     "each run takes so many samples per pixel");
    arguments.option("--error", "RELMSE", request.budget.error, positive,
                     "each run stops at this estimated relative mean squared error");
    arguments.option("--repeats", "R", request.repeats, {.min = 2, .max = 1000},
                     "runs of each variant; 5 by default");
    arguments.option("--reference", "FILE", request.reference,
                     "a picture, or the checkpoint of a render, whose noise is then known; by "
                     "default, auto, the scene itself is rendered, and kept in the output folder");
    arguments.option("--reference-spp", "N", request.reference_samples, {.min = 4, .max = 1 << 30},
                     "samples of the reference; by default 64 times --spp, 16 times --time, or a "
                     "32nd of --error");
    arguments.flag("--oracle", request.oracle,
                   "also tells how far the light sampler of each variant is from the best choice "
                   "of a light that is possible, by asking all lights at some points");
    arguments.option("--oracle-points", "N", request.oracle_points, {.min = 2, .max = 100000},
                     "points of the oracle, of each kind; 200 by default, fewer if there are very "
                     "many lights");
    arguments.option("-o,--output", "DIR", request.output,
                     "folder for index.html, report.json, results.csv and reference.exr");
}

void declare_parts(Arguments& arguments, Request& request) {
    arguments.flag("--parts", request.parts,
                   "makes --output a job for many machines, as `lucerna farm` does: a part is a "
                   "round, or a part of the reference; when all are done, the report is made. "
                   "`lucerna farm DIR` with --submit, --local N or --status does the rest");
    arguments.flag("--submit", request.submit, "gives the job of --parts to Slurm at once");
    arguments.option("--slurm", "OPTION", request.slurm_options,
                     "an option of sbatch for the scripts of --parts, as "
                     "--slurm=--partition=long; may be repeated");
    arguments.option("--round", "K", request.round, {.min = 1, .max = 1000},
                     "renders round K only, and writes it to the file of --output; the job's "
                     "scripts use it");
    arguments.flag("--collect", request.collect,
                   "makes the report of the parts in the job of --output; the job's scripts use "
                   "it");
}

void declare_runs(Arguments& arguments, Request& request) {
    declare_scene_options(arguments, request);
    declare_threads(arguments, request);
    arguments.option("--seed", "N", request.seed, non_negative,
                     "all other seeds follow from it; 0 by default");
    arguments.flag("-q,--quiet", request.quiet, "prints nothing but the table and errors");
    arguments.flag("--json", request.json, "prints the report as JSON instead of the table");
    arguments.footer(
        "SIGINT and SIGTERM end the comparison; if there are two complete rounds, they are "
        "reported, and the exit code is 130.\n\nExit codes: 0 success, 1 failure, 2 wrong "
        "arguments, 3 wrong scene, 4 plugin cannot be loaded, 5 file cannot be read or written, "
        "130 interrupted, 75 with "
        "--round or --collect: a file cannot be read or written now, but may be later.");
}

RenderBudget reference_budget(const Request& request) {
    if (request.reference_samples) return {.samples = request.reference_samples};
    const RenderBudget& budget = request.budget;
    if (budget.samples) return {.samples = 64 * *budget.samples};
    if (budget.seconds) return {.seconds = 16 * *budget.seconds};
    return {.error = *budget.error / 32};
}

std::uint64_t reference_seed(const Request& request) {
    // No run can have it: theirs are hashes of three numbers. `--seed` takes 63 bits.
    return hash64({request.seed, 0x7265666572656e63}) >> 1;
}

namespace {

/// The part of "path=value" before the equals sign.
std::string path_of(const std::string& setting) { return setting.substr(0, setting.find('=')); }

/// What is wrong with what is to be varied, or empty.
std::string wrong_variation(const Request& request, const std::vector<Variant>& variants) {
    if (request.varied.empty()) {
        return "nothing is varied; for example --vary integrator.light_sampler=uniform,power";
    }
    std::set<std::string> paths;
    for (const auto& [path, values] : request.varied) {
        if (!paths.insert(path).second) {
            return fmt::format("--vary {} is given twice; put all values into one list", path);
        }
        for (const std::string& setting : request.overrides) {
            if (path_of(setting) == path) {
                return fmt::format("{} is varied and also --set to one value", path);
            }
        }
    }
    for (const Variant& variant : variants) {
        for (const std::string& setting : variant.overrides) {
            if (setting.ends_with('=')) {
                return fmt::format("--vary {} has an empty value", path_of(setting));
            }
        }
    }
    if (variants.size() < 2) return "there is only one variant; give --vary two values or more";
    if (variants.size() > 64) {
        return fmt::format("{} combinations are too many to be looked at; 64 are the most",
                           variants.size());
    }
    return "";
}

/// What is wrong with those of a comparison by parts, or empty.
std::string contradiction_of_parts(const Request& request) {
    if (int(request.parts) + int(request.round > 0) + int(request.collect) > 1) {
        return "give only one of --parts, --round and --collect";
    }
    if (!request.parts && (request.submit || !request.slurm_options.empty())) {
        return "--submit and --slurm are for --parts; a job that is there is submitted by "
               "`lucerna farm DIR --submit`";
    }
    for (const std::string& option : request.slurm_options) {
        if (option.starts_with("--") && option.find('\n') == std::string::npos) continue;
        return fmt::format("--slurm {} is no option of sbatch: expected --NAME=VALUE",
                           quote(option));
    }
    if (request.round > request.repeats) {
        return fmt::format("--round {}: there are only rounds 1 to {}", request.round,
                           request.repeats);
    }
    if (request.parts && request.json) {
        return "--json is for the report, which --parts does not make; leave it out";
    }
    const bool divides = request.parts || request.collect;
    if (divides && request.reference == "auto" && !reference_budget(request).samples) {
        return "--parts needs --reference-spp N or --reference FILE: parts of a reference have a "
               "number of samples";
    }
    return "";
}

}  // namespace

std::string contradiction(const Request& request, const std::vector<Variant>& variants) {
    const std::string wrong = wrong_variation(request, variants);
    if (!wrong.empty()) return wrong;
    const RenderBudget& budget = request.budget;
    const int limits = int(budget.seconds.has_value()) + int(budget.samples.has_value()) +
                       int(budget.error.has_value());
    if (limits != 1) return "give one of --time, --spp and --error: the budget of each run";
    if (request.output.empty()) return "-o DIR is missing: the folder for the report";
    const std::string problem_of_parts = contradiction_of_parts(request);
    if (!problem_of_parts.empty()) return problem_of_parts;
    if (request.oracle) {
        const std::string problem = oracle_contradiction(variants);
        if (!problem.empty()) return problem;
    }
    if (request.reference != "auto" && request.reference_samples) {
        return "--reference-spp is for a reference that is rendered, not for one from a file";
    }
    return "";
}

void number_equal_names(std::vector<Variant>& variants) {
    std::multiset<std::string> names;
    for (Variant& variant : variants) {
        names.insert(variant.name);
        const std::size_t count = names.count(variant.name);
        if (count > 1) variant.name += fmt::format(" ({})", count);
    }
}

}  // namespace lucerna
