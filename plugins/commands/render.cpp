// SPDX-License-Identifier: Apache-2.0
/// render: makes a picture of a scene.
///
/// Passes over the image until a budget of samples, time or error is spent; then, or after SIGINT
/// and SIGTERM, an EXR and a PNG are written, each completely or not at all. A checkpoint holds
/// the exact state: resuming gives the bits of a render that was never interrupted.
#include "core/command_line/arguments.h"
#include "core/image/atomic_file.h"
#include "core/interfaces/command.h"
#include "core/render/interrupt.h"
#include "core/render/output.h"
#include "core/render/preview_feed.h"
#include "core/render/progress.h"
#include "core/render/session.h"

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>

namespace lucerna {

namespace {

namespace fs = std::filesystem;

/// What the command line says.
struct Request {
    std::string scene, output, checkpoint, view, preview;
    RenderBudget budget;
    std::uint64_t seed = 0;
    int threads = 0;
    std::vector<int> resolution, crop;
    std::vector<std::pair<std::string, std::string>> defines;
    std::vector<std::string> overrides, plugin_folders;
    double checkpoint_seconds = 60, exposure = 0;
    bool resume = false, quiet = false, json = false, json_progress = false;
};

void declare_what(Arguments& arguments, Request& request) {
    arguments.positional("SCENE", request.scene, "an XML file in Mitsuba's format");
    arguments.option("-o,--output", "FILE", request.output,
                     "the pictures: FILE.exr (linear, all layers) and FILE.png (as displayed); by "
                     "default they are named after the scene, in the current directory");
    arguments.option("--resolution", "WxH", request.resolution, 'x', 2, {.min = 1, .max = 65536},
                     "size of the whole image [pixels]");
    arguments.option("--crop", "X,Y,W,H", request.crop, ',', 4, {.min = 0, .max = 65536},
                     "renders this part only; it is exactly a part of the whole image");
    arguments.option("-D,--define", "NAME=VALUE", request.defines,
                     "value of $NAME in the scene; may be repeated");
    arguments.option("--set", "PATH=VALUE", request.overrides,
                     "changes the scene, for example integrator.max_depth=8 or "
                     "integrator.light_sampler=power; may be repeated");
    arguments.option("--plugins", "DIR", request.plugin_folders,
                     "looks for plugins in DIR first; may be repeated");
    arguments.option("--seed", "N", request.seed, non_negative,
                     "another number, another noise; 0 by default");
    arguments.option("--threads", "N", request.threads, {.min = 0, .max = 4096},
                     "0, the default: one for each processor");
}

void declare_how(Arguments& arguments, Request& request) {
    arguments.option("--spp", "N", request.budget.samples, {.min = 1, .max = 1 << 30},
                     "samples per pixel; unless there is a limit, the sampler's sample_count");
    arguments.option("--time", "SECONDS", request.budget.seconds, positive,
                     "time to render, without loading and building");
    arguments.option("--error", "RELMSE", request.budget.error, positive,
                     "renders until the estimate of the relative mean squared error is below this");
    arguments.option("--checkpoint", "FILE", request.checkpoint,
                     "keeps the state of the render in this EXR file");
    arguments.option("--checkpoint-every", "SECONDS", request.checkpoint_seconds, positive,
                     "60 by default; it is also written at the end");
    arguments.flag("--resume", request.resume,
                   "continues from the checkpoint, if the file is there; exactly as if the render "
                   "had never stopped");
    arguments.option("--view", "DISPLAY/VIEW", request.view,
                     "of the PNG; `lucerna tonemap --list` shows all");
    arguments.option("--exposure", "EV", request.exposure, {.min = -100, .max = 100},
                     "of the PNG, in factors of two");
    arguments.flag("-q,--quiet", request.quiet, "prints nothing but warnings and errors");
    arguments.flag("--json", request.json, "prints the figures as JSON");
    arguments.flag("--json-progress", request.json_progress,
                   "prints a line of JSON a second, and the figures in the last one");
    arguments.option(
        "--preview", "WHERE", request.preview,
        "shows the picture while it grows: tev, or HOST:PORT where tev listens; web or "
        "web:PORT, a page for browsers on this machine that can also stop the render, "
        "or web:ADDRESS:PORT for others; its address is printed even with --quiet");
    arguments.footer(
        "The first limit that is reached ends the render. SIGINT and SIGTERM end it, too: pictures "
        "and checkpoint are written if there is any sample, and the exit code is 130.\n\n"
        "Exit codes: 0 success, 1 failure, 2 wrong arguments, 3 wrong scene or colour "
        "configuration, 4 plugin cannot be loaded, 5 file cannot be read or written, 130 "
        "interrupted.");
}

/// What is wrong with the arguments taken together, or empty.
std::string contradiction(const Request& request) {
    if (request.json && request.json_progress) {
        return "--json-progress ends with the figures that --json prints; give one of them";
    }
    if (request.checkpoint.empty()) return request.resume ? "--resume needs --checkpoint FILE" : "";
    const PicturePaths pictures(request.output, request.scene);
    const fs::path checkpoint = fs::weakly_canonical(request.checkpoint);
    for (const fs::path& picture : {pictures.exr, pictures.png}) {
        if (checkpoint != fs::weakly_canonical(picture)) continue;
        return fmt::format("the picture {} would replace the checkpoint; give them different names",
                           picture.string());
    }
    return "";
}

SessionSettings session_settings(const Request& request) {
    SessionSettings settings;
    settings.scene = request.scene;
    settings.threads = request.threads;
    settings.defines = request.defines;
    settings.overrides = request.overrides;
    settings.plugin_folders.assign(request.plugin_folders.begin(), request.plugin_folders.end());
    const auto set_film = [&](const char* name, int value) {
        settings.overrides.push_back(fmt::format("sensor.film.{}={}", name, value));
    };
    if (!request.resolution.empty()) {
        set_film("width", request.resolution[0]);
        set_film("height", request.resolution[1]);
    }
    if (!request.crop.empty()) {
        set_film("crop_offset_x", request.crop[0]);
        set_film("crop_offset_y", request.crop[1]);
        set_film("crop_width", request.crop[2]);
        set_film("crop_height", request.crop[3]);
    }
    return settings;
}

bool is_black(const FilmState& film) {
    for (std::size_t pixel = 0; pixel < film.pixel_count(); ++pixel) {
        for (std::size_t channel = 0; channel < 3; ++channel) {
            if (film.mean(pixel, channel) != 0) return false;
        }
    }
    return true;
}

/// What the command line asks for, opened; null if it asks for none.
std::unique_ptr<Preview> preview_of(const Request& request) {
    if (request.preview.empty()) return nullptr;
    Registry registry({request.plugin_folders.begin(), request.plugin_folders.end()});
    return open_preview(registry, request.preview,
                        {.name = PicturePaths(request.output, request.scene).exr.string(),
                         .exposure = request.exposure,
                         .stop = InterruptGuard::interrupt});
}

/// The progress that is shown.
Progress::Mode progress_mode(const Request& request) {
    return request.json_progress ? Progress::Mode::json : Progress::choose(request.quiet);
}

/// One run of the command.
class Rendering {
public:
    /// `preview` may be null.
    Rendering(const Request& request, std::string command, PictureView view, Preview* preview)
        : request_(request),
          command_(std::move(command)),
          view_(std::move(view)),
          paths_(request.output, request.scene),
          session_(session_settings(request)),
          progress_(progress_mode(request)),
          preview_(preview) {}

