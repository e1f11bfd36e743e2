// SPDX-License-Identifier: Apache-2.0
#include "core/render/merge.h"

#include "core/base/error.h"
#include "core/base/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <optional>
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

/// Files that are opened side by side, since each is read in part.
class Opening {
public:
    explicit Opening(const std::vector<fs::path>& paths)
        : files_(paths.size()), problems_(paths.size()) {
        Workers().run(std::ssize(paths), [&](std::int64_t index) {
            const auto i = static_cast<std::size_t>(index);
            try {
                files_[i].emplace(paths[i]);
            } catch (const FileError&) {
                problems_[i] = std::current_exception();
            }
        });
    }

    /// File `i`; throws what is wrong with it. Errors of other versions also name the first of the
    /// files before, which is of this one.
    StateFile take(std::size_t i, const fs::path& path, std::span<const StateFile> before) {
        try {
            if (problems_[i]) std::rethrow_exception(problems_[i]);
        } catch (const VersionError& e) {
            if (before.empty()) throw;
            throw VersionError(fmt::format("{} and {} cannot be merged: {}",
                                           before.front().path().string(), path.string(),
                                           e.what()));
        }
        return std::move(*files_[i]);
    }

private:
    std::vector<std::optional<StateFile>> files_;
    std::vector<std::exception_ptr> problems_;
};

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
    all.roundings.insert(part.roundings.begin(), part.roundings.end());
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
    Opening opening(paths);
    for (std::size_t i = 0; i < paths.size(); ++i) {
        StateFile file = opening.take(i, paths[i], files);
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
