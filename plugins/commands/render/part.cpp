// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/render/part.h"

#include "core/base/atomic_file.h"
#include "core/interfaces/command.h"
#include "core/render/interrupt.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <system_error>
#include <utility>

namespace lucerna {

namespace {

/// Seconds since 1970.
double time_of_day() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

}  // namespace

PartRendering::PartRendering(const Request& request, Preview* preview)
    : request_(request),
      file_(request.output),
      checkpoint_(request.output + ".checkpoint"),
      session_(session_settings(request)),
      display_(request, preview),
      begin_(time_of_day()) {
    const int default_count = session_.scene().sensor().sampler().sample_count();
    all_samples_ = request.budget.samples.value_or(static_cast<std::uint64_t>(default_count));
    const auto [number, count] = *request.part;
    if (count > all_samples_) {
        throw Error(
            fmt::format("{} samples per pixel cannot make {} parts; raise --spp, or make "
                        "at most {} parts",
                        all_samples_, count, all_samples_));
    }
    range_ = samples_of_part(all_samples_, number, count);
}

int PartRendering::run() {
    for (const Diagnostic& warning : session_.warnings()) {
        fmt::print(stderr, "{}\n", warning.text());
    }
    check_writable(file_);
    check_writable(checkpoint_);
    std::optional<RenderState> state = kept(file_);
    if (state && is_finished(*state)) {
        remove_checkpoint();
        if (!request_.quiet) {
            fmt::print(stderr, "{} is there already: nothing is left to render\n", file_.string());
        }
        return exit_code::success;
    }
    const std::optional<RenderState> checkpoint = kept(checkpoint_);
    if (checkpoint &&
        (!state || checkpoint->film.complete_samples() > state->film.complete_samples())) {
        state = std::move(checkpoint);
    }
    if (!state) {
        state = RenderState{.film = FilmState(film_layout(session_.scene()), range_.begin),
                            .identity = session_.identity(request_.seed)};
    } else if (!request_.quiet) {
        fmt::print(stderr, "{}: going on after {} of {} samples per pixel\n", name(),
                   state->film.complete_samples(), range_.size());
    }
    if (state->part.begin > 0) begin_ = state->part.begin;
    roundings_ = state->part.roundings;

    const InterruptGuard guard;
    const double earlier = state->seconds;
    const RenderOptions how = options(*state);
    display_.begin();
    const RenderResult result = session_.render(how, std::move(state));
    display_.clear();
    return finish(result, earlier + result.figures.render_seconds);
}

int PartRendering::finish(const RenderResult& result, double seconds) {
    const bool complete = result.film.complete_samples() == range_.size();
    if (result.interrupted && !complete) {
        if (result.film.most_samples() > 0) save(checkpoint_, result.film, seconds);
        if (!request_.quiet) {
            fmt::print(stderr, "interrupted: {}\n",
                       result.film.most_samples() > 0 ? checkpoint_.string() + " is kept"
                                                      : "nothing was written");
        }
        if (result.film.most_samples() > 0) display_.finish(result.film, result.figures);
        return exit_code::interrupted;
    }
    save(file_, result.film, seconds);
    remove_checkpoint();
    fmt::print(stderr, "{}", figures_warnings(result.figures));
    print(result);
    display_.finish(result.film, result.figures);
    return exit_code::success;
}

std::optional<RenderState> PartRendering::kept(const std::filesystem::path& path) const {
    std::error_code problem;  // reading says what is wrong
    if (!std::filesystem::exists(path, problem) && !problem) return {};
    std::optional<RenderState> state;
    try {
        state = read_state(path);
    } catch (const VersionError&) {
        throw;
    } catch (const TransientFileError&) {
        throw;
    } catch (const FileError& e) {
        fmt::print(stderr, "warning: {}; the part is rendered without it\n", e.what());
        return {};
    }
    const auto refuse = [&](const std::string& what) {
        throw Error(
            fmt::format("{} is {}; remove it, or choose another --output", path.string(), what));
    };
    const RenderIdentity identity = session_.identity(request_.seed);
    if (state->identity.seed != identity.seed) {
        refuse(fmt::format("of --seed {}, not {}", state->identity.seed, identity.seed));
    }
    if (state->identity.scene_hash != identity.scene_hash ||
        !(state->film.layout() == film_layout(session_.scene()))) {
        refuse("of another scene, or the scene or its --set and -D values have changed");
    }
    if (!(state->part.planned == SampleRanges(range_))) {
        refuse(fmt::format("the state of samples {}, not {}", state->part.planned.text(),
                           SampleRanges(range_).text()));
    }
    return state;
}

bool PartRendering::is_finished(const RenderState& state) const {
    if (state.film.complete_samples() == range_.size()) return true;
    const std::optional<double> limit = request_.budget.seconds;
    return limit && state.part.time_limit > 0 && *limit <= state.part.time_limit;
}

RenderOptions PartRendering::options(const RenderState& from) {
    RenderOptions options;
    options.budget.samples = range_.size();
    const double earlier = from.seconds;
    if (request_.budget.seconds) options.budget.seconds = *request_.budget.seconds - earlier;
    options.seed = request_.seed;
    options.interrupted = InterruptGuard::interrupted;
    if (!display_.is_idle()) {
        options.progress = [this](const RenderStatus& status) { display_.report(status); };
    }
    options.after_pass = [this, earlier](const RenderStatus& status, const FilmState& film) {
        display_.after_pass(status, film);
        if (status.seconds < last_checkpoint_ + request_.checkpoint_seconds) return;
        last_checkpoint_ = status.seconds;
        save_checkpoint(film, earlier + status.seconds);
    };
    return options;
}

void PartRendering::save_checkpoint(const FilmState& film, double seconds) {
    if (film.complete_samples() == range_.size()) return;
    try {
        save(checkpoint_, film, seconds);
    } catch (const FileError& e) {
        display_.clear();
        fmt::print(stderr, "warning: no checkpoint: {}\n", e.what());
    }
}

void PartRendering::remove_checkpoint() const {
    std::error_code ignored;  // it does no harm
    std::filesystem::remove(checkpoint_, ignored);
}

PartRecord PartRendering::record() const {
    PartRecord part = session_.record(roundings_);
    part.planned = SampleRanges(range_);
    part.all_samples = all_samples_;
    part.time_limit = request_.budget.seconds.value_or(0);
    part.parts = 1;
    part.begin = begin_;
    part.end = time_of_day();
    return part;
}

void PartRendering::save(const std::filesystem::path& path, const FilmState& film,
                         double seconds) const {
    write_state(path, film, session_.identity(request_.seed), seconds, record());
}

void PartRendering::print(const RenderResult& result) const {
    const std::uint64_t end = range_.begin + result.film.complete_samples();
    const std::string samples = SampleRanges({.begin = range_.begin, .end = end}).text();
    if (request_.json || request_.json_progress) {
        Json json = Json::object();
        json.set("schema", 1);
        if (request_.json_progress) json.set("state", "finished");
        json.set("scene", request_.scene);
        json.set(request_.json_progress ? "file" : "state", file_.string());
        json.set("part", request_.part->number).set("parts", request_.part->count);
        json.set("samples", samples).set("all_samples", all_samples_);
        json.set("figures", to_json(result.figures));
        fmt::print("{}", request_.json_progress ? json.line() : json.text());
    } else if (!request_.quiet) {
        fmt::print("{}, samples {}: {}\n{}\n", name(), samples, figures_text(result.figures),
                   file_.string());
    }
}

}  // namespace lucerna
