// SPDX-License-Identifier: Apache-2.0
/// merge: the parts of a render, from `lucerna render --part`, become the whole picture, bit for
/// bit the one that a single machine would have made.
#include "core/render/merge.h"
#include "core/base/atomic_file.h"
#include "core/command_line/arguments.h"
#include "core/render/interrupt.h"
#include "core/render/output.h"
#include "core/render/stored_film.h"
#include "plugins/commands/try_again.h"

#include <fmt/format.h>

#include <sys/resource.h>

#include <cstdio>
#include <filesystem>

namespace lucerna {

namespace {

namespace fs = std::filesystem;

struct Request {
    std::vector<std::string> files, plugin_folders;
    std::string output, state, view;
    double exposure = 0;
    bool partial = false, quiet = false, json = false;
};

void declare(Arguments& arguments, Request& request) {
    arguments.option("-o,--output", "FILE", request.output,
                     "the pictures: FILE.exr (linear, all layers) and FILE.png (as displayed)");
    arguments.option("--state", "FILE", request.state,
                     "also writes the state of all samples, for `lucerna render --checkpoint FILE "
                     "--resume` and for merging it further");
    arguments.flag("--partial", request.partial,
                   "makes a picture although parts are absent, of the samples that are there");
    arguments.option("--view", "DISPLAY/VIEW", request.view,
                     "of the PNG; `lucerna tonemap --list` shows all");
    arguments.option("--exposure", "EV", request.exposure, {.min = -100, .max = 100},
                     "of the PNG, in factors of two");
    arguments.option("--plugins", "DIR", request.plugin_folders,
                     "looks for plugins in DIR first; may be repeated");
    arguments.flag("-q,--quiet", request.quiet, "prints nothing but warnings and errors");
    arguments.flag("--json", request.json, "prints the figures as JSON");
    arguments.positional("STATE", request.files,
                         "files of `lucerna render --part`, of `lucerna merge --state`, or "
                         "checkpoints");
    arguments.footer(
        "The order of the files does not matter, nor whether they are merged at once or in "
        "steps.\n\n"
        "Exit codes: 0 success, 1 the files do not fit together or samples are missing, 2 wrong "
        "arguments, 3 wrong colour configuration, 4 plugin cannot be loaded, 5 file cannot be read "
        "or written, 75 it cannot now, but may be later.");
}

/// What is wrong with the arguments taken together, or empty.
std::string contradiction(const Request& request) {
    if (request.files.empty()) return "name the files to be merged";
    if (request.output.empty() && request.state.empty()) {
        return "name the picture with --output, or the state with --state";
    }
    if (request.output.empty()) return "";
    const PicturePaths pictures(request.output, "");
    std::vector<std::string> others = request.files;
    if (!request.state.empty()) others.push_back(request.state);
    for (const std::string& other : others) {
        for (const fs::path& picture : {pictures.exr, pictures.png}) {
            if (fs::weakly_canonical(other) != fs::weakly_canonical(picture)) continue;
            return fmt::format("the picture {} would replace a state; give it another name",
                               picture.string());
        }
    }
    return "";
}

/// The figures of the whole, as far as parts can tell them.
RenderFigures figures_of(const RenderState& state) {
    RenderFigures figures;
    figures.earlier_seconds = state.seconds;
    describe_film(state.film, figures);
    figures.peak_memory = peak_memory();
    figures.seed = state.identity.seed;
    figures.scene_hash = state.identity.scene_hash;
    figures.light_sampler = state.part.light_sampler;
    return figures;
}

/// From the beginning of the first part to the end of the last one, if they tell.
std::optional<double> wall_seconds(const PartRecord& part) {
    return part.begin > 0 ? std::optional(part.end - part.begin) : std::nullopt;
}

/// Throws Error, unless `partial`, if parts are absent; tells which samples are missing.
void tell_missing(const PartRecord& part, bool partial) {
    const SampleRanges absent = absent_samples(part), unfinished = unfinished_samples(part);
    if (!absent.empty()) {
        const std::string what = fmt::format("{} of {} samples per pixel are missing: {}",
                                             absent.size(), part.all_samples, absent.text());
        if (!partial) {
            throw Error(what + "; render the parts that have them, or merge with --partial");
        }
        fmt::print(stderr, "warning: {}\n", what);
    }
    if (!unfinished.empty()) {
        fmt::print(stderr,
                   "note: {} samples per pixel are left out, since the --time of their "
                   "parts was over: {}\n",
                   unfinished.size(), unfinished.text());
    }
}

/// All parts are open at once, and there may be more than a process may open at first.
void allow_many_files() {
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
}

class Merge {
public:
    Merge(const Request& request, std::string command)
        : request_(request), command_(std::move(command)), paths_(request.output, "") {}

