// SPDX-License-Identifier: Apache-2.0
/// compare: which variant of a scene gives the least error in the least time.
///
/// All variants are rendered with one budget and independent seeds, several times and in turn,
/// against one reference. The figures, their intervals and the test for bias are explained in
/// docs/comparing.md; their formulas are in the headers beside this file.
#include "core/base/atomic_file.h"
#include "core/base/error.h"
#include "core/interfaces/command.h"
#include "core/math/sequences.h"
#include "core/render/interrupt.h"
#include "plugins/commands/compare/comparison.h"
#include "plugins/commands/compare/oracle.h"
#include "plugins/commands/compare/page.h"
#include "plugins/commands/compare/report.h"
#include "plugins/commands/compare/runs.h"
#include "plugins/commands/scene_options.h"

#include <fmt/format.h>

#include <filesystem>
#include <set>

namespace lucerna {

namespace {

namespace fs = std::filesystem;

/// What the command line says.
struct Request : SceneOptions {
    std::string output, reference = "auto";
    std::vector<std::pair<std::string, std::string>> varied;
    RenderBudget budget;
    std::optional<std::uint64_t> reference_samples;
    int repeats = 5, oracle_points = 200;
    std::uint64_t seed = 0;
    bool oracle = false, quiet = false, json = false;
};

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
        "130 interrupted.");
}

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

/// What is wrong with the arguments taken together, or empty.
std::string contradiction(const Request& request, const std::vector<Variant>& variants) {
    const std::string wrong = wrong_variation(request, variants);
    if (!wrong.empty()) return wrong;
    const RenderBudget& budget = request.budget;
    const int limits = int(budget.seconds.has_value()) + int(budget.samples.has_value()) +
                       int(budget.error.has_value());
    if (limits != 1) return "give one of --time, --spp and --error: the budget of each run";
    if (request.output.empty()) return "-o DIR is missing: the folder for the report";
    if (request.oracle) {
        const std::string problem = oracle_contradiction(variants);
        if (!problem.empty()) return problem;
    }
    if (request.reference != "auto" && request.reference_samples) {
        return "--reference-spp is for a reference that is rendered, not for one from a file";
    }
    return "";
}

/// Variants that would be called the same, as in a comparison of something with itself.
void number_equal_names(std::vector<Variant>& variants) {
    std::multiset<std::string> names;
    for (Variant& variant : variants) {
        names.insert(variant.name);
        const std::size_t count = names.count(variant.name);
        if (count > 1) variant.name += fmt::format(" ({})", count);
    }
}

/// One run of the command.
class Comparing {
public:
    Comparing(const Request& request, const std::vector<Variant>& variants, std::string command)
        : request_(request), settings_(session_settings(request)), folder_(request.output) {
        result_.scene = request.scene;
        result_.command = std::move(command);
        result_.budget = request.budget;
        result_.seed = request.seed;
        for (const Variant& variant : variants) result_.variants.push_back({variant});
    }

    int run() {
        make_folder();
        const InterruptGuard guard;
        if (request_.oracle) ask();
        if (!find_reference()) return exit_code::interrupted;
        result_.interrupted = !render_rounds(settings_, result_, request_.repeats, request_.quiet);
        if (result_.variants.front().runs.size() < 2) return exit_code::interrupted;
        report();
        return result_.interrupted ? exit_code::interrupted : exit_code::success;
    }

private:
    void make_folder() const {
        std::error_code problem;
        fs::create_directories(folder_, problem);
        if (problem) {
            throw FileError(fmt::format("the folder {} cannot be made: {}", folder_.string(),
                                        problem.message()));
        }
        for (const char* name : {"index.html", "report.json", "results.csv", "reference.exr"}) {
            check_writable(folder_ / name);
        }
    }

    void ask() {
        if (!request_.quiet) fmt::print(stderr, "oracle: asking all lights\n");
        std::vector<SessionSettings> variants;
        for (const VariantRuns& v : result_.variants) {
            variants.push_back(settings_for(settings_, v.variant));
        }
        oracle_ = ask_oracle(settings_, variants,
                             static_cast<std::uint32_t>(request_.oracle_points), request_.seed);
    }

    /// False if it was interrupted.
    bool find_reference() {
        if (request_.reference != "auto") {
            result_.reference = read_reference(request_.reference);
        } else {
            const Session session(settings_);
            for (const Diagnostic& warning : session.warnings()) {
                fmt::print(stderr, "{}\n", warning.text());
            }
            RenderOptions options;
            options.budget = reference_budget();
            options.interrupted = InterruptGuard::interrupted;
            // No run can have it: theirs are hashes of three numbers.
            const std::uint64_t seed = hash64({request_.seed, 0x7265666572656e63});
            std::optional<Reference> reference = rendered_reference(
                session, folder_ / "reference.exr", seed, options, request_.quiet);
            if (!reference) return false;
            result_.reference = std::move(*reference);
        }
        check_reference();
        return true;
    }

    RenderBudget reference_budget() const {
        if (request_.reference_samples) return {.samples = request_.reference_samples};
        const RenderBudget& budget = request_.budget;
        if (budget.samples) return {.samples = 64 * *budget.samples};
        if (budget.seconds) return {.seconds = 16 * *budget.seconds};
        return {.error = *budget.error / 32};
    }

    void check_reference() const {
        const Image& image = result_.reference.image;
        const Comparison self = compare_images(image, image);
        if (self.non_finite > 0) {
            throw Error(
                fmt::format("{} pixels of the reference {} are not finite; nothing can be "
                            "measured against it",
                            self.non_finite, result_.reference.source));
        }
        if (!(self.reference_mean > 0)) {
            throw Error(fmt::format("the reference {} is black; relative errors have no meaning",
                                    result_.reference.source));
        }
    }

    void report() const {
        const Summary summary(result_);
        Json json = to_json(result_, summary);
        if (oracle_) json.set("oracle", to_json(*oracle_, result_));
        const std::string text = json.text();
        write_file_atomically(folder_ / "report.json", text);
        write_file_atomically(folder_ / "results.csv", to_csv(result_, summary));
        write_file_atomically(folder_ / "index.html", to_html(result_, json));
        for (const std::string& warning : warnings(result_, summary)) {
            fmt::print(stderr, "warning: {}\n", warning);
        }
        if (request_.json) {
            fmt::print("{}", text);
        } else {
            fmt::print("{}{}\n{}\n", table(result_, summary),
                       oracle_ ? oracle_table(*oracle_, result_) : "",
                       (folder_ / "index.html").string());
        }
    }

    const Request& request_;
    SessionSettings settings_;
    fs::path folder_;
    ComparisonResult result_{};
    std::optional<OracleReport> oracle_;
};

class CompareCommand final : public Command {
public:
    explicit CompareCommand(const Params&) {}

    int run(const std::vector<std::string>& words) const override {
        Request request;
        Arguments arguments("compare", "Compares variants of a scene: error, time, efficiency.");
        declare_comparison(arguments, request);
        declare_runs(arguments, request);
        if (const std::optional<int> code = arguments.parse(words)) return *code;
        std::vector<Variant> variants = combinations(request.varied);
        const std::string problem = contradiction(request, variants);
        if (!problem.empty()) {
            fmt::print(stderr, "lucerna compare: {}\n", problem);
            return exit_code::usage;
        }
        number_equal_names(variants);
        ignore_write_signals();
        return Comparing(request, variants, shell_text("compare", words)).run();
    }
};

}  // namespace

const PluginInfo plugin = describe<CompareCommand>("compares variants of a scene");

}  // namespace lucerna
