// SPDX-License-Identifier: Apache-2.0
/// compare: which variant of a scene gives the least error in the least time.
///
/// All variants are rendered with one budget and independent seeds, several times and in turn,
/// against one reference. The figures, their intervals and the test for bias are explained in
/// docs/comparing.md; their formulas are in the headers beside this file.
#include "core/base/atomic_file.h"
#include "core/base/error.h"
#include "core/render/interrupt.h"
#include "plugins/commands/compare/comparison.h"
#include "plugins/commands/compare/oracle.h"
#include "plugins/commands/compare/page.h"
#include "plugins/commands/compare/parts.h"
#include "plugins/commands/compare/report.h"
#include "plugins/commands/compare/request.h"
#include "plugins/commands/compare/runs.h"
#include "plugins/commands/jobs/slurm.h"
#include "plugins/commands/try_again.h"

#include <fmt/format.h>

#include <filesystem>

namespace lucerna {

namespace {

namespace fs = std::filesystem;

RoundSettings round_settings(const Request& request, const std::vector<Variant>& variants) {
    return {.session = session_settings(request),
            .variants = variants,
            .budget = request.budget,
            .seed = request.seed,
            .repeats = request.repeats};
}

/// One run of the command.
class Comparing {
public:
    Comparing(const Request& request, const std::vector<Variant>& variants, std::string command)
        : request_(request), settings_(round_settings(request, variants)), folder_(request.output) {
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
        if (request_.collect) return collect();
        if (!find_reference()) return exit_code::interrupted;
        result_.interrupted = !render_rounds(settings_, result_, request_.quiet);
        if (result_.variants.front().runs.size() < 2) return exit_code::interrupted;
        report();
        return result_.interrupted ? exit_code::interrupted : exit_code::success;
    }

private:
    int collect() {
        result_.by_parts = true;
        collect_parts(request_, settings_, result_);
        check_reference();
        report();
        return exit_code::success;
    }

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
            variants.push_back(settings_for(settings_.session, v.variant));
        }
        oracle_ = ask_oracle(settings_.session, variants,
                             static_cast<std::uint32_t>(request_.oracle_points), request_.seed);
    }

    /// False if it was interrupted.
    bool find_reference() {
        if (request_.reference != "auto") {
            result_.reference = read_reference(request_.reference);
        } else {
            const Session session(settings_.session);
            for (const Diagnostic& warning : session.warnings()) {
                fmt::print(stderr, "{}\n", warning.text());
            }
            RenderOptions options;
            options.budget = reference_budget(request_);
            options.interrupted = InterruptGuard::interrupted;
            std::optional<Reference> reference =
                rendered_reference(session, folder_ / "reference.exr", reference_seed(request_),
                                   options, request_.quiet);
            if (!reference) return false;
            result_.reference = std::move(*reference);
        }
        check_reference();
        return true;
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
                       (result_.by_parts ? machine_table(result_) : "") +
                           (oracle_ ? oracle_table(*oracle_, result_) : ""),
                       (folder_ / "index.html").string());
        }
    }

    const Request& request_;
    RoundSettings settings_;
    fs::path folder_;
    ComparisonResult result_{};
    std::optional<OracleReport> oracle_;
};

/// `--parts`: packs the job, and submits it if that is asked for.
int make_job(const Request& request, const std::vector<Variant>& variants) {
    const JobFolder job = pack_comparison(request, variants);
    if (request.submit) submit(job);
    if (request.quiet) return exit_code::success;
    fmt::print("{}\n{}\n{} parts: {} rounds, and the reference in {}\n", job.part_script().string(),
               job.merge_script().string(), job.part_count(), request.repeats,
               job.part_count() - request.repeats);
    fmt::print("next: lucerna farm {} {}\n", job.path().string(),
               request.submit ? "--status" : "--submit, or --local 1");
    return exit_code::success;
}

class CompareCommand final : public Command {
public:
    explicit CompareCommand(const Params&) {}

    int run(const std::vector<std::string>& words) const override {
        Request request;
        Arguments arguments("compare", "Compares variants of a scene: error, time, efficiency.");
        declare_comparison(arguments, request);
        declare_parts(arguments, request);
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
        if (request.parts) return make_job(request, variants);
        if (request.round > 0) {
            return or_try_again(
                [&] { return render_round_file(request, round_settings(request, variants)); });
        }
        Comparing comparing(request, variants, shell_text("compare", words));
        return request.collect ? or_try_again([&] { return comparing.run(); }) : comparing.run();
    }
};

}  // namespace

const PluginInfo plugin = describe<CompareCommand>("compares variants of a scene");

}  // namespace lucerna
