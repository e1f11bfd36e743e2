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

std::vector<Variant> combinations(const std::vector<std::pair<std::string, std::string>>& varied) {
    std::vector<Variant> variants = {{}};
    for (const auto& [path, list] : varied) {
        const char separator = list.find(';') == std::string::npos ? ',' : ';';
        std::vector<Variant> longer;
        for (const Variant& variant : variants) {
            for (std::size_t begin = 0; begin <= list.size();) {
                const std::size_t end = std::min(list.find(separator, begin), list.size());
                const std::string value = list.substr(begin, end - begin);
                Variant next = variant;
                next.name += (next.name.empty() ? "" : ", ");
                next.name +=
                    varied.size() > 1 ? path.substr(path.rfind('.') + 1) + "=" + value : value;
                next.overrides.push_back(path + "=" + value);
                longer.push_back(next);
                begin = end + 1;
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

/// Measures a render at the ends of its passes, whenever the samples have doubled. The time
/// that this takes is not the render's.
class CurveRecorder {
public:
    explicit CurveRecorder(const Image& reference) : reference_(reference) {}

    void after_pass(const RenderStatus& status, const FilmState& film) {
        const auto begin = std::chrono::steady_clock::now();
        if (status.samples >= next_samples_) {
            const auto samples = static_cast<std::uint64_t>(status.samples);
            const Image image = film_image(film);
            points_.push_back({.seconds = status.seconds - measuring_seconds_,
                               .samples = samples,
                               .metrics = compare_images(image, reference_).finite});
            while (next_samples_ <= status.samples) next_samples_ *= 2;
        }
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
        measuring_seconds_ += taken.count();
    }

    double measuring_seconds() const { return measuring_seconds_; }
    std::vector<CurvePoint> take() { return std::move(points_); }

private:
    const Image& reference_;
    std::vector<CurvePoint> points_{};
    double next_samples_ = 1;
    double measuring_seconds_ = 0;
};

class Rounds {
public:
    Rounds(const SessionSettings& settings, ComparisonResult& result, int repeats, bool quiet)
        : settings_(settings), result_(result), repeats_(repeats), quiet_(quiet) {}

    /// False if it was interrupted; rounds that are complete stay.
    bool render() {
        for (VariantRuns& variant : result_.variants) {
            if (!warm_up(variant.variant)) return false;
        }
        const std::size_t count = result_.variants.size();
        for (int repeat = 0; repeat < repeats_; ++repeat) {
            for (std::size_t i = 0; i < count; ++i) {
                const std::size_t index = (i + static_cast<std::size_t>(repeat)) % count;
                if (render(result_.variants[index], index, repeat)) continue;
                for (VariantRuns& variant : result_.variants) drop_after(variant, repeat);
                return false;
            }
        }
        return true;
    }

private:
    bool warm_up(const Variant& variant) const {
        const Session session(settings_for(settings_, variant));
        const Vector2i size = film_layout(session.scene()).crop.size;
        const Image& reference = result_.reference.image;
        if (size != Vector2i(reference.width, reference.height)) {
            throw Error(fmt::format(
                "{} has {} x {} pixels and the reference {} x {}; pictures of different sizes "
                "cannot be compared",
                variant.name, size.x, size.y, reference.width, reference.height));
        }
        RenderOptions options;
        options.budget.samples = 1;
        options.interrupted = InterruptGuard::interrupted;
        return !session.render(options).interrupted;
    }

    bool render(VariantRuns& variant, std::size_t index, int repeat) const {
        CurveRecorder recorder(result_.reference.image);
        RenderOptions options;
        options.budget = result_.budget;
        options.seed = hash64({result_.seed, index, static_cast<std::uint64_t>(repeat)});
        options.interrupted = InterruptGuard::interrupted;
        options.after_pass = [&](const RenderStatus& status, const FilmState& film) {
            recorder.after_pass(status, film);
        };
        MemoryMeter::restart();
        const Session session(settings_for(settings_, variant.variant));
        const RenderResult rendered = session.render(options);
        if (rendered.interrupted) return false;
        Run run;
        run.memory = MemoryMeter::peak();
        run.repeat = repeat;
        run.figures = rendered.figures;
        run.render_seconds = rendered.figures.render_seconds - recorder.measuring_seconds();
        run.curve = recorder.take();
        finish(run, variant, film_image(rendered.film));
        if (!quiet_) announce(variant);
        return true;
    }

    void finish(Run& run, VariantRuns& variant, Image image) const {
        const Image& reference = result_.reference.image;
        run.metrics = compare_images(image, reference).finite;
        run.flip = flip(image, reference).mean;
        const CurvePoint last = {run.render_seconds, run.figures.samples, run.metrics};
        if (!run.curve.empty() && run.curve.back().samples == last.samples) run.curve.pop_back();
        run.curve.push_back(last);
        variant.blocks.emplace_back(image);
        if (variant.runs.empty()) variant.picture = std::move(image);
        variant.runs.push_back(std::move(run));
    }

    void announce(const VariantRuns& variant) const {
        const Run& run = variant.runs.back();
        fmt::print(stderr,
                   "round {} of {}: {}: build {:.2f} s, render {:.2f} s, {} spp, relMSE "
                   "{:.3g}\n",
                   run.repeat + 1, repeats_, variant.variant.name, run.figures.build_seconds,
                   run.render_seconds, run.figures.samples, run.metrics.relmse);
    }

    static void drop_after(VariantRuns& variant, int rounds) {
        while (variant.runs.size() > static_cast<std::size_t>(rounds)) {
            variant.runs.pop_back();
            variant.blocks.pop_back();
        }
    }

    const SessionSettings& settings_;
    ComparisonResult& result_;
    int repeats_;
    bool quiet_;
};

}  // namespace

bool render_rounds(const SessionSettings& settings, ComparisonResult& result, int repeats,
                   bool quiet) {
    return Rounds(settings, result, repeats, quiet).render();
}

}  // namespace lucerna
