// SPDX-License-Identifier: Apache-2.0
#include "core/render/merge.h"

#include "core/plugin/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

std::string text(SampleRange range) {
    if (range.size() == 1) return fmt::format("sample {}", range.begin);
    return fmt::format("samples {} to {}", range.begin, range.end - 1);
}

/// What two states of one render have in common; the first difference, or empty.
std::string difference(const RenderState& a, const RenderState& b) {
    const FilmLayout &x = a.film.layout(), &y = b.film.layout();
    const auto differ = [](const char* what, const auto& first, const auto& second) {
        return fmt::format("they differ in {}: {} and {}", what, first, second);
    };
    const auto size = [](Vector2i s) { return fmt::format("{} × {}", s.x, s.y); };
    if (x.full_size != y.full_size) {
        return differ("size", size(x.full_size), size(y.full_size));
    }
    if (!(x.crop == y.crop)) return "they differ in their crop window";
    if (a.part.integrator != b.part.integrator) {
        return differ("the integrator", a.part.integrator, b.part.integrator);
    }
    if (a.identity.seed != b.identity.seed) {
        return differ("the seed", a.identity.seed, b.identity.seed);
    }
    if (a.identity.scene_hash != b.identity.scene_hash) {
        return "they are of different scenes, or the scene or its --set and -D values have changed "
               "between them";
    }
    if (!(x == y)) return "they differ in filter or layers";
    return "";
}

/// The samples that every pixel of the state has: states with others are no parts.
SampleRanges samples_of(const RenderState& state, const fs::path& path) {
    const std::uint64_t count = state.film.complete_samples();
    if (state.film.most_samples() != count) {
        throw Error(fmt::format(
            "{} was interrupted in the middle of a pass: not all of its pixels have the same "
            "samples; finish it by running its `lucerna render` once more",
            path.string()));
    }
    if (!state.part.samples.empty()) return state.part.samples;
    const std::uint64_t first = state.film.first_sample();
    return SampleRanges({.begin = first, .end = first + count});
}

/// States that are added up.
class Merging {
public:
    void add(RenderState state, const fs::path& path);
    RenderState result() && {
        sum_->part.samples = samples_;
        return std::move(*sum_);
    }

private:
    struct Source {
        fs::path path;
        SampleRanges samples;
    };
    void check(const RenderState& state, const Source& source) const;

    std::optional<RenderState> sum_;
    std::vector<Source> sources_;
    SampleRanges samples_;
};

void Merging::check(const RenderState& state, const Source& source) const {
    if (!sum_) return;
    const std::string what = difference(*sum_, state);
    if (!what.empty()) {
        throw Error(fmt::format("{} and {} cannot be merged: {}", sources_.front().path.string(),
                                source.path.string(), what));
    }
    for (const Source& other : sources_) {
        const std::optional<SampleRange> twice = other.samples.overlap(source.samples);
        if (!twice) continue;
        throw Error(fmt::format("{} and {} cannot be merged: both have {}; leave out one of them",
                                other.path.string(), source.path.string(), text(*twice)));
    }
}

void Merging::add(RenderState state, const fs::path& path) {
    const Source source = {.path = path, .samples = samples_of(state, path)};
    check(state, source);
    PartRecord& part = state.part;
    if (part.planned.empty()) part.planned = source.samples;
    part.parts = std::max(part.parts, 1);
    samples_.add(source.samples);
    sources_.push_back(source);
    if (!sum_) {
        sum_.emplace(std::move(state));
        return;
    }
    sum_->film.add(state.film);
    sum_->seconds += state.seconds;
    PartRecord& all = sum_->part;
    all.planned.add(part.planned);
    all.all_samples = std::max(all.all_samples, part.all_samples);
    all.time_limit = std::max(all.time_limit, part.time_limit);
    all.parts += part.parts;
    all.begin = std::min(all.begin, part.begin);
    all.end = std::max(all.end, part.end);
}

}  // namespace

RenderState merge_states(const std::vector<fs::path>& files) {
    if (files.empty()) throw Error("there is nothing to merge");
    Merging merging;
    for (const fs::path& file : files) merging.add(read_state(file), file);
    return std::move(merging).result();
}

SampleRanges absent_samples(const PartRecord& part) {
    return SampleRanges({.begin = 0, .end = part.all_samples}).without(part.planned);
}

SampleRanges unfinished_samples(const PartRecord& part) {
    return part.planned.without(part.samples);
}

}  // namespace lucerna
