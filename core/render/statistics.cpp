// SPDX-License-Identifier: Apache-2.0
#include "core/render/statistics.h"

#include "core/plugin/registry.h"
#include "core/render/film_state.h"

#include <fmt/format.h>

#include <sys/resource.h>

namespace lucerna {

namespace {

double seconds(const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

rusage usage_of_process() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage;
}

Json to_json(const std::optional<ErrorEstimate>& error) {
    if (!error) return {};
    Json json = Json::object();
    json.set("relative_mse", error->relative_mse);
    json.set("relative_mse_low", error->low).set("relative_mse_high", error->high);
    json.set("relative_mse_rare", error->rare).set("relative_mse_unseen", error->unseen);
    json.set("mse", error->mse).set("image_mean", error->image_mean);
    return json;
}

/// Why an interval is wide.
std::string reason(const ErrorEstimate& error) {
    if (error.unseen > error.high / 2) {
        return "light by way of mirrors or glass is met by chance, and may be missing";
    }
    return fmt::format("{:.0f} % of it is in pixels that few bright samples have reached",
                       100 * error.rare);
}

}  // namespace

double RenderFigures::rays_per_second() const {
    return render_seconds > 0 ? static_cast<double>(rays.rays()) / render_seconds : 0;
}

std::uint64_t peak_memory() {
    return static_cast<std::uint64_t>(usage_of_process().ru_maxrss) * 1024;
}

double cpu_seconds() {
    const rusage usage = usage_of_process();
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void describe_film(const FilmState& film, RenderFigures& figures) {
    figures.samples = film.complete_samples();
    figures.error = film.error();
    figures.dropped_samples = film.dropped_samples();
    if (const auto pixel = film.first_dropped_pixel()) {
        figures.first_dropped_pixel = fmt::format("{}, {}", pixel->x, pixel->y);
    }
    figures.empty_pixels = film.empty_pixels();
}

std::string figures_text(const RenderFigures& figures) {
    std::string text =
        fmt::format("load {:.2f} s, build {:.2f} s, render {:.2f} s", figures.load_seconds,
                    figures.build_seconds, figures.render_seconds);
    text +=
        fmt::format("; {} spp; {:.2f} Mrays/s", figures.samples, figures.rays_per_second() * 1e-6);
    return text + error_text(figures);
}

std::string error_text(const RenderFigures& figures) {
    if (!figures.error) return "; no error estimate from one sample per pixel";
    const ErrorEstimate& error = *figures.error;
    const std::string text = fmt::format("; relMSE {:.3g} (95 %: {:.3g} to {:.3g}",
                                         error.relative_mse, error.low, error.high);
    if (!error.vague()) return text + ")";
    return text + "; not known better, since " + reason(error) + ")";
}

std::string figures_warnings(const RenderFigures& figures) {
    std::string text;
    if (figures.dropped_samples > 0) {
        text += fmt::format(
            "warning: {} samples were not finite and are missing from the image, "
            "first at pixel {}\n",
            figures.dropped_samples, figures.first_dropped_pixel);
    }
    if (figures.empty_pixels > 0) {
        text +=
            fmt::format("warning: {} pixels have no sample and are black\n", figures.empty_pixels);
    }
    if (figures.error_asked && figures.error && figures.error->relative_mse > 0 &&
        figures.error->relative_mse <= *figures.error_asked &&
        !figures.error->surely_below(*figures.error_asked)) {
        text += fmt::format(
            "warning: the error seems to be below {:.3g}, as asked for, but cannot be known: with "
            "95 % it is between {:.3g} and {:.3g}{}\n",
            *figures.error_asked, figures.error->low, figures.error->high,
            figures.error->vague() ? ", since " + reason(*figures.error) : "");
    }
    if (figures.rays.dropped > 0) {
        text += fmt::format("warning: {} rays were not finite and were not traced\n",
                            figures.rays.dropped);
    }
    return text;
}

Json to_json(const RenderFigures& figures) {
    Json counters = Json::object();
    counters.set("intersections", figures.rays.intersections);
    counters.set("occlusions", figures.rays.occlusions);
    counters.set("blocked", figures.rays.blocked);
    counters.set("dropped_rays", figures.rays.dropped);
    counters.set("rejected_hits", figures.rays.rejected);
    counters.set("dropped_samples", figures.dropped_samples);
    counters.set("empty_pixels", figures.empty_pixels);

    Json json = Json::object();
    json.set("load_seconds", figures.load_seconds).set("build_seconds", figures.build_seconds);
    json.set("render_seconds", figures.render_seconds).set("cpu_seconds", figures.cpu_seconds);
    json.set("earlier_render_seconds", figures.earlier_seconds);
    json.set("samples_per_pixel", figures.samples);
    json.set("rays_per_second", figures.rays_per_second());
    json.set("error", to_json(figures.error));
    json.set("counters", counters);
    json.set("peak_memory_bytes", figures.peak_memory);
    json.set("accelerator_bytes", figures.accelerator_bytes);
    json.set("threads", figures.threads).set("seed", figures.seed);
    json.set("scene_hash", fmt::format("{:016x}", figures.scene_hash));
    json.set("light_sampler", figures.light_sampler);
    json.set("light_sampler_bytes", figures.light_sampler_bytes);
    json.set("plugins", figures.plugins);
    json.set("version", core_version()).set("built_with", core_built_with());
    return json;
}

}  // namespace lucerna
