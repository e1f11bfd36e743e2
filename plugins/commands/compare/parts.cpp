// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/compare/parts.h"

#include "core/base/atomic_file.h"
#include "core/base/error.h"
#include "core/interfaces/command.h"
#include "core/plugin/registry.h"
#include "core/render/interrupt.h"
#include "core/render/merge.h"
#include "plugins/commands/compare/round_file.h"
#include "plugins/commands/jobs/file_store.h"
#include "plugins/commands/jobs/job_scripts.h"
#include "plugins/commands/jobs/scene_pack.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

/// Slurm's default for MaxArraySize allows no number above it.
constexpr std::uint64_t most_parts = 1000;

/// So many that one takes about as long as a round, where that is known.
int reference_parts(const Request& request) {
    if (request.reference != "auto") return 0;
    const std::uint64_t samples = *reference_budget(request).samples;
    const auto repeats = static_cast<std::uint64_t>(request.repeats);
    std::uint64_t parts = repeats;
    if (request.budget.samples) {
        const std::uint64_t of_round =
            *request.budget.samples * combinations(request.varied).size();
        parts = (samples + of_round - 1) / of_round;
    }
    return static_cast<int>(
        std::clamp<std::uint64_t>(parts, 1, std::min(samples, most_parts - repeats)));
}

/// What rounds must have in common, as a person would say it.
std::string comparison_text(const RoundSettings& settings) {
    const RenderBudget& budget = settings.budget;
    std::string text = fmt::format("Lucerna {}: ", core_version());
    for (const Variant& variant : settings.variants) text += variant.name + "; ";
    if (budget.samples) text += fmt::format("{} spp", *budget.samples);
    if (budget.seconds) text += fmt::format("{} s", *budget.seconds);
    if (budget.error) text += fmt::format("relMSE {}", *budget.error);
    return text + fmt::format(", {} rounds, seed {}", settings.repeats, settings.seed);
}

/// The words of a command line, as a shell reads them.
class Words {
public:
    explicit Words(std::string verb) : verb_(std::move(verb)) {}

    void add(const std::string& word) { words_.push_back(word); }
    void add(const std::string& option, const std::string& value) {
        words_.insert(words_.end(), {option, value});
    }
    std::string text() const {
        return shell_text(verb_, words_).substr(std::string("lucerna ").size());
    }

private:
    std::string verb_;
    std::vector<std::string> words_;
};

/// --vary with the names that files have in the pack.
std::string renamed_variation(const PackedScene& pack, const std::string& path,
                              const std::string& list) {
    const char* const separator = list.find(';') == std::string::npos ? "," : ";";
    std::string text = path + "=";
    for (const std::string& value : varied_values(list)) {
        if (text.back() != '=') text += separator;
        text += pack.renamed(path + "=" + value).substr(path.size() + 1);
    }
    return text;
}

void add_scene(Words& words, const PackedScene& pack) {
    words.add("scene/" + pack.name);
    for (const std::string& text : pack.overrides) words.add("--set", text);
    if (pack.has_plugins) words.add("--plugins", "plugins");
}

/// What --round and --collect have in common.
Words comparison_words(const Request& request, const PackedScene& pack,
                       const std::string& reference) {
    Words words("compare");
    add_scene(words, pack);
    for (const auto& [path, list] : request.varied) {
        words.add("--vary", renamed_variation(pack, path, list));
    }
    const RenderBudget& budget = request.budget;
    if (budget.samples) words.add("--spp", std::to_string(*budget.samples));
    if (budget.seconds) words.add("--time", fmt::format("{}", *budget.seconds));
    if (budget.error) words.add("--error", fmt::format("{}", *budget.error));
    words.add("--repeats", std::to_string(request.repeats));
    if (request.seed != 0) words.add("--seed", std::to_string(request.seed));
    if (request.reference == "auto") {
        words.add("--reference-spp", std::to_string(*reference_budget(request).samples));
    } else {
        words.add("--reference", reference);
    }
    words.add("--quiet");
    return words;
}

JobCommands job_commands(const Request& request, const PackedScene& pack,
                         const std::string& reference) {
    const std::string threads = " \\\n    -o \"parts/$part.exr\" --threads \"$threads\"";
    const Words common = comparison_words(request, pack, reference);
    JobCommands commands;
    commands.program = fs::canonical("/proc/self/exe").string();
    commands.part = common.text() + " \\\n    --round \"$part\"" + threads;
    commands.goes_on = false;
    if (const int parts = reference_parts(request); parts > 0) {
        Words render("render");
        add_scene(render, pack);
        render.add("--spp", std::to_string(*reference_budget(request).samples));
        render.add("--seed", std::to_string(reference_seed(request)));
        render.add("--quiet");
        commands.other =
            render.text() +
            fmt::format(" \\\n    --part \"$((part - {}))/{}\"", request.repeats, parts) + threads;
        commands.other_after = request.repeats;
    }
    Words merge = common;
    if (request.oracle) {
        merge.add("--oracle");
        merge.add("--oracle-points", std::to_string(request.oracle_points));
    }
    merge.add("--collect");
    merge.add("-o", ".");
    commands.merge = merge.text();
    commands.slurm_options = request.slurm_options;
    return commands;
}

