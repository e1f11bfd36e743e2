// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/compare/reference.h"

#include "core/image/color.h"
#include "core/image/exr.h"
#include "core/image/read_image.h"
#include "core/render/film_state.h"
#include "core/render/progress.h"

#include <fmt/format.h>

#include <utility>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

/// The colours of a film by `value(pixel, channel)`.
template <typename Value>
Image film_image(const FilmState& film, const Value& value) {
    Image image(film.layout().crop.size.x, film.layout().crop.size.y);
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            image.pixels[3 * i + c] = static_cast<float>(value(i, c));
        }
    }
    return image;
}

}  // namespace

Image film_image(const FilmState& film) {
    return film_image(film, [&](std::size_t i, std::size_t c) { return film.mean(i, c); });
}

Reference reference_from(const RenderState& state, const fs::path& path) {
    const FilmState& film = state.film;
    Reference reference;
    reference.image = film_image(film);
    reference.error = film.error();
    if (reference.error) {
        for (const int half : {0, 1}) {
            reference.halves.push_back(film_image(
                film, [&](std::size_t i, std::size_t c) { return film.half_mean(i, half, c); }));
        }
    }
    reference.samples = film.complete_samples();
    reference.seconds = state.seconds;
    reference.source = path.string();
    reference.scene_hash = state.identity.scene_hash;
    return reference;
}

Reference read_reference(const fs::path& path) {
    const bool is_exr = path.extension() == ".exr";
    if (is_exr && read_exr(path).metadata.contains("lucerna:state")) {
        return reference_from(read_state(path), path);
    }
    Reference reference;
    reference.image = read_image(path, ExrWindow::data);
    ColorConfig().to_rendering(reference.image);
    reference.source = path.string();
    return reference;
}

namespace {

class ReferenceCache {
public:
    ReferenceCache(const Session& session, fs::path path, std::uint64_t seed)
        : session_(session), path_(std::move(path)), seed_(seed) {}

    /// Empty if it was interrupted; what there is has been kept then.
    std::optional<Reference> obtain(RenderOptions options, bool quiet) {
        std::optional<RenderState> state = kept();
        if (state && enough(*state, options.budget)) return reference_from(*state, path_);
        if (!quiet) {
            fmt::print(stderr, "{} the reference, which is kept in {}\n",
                       state ? "refining" : "rendering", path_.string());
        }
        const double earlier = state ? state->seconds : 0;
        const PartRecord record =
            session_.record(state ? state->part.roundings : std::set<std::uint64_t>());
        if (options.budget.seconds) *options.budget.seconds -= earlier;
        Progress progress(Progress::choose(quiet));
        options.seed = seed_;
        options.progress = [&](const RenderStatus& status) { progress.update(status); };
        RenderResult result = session_.render(options, std::move(state));
        progress.clear();
        const double seconds = earlier + result.figures.render_seconds;
        const RenderIdentity identity = session_.identity(seed_);
        if (result.film.complete_samples() > 0) {
            write_state(path_, result.film, identity, seconds, record);
        }
        if (result.interrupted) return {};
        return reference_from({std::move(result.film), identity, seconds}, path_);
    }

private:
    /// What the file holds, if it belongs to this scene.
    std::optional<RenderState> kept() const {
        if (!fs::exists(path_)) return {};
        RenderState state = read_state(path_);
        const bool same = state.identity.scene_hash == session_.identity(seed_).scene_hash &&
                          state.identity.seed == seed_ &&
                          state.film.layout() == film_layout(session_.scene());
        return same ? std::optional(std::move(state)) : std::nullopt;
    }
    static bool enough(const RenderState& state, const RenderBudget& budget) {
        if (budget.samples) return state.film.complete_samples() >= *budget.samples;
        if (budget.seconds) return state.seconds >= 0.95 * *budget.seconds;
        const std::optional<ErrorEstimate> error = state.film.error();
        return error && error->high <= budget.error.value_or(0);
    }

    const Session& session_;
    fs::path path_;
    std::uint64_t seed_;
};

}  // namespace

std::optional<Reference> rendered_reference(const Session& session, const fs::path& path,
                                            std::uint64_t seed, const RenderOptions& options,
                                            bool quiet) {
    return ReferenceCache(session, path, seed).obtain(options, quiet);
}

}  // namespace lucerna
