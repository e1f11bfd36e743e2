// SPDX-License-Identifier: Apache-2.0
/// render: makes a picture of a scene.
///
/// Passes over the image until a budget of samples, time or error is spent; then, or after SIGINT
/// and SIGTERM, an EXR and a PNG are written, each completely or not at all. A checkpoint holds
/// the exact state: resuming gives the bits of a render that was never interrupted.
#include "core/base/atomic_file.h"
#include "core/render/interrupt.h"
#include "core/render/output.h"
#include "core/render/session.h"
#include "plugins/commands/render/display.h"
#include "plugins/commands/render/part.h"
#include "plugins/commands/render/request.h"
#include "plugins/commands/try_again.h"

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>

namespace lucerna {

namespace {

namespace fs = std::filesystem;

bool is_black(const FilmState& film) {
    for (std::size_t pixel = 0; pixel < film.pixel_count(); ++pixel) {
        for (std::size_t channel = 0; channel < 3; ++channel) {
            if (film.mean(pixel, channel) != 0) return false;
        }
    }
    return true;
}

/// Throws Error for states that have not all samples from the first one on.
void check_whole(const RenderState& state, const fs::path& path) {
    const SampleRanges& samples = state.part.samples;
    const std::vector<SampleRange>& ranges = samples.ranges();
    const bool whole = state.film.first_sample() == 0 && ranges.size() <= 1;
    if (whole) return;
    throw Error(
        fmt::format("cannot resume from {}: it is a part of a render, with samples {} "
                    "only; merge all parts with `lucerna merge --state`",
                    path.string(), samples.text()));
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
          display_(request, preview) {}

    int run();

private:
    void check_files() const;
    std::optional<RenderState> previous_state() const;
    RenderOptions options(double earlier_seconds);
    void keep(const FilmState& film, double seconds, double earlier_seconds);
    void save_state(const FilmState& film, double seconds) const;
    Json summary(const RenderResult& result) const;
    void print(const RenderResult& result) const;

    const Request& request_;
    std::string command_;
    PictureView view_;
    PicturePaths paths_;
    std::vector<std::filesystem::path> pictures_;  ///< that have been written
    Session session_;
    Display display_;
    std::set<std::uint64_t> roundings_;  ///< processors of the samples before this run
    double last_checkpoint_ = 0;
};

int Rendering::run() {
    for (const Diagnostic& warning : session_.warnings()) {
        fmt::print(stderr, "{}\n", warning.text());
    }
    check_files();
    std::optional<RenderState> state = previous_state();
    const double earlier_seconds = state ? state->seconds : 0;
    if (state) roundings_ = state->part.roundings;

    const InterruptGuard guard;
    display_.begin();
    const RenderResult result = session_.render(options(earlier_seconds), std::move(state));
    display_.clear();
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
    pictures_ = write_pictures(
        session_.scene().sensor().film(),
        annotated_image(result.film, result.figures, command_, request_.scene), paths_, view_);
    fmt::print(stderr, "{}", figures_warnings(result.figures));
    if (!roundings_.empty()) {
        fmt::print(stderr, "{}", rounding_warning(session_.record(roundings_)));
    }
    if (session_.scene().lights().empty() && is_black(result.film)) {
        fmt::print(stderr,
                   "warning: the picture is black: the scene has no light; add an <emitter>\n");
    }
    print(result);
    display_.finish(result.film, result.figures);
    if (no_checkpoint) std::rethrow_exception(no_checkpoint);
    return result.interrupted ? exit_code::interrupted : exit_code::success;
}

void Rendering::check_files() const {
    paths_.check(session_.scene().sensor().film().extension());
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
    check_whole(state, request_.checkpoint);
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
    if (!display_.is_idle()) {
        options.progress = [this](const RenderStatus& status) { display_.report(status); };
    }
    options.after_pass = [this, earlier_seconds](const RenderStatus& status,
                                                 const FilmState& film) {
        display_.after_pass(status, film);
        keep(film, status.seconds, earlier_seconds);
    };
    return options;
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
        display_.clear();
        fmt::print(stderr, "warning: no checkpoint: {}\n", e.what());
    }
}

void Rendering::save_state(const FilmState& film, double seconds) const {
    write_state(request_.checkpoint, film, session_.identity(request_.seed), seconds,
                session_.record(roundings_));
}

Json Rendering::summary(const RenderResult& result) const {
    Json json = Json::object();
    json.set("schema", 1);
    if (request_.json_progress) json.set("state", "finished");
    json.set("scene", request_.scene);
    json.set("images", std::vector<std::string>(pictures_.begin(), pictures_.end()));
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
        fmt::print("{}{}\n", result.interrupted ? "interrupted; " : "",
                   figures_text(result.figures));
        for (const auto& picture : pictures_) fmt::print("{}\n", picture.string());
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
        request.part = parse_part(request.part_text);
        const std::string problem = contradiction(request);
        if (!problem.empty()) {
            fmt::print(stderr, "lucerna render: {}\n", problem);
            return exit_code::usage;
        }
        ignore_write_signals();
        std::unique_ptr<Preview> preview;
        try {
            preview = preview_of(request);
        } catch (const PluginError&) {
            throw;
        } catch (const Error& e) {
            fmt::print(stderr, "lucerna render: --preview {}: {}\n", request.preview, e.what());
            return exit_code::usage;
        }
        if (request.part) {
            return or_try_again([&] { return PartRendering(request, preview.get()).run(); });
        }
        std::optional<PictureView> view;
        try {
            view = picture_view(request.view, request.exposure);
        } catch (const Error& e) {
            fmt::print(stderr, "lucerna render: {}\n", e.what());
            return exit_code::scene;
        }
        return Rendering(request, shell_text("render", words), std::move(*view), preview.get())
            .run();
    }
};

}  // namespace

const PluginInfo plugin = describe<RenderCommand>("makes a picture of a scene");

}  // namespace lucerna