/// Part n of the job is missing. Throws Error.
[[noreturn]] void fail_missing(const Request& request, const std::vector<int>& missing, int all) {
    std::string names;
    for (const int part : missing) {
        const bool is_round = part <= request.repeats;
        names += fmt::format("{}parts/{}.exr ({} {})", names.empty() ? "" : ", ", part,
                             is_round ? "round" : "reference part",
                             is_round ? part : part - request.repeats);
    }
    throw Error(
        fmt::format("{} of {} parts of the comparison are missing: {}; `lucerna farm {}` "
                    "with --submit or --local N runs them",
                    missing.size(), all, names, request.output));
}

fs::path part_file(const Request& request, int part) {
    return fs::path(request.output) / "parts" / fmt::format("{}.exr", part);
}

Reference collected_reference(const Request& request, const RoundSettings& settings) {
    const Session session(settings.session);
    std::vector<fs::path> files;
    for (int part = 1; part <= reference_parts(request); ++part) {
        files.push_back(part_file(request, request.repeats + part));
    }
    const RenderState state = merge_states(files);
    const RenderIdentity identity = session.identity(reference_seed(request));
    if (state.identity.scene_hash != identity.scene_hash || state.identity.seed != identity.seed ||
        state.film.complete_samples() != *reference_budget(request).samples) {
        throw Error(
            fmt::format("{} is no part of the reference of this comparison: its scene, "
                        "seed or samples are others",
                        files.front().string()));
    }
    const fs::path path = fs::path(request.output) / "reference.exr";
    write_state(path, state.film, identity, state.seconds, session.record(state.part.roundings));
    return reference_from(state, path);
}

/// Throws Error unless the round fits to the reference and to those before.
void check_round(const Round& round, int number, const fs::path& path,
                 const ComparisonResult& result) {
    const Image& reference = result.reference.image;
    const auto refuse = [&](const std::string& what) {
        throw Error(fmt::format("{} does not belong here: {}", path.string(), what));
    };
    if (round.repeat + 1 != number) refuse(fmt::format("it is round {}", round.repeat + 1));
    if (round.runs.size() != result.variants.size()) refuse("it has other variants");
    for (std::size_t v = 0; v < round.runs.size(); ++v) {
        const std::vector<Run>& others = result.variants[v].runs;
        const RenderFigures& figures = round.runs[v].figures;
        if (!others.empty() && others.front().figures.scene_hash != figures.scene_hash) {
            refuse("its scene is not that of round 1");
        }
        const Image& image = round.runs[v].snapshots.back().image;
        if (image.width != reference.width || image.height != reference.height) {
            refuse(fmt::format("it has {} x {} pixels, and the reference {} x {}", image.width,
                               image.height, reference.width, reference.height));
        }
    }
}

}  // namespace

JobFolder pack_comparison(const Request& request, const std::vector<Variant>& variants) {
    if (JobFolder::is_job(request.output)) {
        throw Error(fmt::format("{} is the folder of a job already; give another one, or remove it",
                                request.output));
    }
    const SessionSettings settings = session_settings(request);
    const Session session(settings);
    std::vector<SessionSettings> changed;
    for (const Variant& variant : variants) changed.push_back(settings_for(settings, variant));
    make_folder(request.output);
    std::string reference;
    Vector2i size = film_layout(session.scene()).crop.size;
    if (request.reference != "auto") {
        const Image image = read_reference(request.reference).image;
        size = {image.width, image.height};
        reference = "reference" + fs::path(request.reference).extension().string();
        put_copy(request.reference, fs::path(request.output) / reference);
    }
    const PackedScene pack = pack_scene(
        session, settings, request.output, changed, [&](std::size_t v, const Session& variant) {
            check_size(variants[v], film_layout(variant.scene()).crop.size, size);
        });
    const std::string name = fs::path(pack.name).stem().string();
    const JobFolder job(request.output, name, request.repeats + reference_parts(request), "exr");
    write_job(job, job_commands(request, pack, reference));
    return job;
}

int render_round_file(const Request& request, const RoundSettings& settings) {
    check_writable(request.output);
    const InterruptGuard guard;
    if (!warm_up(settings, [](const Variant&, const Session&) {})) return exit_code::interrupted;
    Round round{.repeat = request.round - 1};
    round.runs.resize(settings.variants.size());
    const std::optional<Machine> machine =
        render_round(settings, round.repeat, [&](std::size_t variant, RunRecord run) {
            if (!request.quiet) {
                fmt::print(stderr, "round {} of {}: {}: build {:.2f} s, render {:.2f} s, {} spp\n",
                           request.round, settings.repeats, settings.variants[variant].name,
                           run.figures.build_seconds, run.render_seconds, run.figures.samples);
            }
            round.runs[variant] = std::move(run);
        });
    if (!machine) return exit_code::interrupted;
    round.machine = *machine;
    write_round(request.output, round, comparison_text(settings));
    return exit_code::success;
}

void collect_parts(const Request& request, const RoundSettings& settings,
                   ComparisonResult& result) {
    const int all = request.repeats + reference_parts(request);
    std::vector<int> missing;
    for (int part = 1; part <= all; ++part) {
        if (!fs::exists(part_file(request, part))) missing.push_back(part);
    }
    if (!missing.empty()) fail_missing(request, missing, all);
    result.reference = request.reference == "auto" ? collected_reference(request, settings)
                                                   : read_reference(request.reference);
    const std::string text = comparison_text(settings);
    for (int number = 1; number <= request.repeats; ++number) {
        const fs::path path = part_file(request, number);
        Round round = read_round(path, text);
        check_round(round, number, path, result);
        result.machines.push_back(round.machine);
        for (std::size_t v = 0; v < round.runs.size(); ++v) {
            add_run(result, v, round.repeat, std::move(round.runs[v]));
        }
    }
}

}  // namespace lucerna
