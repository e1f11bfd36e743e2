// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/compare/runs.h"

#include "core/base/error.h"
#include "core/image/flip.h"
#include "core/math/sequences.h"
#include "core/render/interrupt.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>

namespace lucerna {

std::vector<std::string> varied_values(const std::string& list) {
    const char separator = list.find(';') == std::string::npos ? ',' : ';';
    std::vector<std::string> values;
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(separator, begin), list.size());
        values.push_back(list.substr(begin, end - begin));
        begin = end + 1;
    }
    return values;
}

std::vector<Variant> combinations(const std::vector<std::pair<std::string, std::string>>& varied) {
    std::vector<Variant> variants = {{}};
    for (const auto& [path, list] : varied) {
        std::vector<Variant> longer;
        for (const Variant& variant : variants) {
            for (const std::string& value : varied_values(list)) {
                Variant next = variant;
                next.name += (next.name.empty() ? "" : ", ");
                next.name +=
                    varied.size() > 1 ? path.substr(path.rfind('.') + 1) + "=" + value : value;
                next.overrides.push_back(path + "=" + value);
                longer.push_back(next);
            }
        }
        variants = std::move(longer);
    }
    return variants;
}

SessionSettings settings_for(SessionSettings settings, const Variant& variant) {
    settings.overrides.insert(settings.overrides.end(), variant.overrides.begin(),
                              variant.overrides.end());
    return settings;
}

namespace {

/// The largest resident memory since the last call of restart(), where the system can tell;
/// elsewhere that of the whole process so far.
class MemoryMeter {
public:
    static void restart() { std::ofstream("/proc/self/clear_refs") << "5"; }
    static std::uint64_t peak() {
        std::ifstream status("/proc/self/status");
        for (std::string word; status >> word;) {
            std::uint64_t kibibytes = 0;
            if (word == "VmHWM:" && status >> kibibytes) return 1024 * kibibytes;
        }
        return peak_memory();
    }
};

/// Takes a picture of a render at the ends of its passes, whenever the samples have doubled. The
/// time and the memory that this takes are not the render's.
class Recorder {
public:
    Recorder() { MemoryMeter::restart(); }

    void after_pass(const RenderStatus& status, const FilmState& film) {
        const auto begin = std::chrono::steady_clock::now();
        if (status.samples >= next_samples_) {
            memory_ = std::max(memory_, render_memory());
            add(status.seconds - seconds_, static_cast<std::uint64_t>(status.samples), film);
            while (next_samples_ <= status.samples) next_samples_ *= 2;
            MemoryMeter::restart();
        }
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
        seconds_ += taken.count();
    }

    RunRecord finish(const RenderResult& rendered) {
        RunRecord run{.figures = rendered.figures,
                      .render_seconds = rendered.figures.render_seconds - seconds_,
                      .memory = std::max(memory_, render_memory())};
        const bool there = !snapshots_.empty() && snapshots_.back().samples == run.figures.samples;
        if (there) snapshots_.pop_back();
        add(run.render_seconds, run.figures.samples, rendered.film);
        run.snapshots = std::move(snapshots_);
        return run;
    }

private:
    void add(double seconds, std::uint64_t samples, const FilmState& film) {
        snapshots_.push_back({seconds, samples, film_image(film)});
    }
    /// Most since the last snapshot, without those that are held.
    std::uint64_t render_memory() const {
        std::uint64_t held = 0;
        for (const Snapshot& s : snapshots_) held += s.image.pixels.size() * sizeof(float);
        const std::uint64_t peak = MemoryMeter::peak();
        return peak > held ? peak - held : peak;
    }

