// SPDX-License-Identifier: Apache-2.0
/// farm: renders one picture on many machines, by Slurm or by several processes.
///
/// A scene is packed into a folder that all machines can read, with a script for its parts and one
/// that merges them (jobs/job_folder.h). docs/many_machines.md tells how to use it.
#include "core/interfaces/command.h"
#include "core/interfaces/sampler.h"
#include "core/render/interrupt.h"
#include "plugins/commands/jobs/file_store.h"
#include "plugins/commands/jobs/job_scripts.h"
#include "plugins/commands/jobs/job_status.h"
#include "plugins/commands/jobs/local_run.h"
#include "plugins/commands/jobs/scene_pack.h"
#include "plugins/commands/jobs/slurm.h"
#include "plugins/commands/scene_options.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>

namespace lucerna {

namespace {

namespace fs = std::filesystem;

/// Slurm's default for MaxArraySize allows no number above it.
constexpr int most_parts = 1000;

/// What the command line says; `scene` may also be the folder of a job.
struct Request : SceneOptions {
    std::string output;
    int parts = 0, local = 0;
    std::optional<std::uint64_t> samples;
    std::optional<double> seconds;
    std::uint64_t seed = 0;
    std::vector<std::string> slurm_options;
    bool submit = false, status = false, quiet = false, json = false;
};

void declare_job(Arguments& arguments, Request& request) {
    arguments.positional("SCENE", request.scene,
                         "an XML file to be packed into a new job, or the folder of a job");
    arguments.option("--parts", "N", request.parts, {.min = 1, .max = most_parts},
                     "of how many parts the samples are made; one node renders each");
    arguments.option("--spp", "N", request.samples, {.min = 1, .max = 1 << 30},
                     "samples per pixel of all parts together; by default the sampler's "
                     "sample_count");
    arguments.option("-o,--output", "DIR", request.output,
                     "folder of the job, which all nodes must be able to read and write");
    arguments.option("--time", "SECONDS", request.seconds, positive,
                     "ends each part after this time, whatever it has; without, parts are whole");
    arguments.option("--seed", "N", request.seed, non_negative,
                     "another number, another noise; 0 by default");
    declare_scene_options(arguments, request);
    arguments.option("--slurm", "OPTION", request.slurm_options,
                     "an option of sbatch for the scripts, as --slurm=--partition=long; may be "
                     "repeated");
}

void declare_actions(Arguments& arguments, Request& request) {
    arguments.flag("--submit", request.submit,
                   "gives the parts that are not done to Slurm, and the merge after them");
    arguments.option("--local", "N", request.local, {.min = 1, .max = 1024},
                     "runs the same scripts here, N at a time, without Slurm");
    arguments.flag("--status", request.status, "shows how many parts are done, and time left");
    arguments.flag("-q,--quiet", request.quiet, "prints nothing but errors, and the status");
    arguments.flag("--json", request.json, "prints the status as JSON");
    arguments.footer(
        "lucerna farm scene.xml --parts 64 --spp 4096 -o out --submit   packs and submits\n"
        "lucerna farm out --status                                      how far it is\n\n"
        "Exit codes: 0 success, 1 failure (--status: a part or the merge has failed or was lost), "
        "2 wrong "
        "arguments, 3 wrong scene, 4 plugin cannot be loaded, 5 file cannot be read or written, "
        "130 interrupted.");
}

/// What is wrong with the arguments of an existing job, or empty.
std::string wrong_for_job(const Request& request) {
    const bool packs = request.parts != 0 || request.samples || request.seconds ||
                       request.seed != 0 || !request.output.empty() ||
                       !request.resolution.empty() || !request.defines.empty() ||
                       !request.overrides.empty() || !request.plugin_folders.empty() ||
                       !request.slurm_options.empty();
    if (!JobFolder::is_job(request.scene)) {
        return fmt::format(
            "{} is no folder of a job: there is no job.txt in it; `lucerna farm "
            "SCENE --parts N -o {}` makes one",
            request.scene, request.scene);
    }
    if (packs) {
        return fmt::format(
            "{} is packed already: only --submit, --local, --status, --quiet and "
            "--json go with it; change its scripts, or pack the scene anew",
            request.scene);
    }
    if (!request.submit && !request.status && request.local == 0) {
        return fmt::format("what is to be done with {}? Give --submit, --local N or --status",
                           request.scene);
    }
    return "";
}

/// What is wrong with the arguments taken together, or empty.
std::string contradiction(const Request& request) {
    if (int(request.submit) + int(request.status) + int(request.local > 0) > 1) {
        return "give only one of --submit, --local and --status";
    }
    if (request.json && !request.status) return "--json goes with --status";
    if (fs::is_directory(request.scene)) return wrong_for_job(request);
    if (request.status) return "--status needs the folder of a job instead of a scene";
    if (request.parts == 0) return "--parts N is missing: of how many parts the job is made";
    if (request.output.empty()) return "-o DIR is missing: the folder of the job";
    if (JobFolder::is_job(request.output)) {
        return fmt::format("{} is the folder of a job already; give another one, or remove it",
                           request.output);
    }
    for (const std::string& option : request.slurm_options) {
        if (option.starts_with("--") && option.find('\n') == std::string::npos) continue;
        return fmt::format("--slurm {} is no option of sbatch: expected --NAME=VALUE",
                           quote(option));
    }
    return "";
}

/// The verb and its words as a shell reads them.
std::string words_text(const std::string& verb, const std::vector<std::string>& words) {
    return shell_text(verb, words).substr(std::string("lucerna ").size());
}

JobCommands job_commands(const Request& request, const PackedScene& pack, std::uint64_t samples,
                         const std::string& name) {
    std::vector<std::string> words = {"scene/" + pack.name, "--spp", std::to_string(samples),
                                      "--quiet"};
    const auto add = [&](const char* option, const std::string& value) {
        words.insert(words.end(), {option, value});
    };
    if (request.seconds) add("--time", fmt::format("{}", *request.seconds));
    if (request.seed != 0) add("--seed", std::to_string(request.seed));
    for (const std::string& text : pack.overrides) add("--set", text);
    if (pack.has_plugins) add("--plugins", "plugins");
    JobCommands commands;
    commands.program = fs::canonical("/proc/self/exe").string();
    commands.part = words_text("render", words) +
                    fmt::format(
                        " \\\n    --part \"$part/{}\" -o \"parts/$part.exr\" --threads "
                        "\"$threads\"",
                        request.parts);
    commands.merge = fmt::format("merge parts/*.exr -o {}", name);
    commands.slurm_options = request.slurm_options;
    return commands;
}

JobFolder pack_job(const Request& request) {
    const SessionSettings settings = session_settings(request);
    const Session session(settings);
    if (!request.quiet) {
        for (const Diagnostic& warning : session.warnings()) {
            fmt::print(stderr, "{}\n", warning.text());
        }
    }
    const std::uint64_t samples = request.samples.value_or(
        static_cast<std::uint64_t>(session.scene().sensor().sampler().sample_count()));
    if (static_cast<std::uint64_t>(request.parts) > samples) {
        throw Error(
            fmt::format("{} samples per pixel cannot be divided into {} parts; give more "
                        "--spp or fewer --parts",
                        samples, request.parts));
    }
    make_folder(request.output);
    const PackedScene pack = pack_scene(session, settings, request.output);
    const std::string name = fs::path(pack.name).stem().string();
    const JobFolder job(request.output, name, request.parts, "exr");
    write_job(job, job_commands(request, pack, samples, name));
    return job;
}

int show_status(const Request& request, const JobFolder& job) {
    const std::int64_t now = std::chrono::duration_cast<std::chrono::seconds>(
                                 std::chrono::system_clock::now().time_since_epoch())
                                 .count();
    const JobStatus status = job_status(job, now, slurm_states(job));
    fmt::print("{}", request.json ? to_json(job, status).text() : status_text(job, status));
    return status.broken() ? exit_code::failure : exit_code::success;
}

int run_job(const Request& request) {
    const JobFolder job =
        fs::is_directory(request.scene) ? JobFolder::read(request.scene) : pack_job(request);
    if (request.status) return show_status(request, job);
    if (request.local > 0) return run_locally(job, request.local, request.quiet);
    if (request.submit) submit(job);
    if (!request.quiet) {
        const std::string folder = job.path().string();
        fmt::print("{}\n{}\n", job.part_script().string(), job.merge_script().string());
        fmt::print("next: lucerna farm {} {}\n", folder,
                   request.submit ? "--status" : "--submit, or --local N");
    }
    return exit_code::success;
}

class FarmCommand final : public Command {
public:
    explicit FarmCommand(const Params&) {}

    int run(const std::vector<std::string>& words) const override {
        Request request;
        Arguments arguments("farm", "Renders one picture on many machines.");
        declare_job(arguments, request);
        declare_actions(arguments, request);
        if (const std::optional<int> code = arguments.parse(words)) return *code;
        const std::string problem = contradiction(request);
        if (!problem.empty()) {
            fmt::print(stderr, "lucerna farm: {}\n", problem);
            return exit_code::usage;
        }
        ignore_write_signals();
        return run_job(request);
    }
};

}  // namespace

const PluginInfo plugin = describe<FarmCommand>("renders one picture on many machines");

}  // namespace lucerna