    int run();

private:
    void check_files() const;
    std::optional<RenderState> previous_state() const;
    RenderOptions options(double earlier_seconds);
    void report(const RenderStatus& status);
    void keep(const FilmState& film, double seconds, double earlier_seconds);
    void save_state(const FilmState& film, double seconds) const;
    void print_warning_of_preview();
    Json summary(const RenderResult& result) const;
    void print(const RenderResult& result) const;

    const Request& request_;
    std::string command_;
    PictureView view_;
    PicturePaths paths_;
    Session session_;
    Progress progress_;
    Preview* preview_;
    std::optional<PreviewFeed> feed_;
    double last_checkpoint_ = 0;
};

int Rendering::run() {
    for (const Diagnostic& warning : session_.warnings()) {
        fmt::print(stderr, "{}\n", warning.text());
    }
    check_files();
    std::optional<RenderState> state = previous_state();
    const double earlier_seconds = state ? state->seconds : 0;

    const InterruptGuard guard;
    if (preview_) feed_.emplace(*preview_, request_.threads);
    const RenderResult result = session_.render(options(earlier_seconds), std::move(state));
    progress_.clear();
    if (result.interrupted && result.film.most_samples() == 0) {
        // What may lie there already is worth more than black pictures.
        fmt::print(stderr, "interrupted before the first sample: nothing was written\n");
        return exit_code::interrupted;
    }
    const double seconds = earlier_seconds + result.figures.render_seconds;
    std::exception_ptr no_checkpoint;
    try {
        if (!request_.checkpoint.empty()) save_state(result.film, seconds);
    } catch (const FileError&) {
        no_checkpoint = std::current_exception();  // there can still be pictures
    }
    write_pictures(session_.scene().sensor().film(),
                   annotated_image(result, command_, request_.scene), paths_, view_);
    fmt::print(stderr, "{}", figures_warnings(result.figures));
    if (session_.scene().lights().empty() && is_black(result.film)) {
        fmt::print(stderr,
                   "warning: the picture is black: the scene has no light; add an <emitter>\n");
    }
    print(result);
    if (feed_) {
        feed_->finish(result.film, result.figures);
        print_warning_of_preview();
    }
    if (no_checkpoint) std::rethrow_exception(no_checkpoint);
    return result.interrupted ? exit_code::interrupted : exit_code::success;
}

void Rendering::check_files() const {
    paths_.check();
    if (!request_.checkpoint.empty()) check_writable(request_.checkpoint);
}

std::optional<RenderState> Rendering::previous_state() const {
    if (!request_.resume) return {};
    if (!fs::exists(request_.checkpoint)) {
        if (!request_.quiet) {
            fmt::print(stderr, "{} is not there yet: rendering from the first sample\n",
                       request_.checkpoint);
        }
        return {};
    }
    RenderState state = read_state(request_.checkpoint);
    check_continues(state, film_layout(session_.scene()), session_.identity(request_.seed),
                    request_.checkpoint);
    const std::uint64_t done = state.film.complete_samples();
    const bool finished = request_.budget.samples && done >= *request_.budget.samples;
    if (!request_.quiet) {
        fmt::print(stderr, "{} has {} samples per pixel{}\n", request_.checkpoint, done,
                   finished ? ": nothing is left to render" : "");
    }
    return state;
}

RenderOptions Rendering::options(double earlier_seconds) {
    RenderOptions options;
    options.budget = request_.budget;
    options.seed = request_.seed;
    options.interrupted = InterruptGuard::interrupted;
    const bool shown = feed_ || request_.json_progress || !request_.quiet;
    if (shown) options.progress = [this](const RenderStatus& status) { report(status); };
    options.after_pass = [this, earlier_seconds](const RenderStatus& status,
                                                 const FilmState& film) {
        if (feed_) feed_->after_pass(status, film);
        keep(film, status.seconds, earlier_seconds);
    };
    return options;
}

void Rendering::report(const RenderStatus& status) {
    progress_.update(status);
    if (!feed_) return;
    feed_->update(status);
    print_warning_of_preview();
}

/// Writes the checkpoint if it is due.
void Rendering::keep(const FilmState& film, double seconds, double earlier_seconds) {
    if (request_.checkpoint.empty()) return;
    if (seconds < last_checkpoint_ + request_.checkpoint_seconds) return;
    last_checkpoint_ = seconds;
    try {
        save_state(film, earlier_seconds + seconds);
    } catch (const FileError& e) {
        // The render is worth more than this checkpoint; the last one is still there.
        progress_.clear();
        fmt::print(stderr, "warning: no checkpoint: {}\n", e.what());
    }
}

void Rendering::save_state(const FilmState& film, double seconds) const {
    write_state(request_.checkpoint, film, session_.identity(request_.seed), seconds);
}

void Rendering::print_warning_of_preview() {
    const std::optional<std::string> warning = feed_->take_warning();
    if (!warning) return;
    progress_.clear();
    fmt::print(stderr, "warning: {}\n", *warning);
}

Json Rendering::summary(const RenderResult& result) const {
    Json json = Json::object();
    json.set("schema", 1);
    if (request_.json_progress) json.set("state", "finished");
    json.set("scene", request_.scene);
    json.set("images", std::vector<std::string>{paths_.exr.string(), paths_.png.string()});
    if (!request_.checkpoint.empty()) json.set("checkpoint", request_.checkpoint);
    json.set("interrupted", result.interrupted);
    return json.set("figures", to_json(result.figures));
}

void Rendering::print(const RenderResult& result) const {
    if (request_.json_progress) {
        fmt::print("{}", summary(result).line());
    } else if (request_.json) {
        fmt::print("{}", summary(result).text());
    } else if (!request_.quiet) {
        fmt::print("{}{}\n{}\n{}\n", result.interrupted ? "interrupted; " : "",
                   figures_text(result.figures), paths_.exr.string(), paths_.png.string());
    }
    std::fflush(stdout);
}

class RenderCommand final : public Command {
public:
    explicit RenderCommand(const Params&) {}

    int run(const std::vector<std::string>& words) const override {
        Request request;
        Arguments arguments("render", "Makes a picture of a scene.");
        declare_what(arguments, request);
        declare_how(arguments, request);
        if (const std::optional<int> code = arguments.parse(words)) return *code;
        const std::string problem = contradiction(request);
        if (!problem.empty()) {
            fmt::print(stderr, "lucerna render: {}\n", problem);
            return exit_code::usage;
        }
        ignore_write_signals();
        std::optional<PictureView> view;
        try {
            view = picture_view(request.view, request.exposure);
        } catch (const Error& e) {
            fmt::print(stderr, "lucerna render: {}\n", e.what());
            return exit_code::scene;
        }
        std::unique_ptr<Preview> preview;
        try {
            preview = preview_of(request);
        } catch (const PluginError&) {
            throw;
        } catch (const Error& e) {
            fmt::print(stderr, "lucerna render: --preview {}: {}\n", request.preview, e.what());
            return exit_code::usage;
        }
        return Rendering(request, shell_text("render", words), std::move(*view), preview.get())
            .run();
    }
};

}  // namespace

const PluginInfo plugin = describe<RenderCommand>("makes a picture of a scene");

}  // namespace lucerna