    std::vector<Snapshot> snapshots_{};
    double next_samples_ = 1;
    double seconds_ = 0;
    std::uint64_t memory_ = 0;
};

/// Empty if it was interrupted.
std::optional<RunRecord> render_run(const RoundSettings& settings, std::size_t variant,
                                    int repeat) {
    Recorder recorder;
    RenderOptions options;
    options.budget = settings.budget;
    options.seed = hash64({settings.seed, variant, static_cast<std::uint64_t>(repeat)});
    options.interrupted = InterruptGuard::interrupted;
    options.after_pass = [&](const RenderStatus& status, const FilmState& film) {
        recorder.after_pass(status, film);
    };
    const Session session(settings_for(settings.session, settings.variants[variant]));
    const RenderResult rendered = session.render(options);
    if (rendered.interrupted) return {};
    return recorder.finish(rendered);
}

void announce(const Run& run, int repeats, const std::string& name) {
    fmt::print(stderr,
               "round {} of {}: {}: build {:.2f} s, render {:.2f} s, {} spp, relMSE {:.3g}\n",
               run.repeat + 1, repeats, name, run.figures.build_seconds, run.render_seconds,
               run.figures.samples, run.metrics.relmse);
}

void drop_after(VariantRuns& variant, int rounds) {
    while (variant.runs.size() > static_cast<std::size_t>(rounds)) {
        variant.runs.pop_back();
        variant.blocks.pop_back();
    }
}

}  // namespace

void check_size(const Variant& variant, Vector2i size, Vector2i reference) {
    if (size == reference) return;
    throw Error(
        fmt::format("{} has {} x {} pixels and the reference {} x {}; pictures of different sizes "
                    "cannot be compared",
                    variant.name, size.x, size.y, reference.x, reference.y));
}

bool warm_up(const RoundSettings& settings,
             const std::function<void(const Variant& variant, const Session& session)>& check) {
    for (const Variant& variant : settings.variants) {
        const Session session(settings_for(settings.session, variant));
        check(variant, session);
        RenderOptions options;
        options.budget.samples = 1;
        options.interrupted = InterruptGuard::interrupted;
        if (session.render(options).interrupted) return false;
    }
    return true;
}

std::optional<Machine> render_round(const RoundSettings& settings, int repeat,
                                    const RunFinished& finished) {
    const LoadMeter load;
    Machine machine;
    const std::size_t count = settings.variants.size();
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t variant = (i + static_cast<std::size_t>(repeat)) % count;
        std::optional<RunRecord> run = render_run(settings, variant, repeat);
        if (!run) return {};
        machine.threads = run->figures.threads;
        finished(variant, std::move(*run));
    }
    machine = this_machine(machine.threads);
    machine.other_load = load.other_load();
    return machine;
}

void add_run(ComparisonResult& result, std::size_t variant, int repeat, RunRecord record) {
    const Image& reference = result.reference.image;
    VariantRuns& runs = result.variants[variant];
    Run run;
    run.repeat = repeat;
    run.figures = record.figures;
    run.render_seconds = record.render_seconds;
    run.memory = record.memory;
    for (const Snapshot& s : record.snapshots) {
        run.curve.push_back({s.seconds, s.samples, compare_images(s.image, reference).finite});
    }
    run.metrics = run.curve.back().metrics;
    Image& image = record.snapshots.back().image;
    run.flip = flip(image, reference).mean;
    runs.blocks.emplace_back(image);
    if (runs.runs.empty()) runs.picture = std::move(image);
    runs.runs.push_back(std::move(run));
}

bool render_rounds(const RoundSettings& settings, ComparisonResult& result, bool quiet) {
    const Image& reference = result.reference.image;
    const auto check = [&](const Variant& variant, const Session& session) {
        check_size(variant, film_layout(session.scene()).crop.size,
                   {reference.width, reference.height});
    };
    if (!warm_up(settings, check)) return false;
    for (int repeat = 0; repeat < settings.repeats; ++repeat) {
        const auto finished = [&](std::size_t variant, RunRecord run) {
            add_run(result, variant, repeat, std::move(run));
            const VariantRuns& runs = result.variants[variant];
            if (!quiet) announce(runs.runs.back(), settings.repeats, runs.variant.name);
        };
        const std::optional<Machine> machine = render_round(settings, repeat, finished);
        if (!machine) {
            for (VariantRuns& variant : result.variants) drop_after(variant, repeat);
            return false;
        }
        result.machines.push_back(*machine);
    }
    return true;
}

}  // namespace lucerna
