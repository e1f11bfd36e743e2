// SPDX-License-Identifier: Apache-2.0
#include "core/render/session.h"

#include "core/description/xml_reader.h"
#include "core/interfaces/light_sampler.h"
#include "core/render/stored_film.h"
#include "core/scene/builder.h"
#include "core/scene/processor_rounding.h"

#include <fmt/format.h>

#include <chrono>

namespace lucerna {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

RayStatistics difference(const RayStatistics& after, const RayStatistics& before) {
    return {.intersections = after.intersections - before.intersections,
            .occlusions = after.occlusions - before.occlusions,
            .blocked = after.blocked - before.blocked,
            .dropped = after.dropped - before.dropped,
            .rejected = after.rejected - before.rejected};
}

}  // namespace

Session::Session(const SessionSettings& settings)
    : workers_(settings.threads), scene_file_(settings.scene), registry_(settings.plugin_folders) {
    Diagnostics diagnostics;
    const Clock::time_point start = Clock::now();
    ReadOptions options;
    options.defines = settings.defines;
    options.overrides = settings.overrides;
    description_ = read_scene(settings.scene, options, diagnostics);
    load_seconds_ = seconds_since(start);
    scene_ = build_scene(description_, registry_, diagnostics, {.threads = workers_.count()});
    build_seconds_ = seconds_since(start) - load_seconds_;
    warnings_ = diagnostics.all();
}

RenderResult Session::render(RenderOptions options, std::optional<RenderState> from) const {
    RenderBudget& budget = options.budget;
    if (!budget.samples && !budget.seconds && !budget.error) {
        budget.samples = static_cast<std::uint64_t>(scene_->sensor().sampler().sample_count());
    }
    if (options.threads == 0) options.threads = workers_.count();
    const std::uint64_t seed = options.seed;
    const std::optional<double> error_asked = budget.error;
    const double earlier_seconds = from ? from->seconds : 0;
    const RayStatistics rays_before = ray_statistics();
    const Clock::time_point start = Clock::now();

    RenderJob job(*scene_, std::move(options), from ? std::move(from->film) : empty_film());
    scene_->integrator().render(job);

    RenderResult result = {
        .film = job.take_state(), .figures = {}, .interrupted = job.interrupted()};
    const FilmState& film = result.film;
    RenderFigures& figures = result.figures;
    figures.load_seconds = load_seconds_;
    figures.build_seconds = build_seconds_;
    figures.render_seconds = seconds_since(start);
    figures.cpu_seconds = cpu_seconds();
    figures.earlier_seconds = earlier_seconds;
    figures.rays = difference(ray_statistics(), rays_before);
    describe_film(film, figures);
    figures.error_asked = error_asked;
    figures.peak_memory = peak_memory();
    figures.accelerator_bytes = scene_->accelerator_bytes();
    figures.threads = job.workers().count();
    figures.seed = seed;
    figures.scene_hash = scene_->hash();
    figures.light_sampler = light_sampler();
    if (const LightSampler* sampler = scene_->light_sampler()) {
        figures.light_sampler_bytes = sampler->bytes();
    }
    figures.plugins = registry_.opened();
    return result;
}

std::string Session::opened(const char* kind) const {
    const std::string folder = plugin_folder(kind) + "/";
    std::vector<std::string> names;
    for (const std::string& name : registry_.opened()) {
        if (name.starts_with(folder)) names.push_back(name.substr(folder.size()));
    }
    return join(names);
}

std::string Session::light_sampler() const { return opened(LightSampler::kind); }

PartRecord Session::record(std::set<std::uint64_t> earlier_roundings) const {
    earlier_roundings.insert(processor_rounding());
    return {.scene = scene_file_.string(),
            .integrator = integrator(),
            .light_sampler = light_sampler(),
            .film = film_text(description_),
            .roundings = std::move(earlier_roundings)};
}

}  // namespace lucerna