    int run() {
        std::optional<PictureView> view;
        if (!request_.output.empty()) {
            view = picture_view(request_.view, request_.exposure);
            paths_.check();
        }
        if (!request_.state.empty()) check_writable(request_.state);
        RenderState state = merge_states({request_.files.begin(), request_.files.end()});
        tell_missing(state.part, request_.partial);
        const RenderFigures figures = figures_of(state);
        if (!request_.state.empty()) {
            write_state(request_.state, state.film, state.identity, state.seconds, state.part);
        }
        if (view) write_picture(state, figures, *view);
        fmt::print(stderr, "{}{}", rounding_warning(state.part), figures_warnings(figures));
        print(state, figures);
        return exit_code::success;
    }

private:
    void write_picture(const RenderState& state, const RenderFigures& figures,
                       const PictureView& view);
    void print(const RenderState& state, const RenderFigures& figures) const;

    const Request& request_;
    std::string command_;
    PicturePaths paths_;
    std::vector<fs::path> pictures_;  ///< that have been written
};

void Merge::write_picture(const RenderState& state, const RenderFigures& figures,
                          const PictureView& view) {
    Registry registry({request_.plugin_folders.begin(), request_.plugin_folders.end()});
    const StoredFilm film(state.part.film, registry);
    ImageFile image = annotated_image(state.film, figures, command_, state.part.scene);
    // What only the machines that rendered know.
    for (const char* name : {"build_seconds", "rays_per_second", "threads"}) {
        image.metadata.erase(image.metadata.find(fmt::format("lucerna:{}", name)));
    }
    image.metadata["lucerna:parts"] = state.part.parts;
    image.metadata["lucerna:samples"] = state.part.samples.text();
    if (const auto wall = wall_seconds(state.part)) image.metadata["lucerna:wall_seconds"] = *wall;
    pictures_ = write_pictures(*film, image, paths_, view);
}

void Merge::print(const RenderState& state, const RenderFigures& figures) const {
    const PartRecord& part = state.part;
    if (request_.json) {
        Json json = Json::object();
        json.set("schema", 1).set("scene", part.scene).set("parts", part.parts);
        json.set("samples", part.samples.text()).set("all_samples", part.all_samples);
        json.set("missing_samples", absent_samples(part).text());
        json.set("unfinished_samples", unfinished_samples(part).text());
        if (const auto wall = wall_seconds(part)) json.set("wall_seconds", *wall);
        if (!request_.output.empty()) {
            json.set("images", std::vector<std::string>(pictures_.begin(), pictures_.end()));
        }
        if (!request_.state.empty()) json.set("state", request_.state);
        json.set("figures", to_json(figures));
        fmt::print("{}", json.text());
        return;
    }
    if (request_.quiet) return;
    fmt::print("{} parts: {} spp, rendered in {:.2f} s of all machines", part.parts,
               figures.samples, state.seconds);
    if (const auto wall = wall_seconds(part)) fmt::print(", {:.2f} s from begin to end", *wall);
    fmt::print("{}\n", error_text(figures));
    for (const fs::path& picture : pictures_) fmt::print("{}\n", picture.string());
    if (!request_.state.empty()) fmt::print("{}\n", request_.state);
}

class MergeCommand final : public Command {
public:
    explicit MergeCommand(const Params&) {}

    int run(const std::vector<std::string>& words) const override {
        Request request;
        Arguments arguments("merge", "Makes the whole picture of the parts of a render.");
        declare(arguments, request);
        if (const std::optional<int> code = arguments.parse(words)) return *code;
        ignore_write_signals();
        allow_many_files();
        return or_try_again([&] {
            const std::string problem = contradiction(request);
            if (problem.empty()) return Merge(request, shell_text("merge", words)).run();
            fmt::print(stderr, "lucerna merge: {}\n", problem);
            return exit_code::usage;
        });
    }
};

}  // namespace

const PluginInfo plugin =
    describe<MergeCommand>("makes the whole picture of the parts of a render");

}  // namespace lucerna
