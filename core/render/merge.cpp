// SPDX-License-Identifier: Apache-2.0
#include "core/render/merge.h"

#include "core/base/error.h"
#include "core/base/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

std::string text(SampleRange range) {
    if (range.size() == 1) return fmt::format("sample {}", range.begin);
    return fmt::format("samples {} to {}", range.begin, range.end - 1);
}

/// The first difference that keeps two states from being parts of one render, or empty.
std::string difference(const StateFile& a, const StateFile& b) {
    const FilmLayout &x = a.layout(), &y = b.layout();
    const auto differ = [](const char* what, const auto& first, const auto& second) {
        return fmt::format("they differ in {}: {} and {}", what, first, second);
    };
    const auto size = [](Vector2i s) { return fmt::format("{} × {}", s.x, s.y); };
    if (x.full_size != y.full_size) return differ("size", size(x.full_size), size(y.full_size));
    if (!(x.crop == y.crop)) return "they differ in their crop window";
    if (a.part().integrator != b.part().integrator) {
        return differ("the integrator", a.part().integrator, b.part().integrator);
    }
    if (a.identity().seed != b.identity().seed) {
        return differ("the seed", a.identity().seed, b.identity().seed);
    }
    if (a.identity().scene_hash != b.identity().scene_hash) {
        return "they are of different scenes, or the scene or its --set and -D values have changed "
               "between them";
    }
    return x == y ? "" : "they differ in filter or layers";
}

void check_fits(const StateFile& file, std::span<const StateFile> others) {
    if (file.part().uneven) {
        throw Error(fmt::format(
            "{} was interrupted in the middle of a pass: not all of its pixels have the same "
            "samples; finish it by running its `lucerna render` once more",
            file.path().string()));
    }
    for (const StateFile& other : others) {
        std::string what = difference(other, file);
        if (what.empty()) {
            if (const auto twice = other.part().samples.overlap(file.part().samples)) {
                what = fmt::format("both have {}; leave out one of them", text(*twice));
            }
        }
        if (what.empty()) continue;
        throw Error(fmt::format("{} and {} cannot be merged: {}", other.path().string(),
                                file.path().string(), what));
    }
}

/// Opens a file; errors of other versions name it and the first of those that are of this one.
StateFile open_state(const fs::path& path, std::span<const StateFile> others) {
    try {
        return StateFile(path);
    } catch (const VersionError& e) {
        if (others.empty()) throw;
        throw VersionError(fmt::format("{} and {} cannot be merged: {}",
                                       others.front().path().string(), path.string(), e.what()));
    }
}

/// Bands are the outer loop: the sums of one stay in the processor's caches for all files.
void add_sums(std::span<const StateFile> files, FilmState& film) {
    Workers().run(static_cast<std::int64_t>(files.front().band_count()), [&](std::int64_t band) {
        for (const StateFile& file : files) file.add_band(static_cast<std::size_t>(band), film);
    });
}

void add_record(PartRecord& all, const PartRecord& part) {
    all.samples.add(part.samples);
    all.planned.add(part.planned.empty() ? part.samples : part.planned);
    all.all_samples = std::max(all.all_samples, part.all_samples);
    all.time_limit = std::max(all.time_limit, part.time_limit);
    all.parts += std::max(part.parts, 1);
    // Only parts say when they began.
    const bool both_known = all.begin > 0 && part.begin > 0;
    all.begin = both_known ? std::min(all.begin, part.begin) : std::max(all.begin, part.begin);
    all.end = std::max(all.end, part.end);
}

/// What all states together say, with a film without samples.
RenderState empty_sum(std::span<const StateFile> files) {
    const StateFile& first = files.front();
    std::uint64_t first_sample = first.first_sample();
    for (const StateFile& file : files) first_sample = std::min(first_sample, file.first_sample());
    RenderState sum = {.film = FilmState(first.layout(), first_sample),
                       .identity = first.identity(),
                       .seconds = 0,
                       .part = first.part()};
    sum.part.samples = sum.part.planned = {};
    sum.part.parts = 0;
    for (const StateFile& file : files) {
        sum.seconds += file.seconds();
        add_record(sum.part, file.part());
    }
    return sum;
}

}  // namespace

RenderState merge_states(const std::vector<fs::path>& paths) {
    if (paths.empty()) throw Error("there is nothing to merge");
    std::vector<StateFile> files;
    files.reserve(paths.size());
    for (const fs::path& path : paths) {
        StateFile file = open_state(path, files);
        check_fits(file, files);
        files.push_back(std::move(file));
    }
    RenderState sum = empty_sum(files);
    add_sums(files, sum.film);
    return sum;
}

SampleRanges absent_samples(const PartRecord& part) {
    return SampleRanges({.begin = 0, .end = part.all_samples}).without(part.planned);
}

SampleRanges unfinished_samples(const PartRecord& part) {
    return part.planned.without(part.samples);
}

}  // namespace lucerna
