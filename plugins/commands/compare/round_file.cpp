// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/compare/round_file.h"

#include "core/base/error.h"
#include "core/base/file_bytes.h"
#include "core/image/exr.h"
#include "core/math/sequences.h"

#include <fmt/format.h>

#include <map>
#include <sstream>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

std::string layer_name(std::size_t variant, std::size_t picture) {
    return fmt::format("variant{}.picture{}", variant + 1, picture + 1);
}

std::string run_name(std::size_t variant) { return fmt::format("lucerna:variant{}", variant + 1); }

/// The figures, then seconds and samples of each snapshot.
std::string run_text(const RunRecord& run) {
    const RenderFigures& f = run.figures;
    std::string text = fmt::format("{} {} {} {} {} {} {} {} {} {} {} {}", f.seed, f.scene_hash,
                                   f.build_seconds, run.render_seconds, f.samples,
                                   f.rays.intersections, f.rays.occlusions, f.rays.blocked,
                                   f.dropped_samples, f.light_sampler_bytes, f.threads, run.memory);
    for (const Snapshot& s : run.snapshots) text += fmt::format(" {} {}", s.seconds, s.samples);
    return text;
}

RunRecord run_from(const std::string& text) {
    RunRecord run;
    RenderFigures& f = run.figures;
    std::istringstream words(text);
    words >> f.seed >> f.scene_hash >> f.build_seconds >> run.render_seconds >> f.samples >>
        f.rays.intersections >> f.rays.occlusions >> f.rays.blocked >> f.dropped_samples >>
        f.light_sampler_bytes >> f.threads >> run.memory;
    for (Snapshot s; words >> s.seconds >> s.samples;) run.snapshots.push_back(s);
    return run;
}

/// Of the pixels and the figures.
std::string content_hash(const ImageFile& file) {
    std::uint64_t hash = 0;
    const auto add = [&](const auto& values) {
        const auto* const bytes = reinterpret_cast<const std::uint8_t*>(values.data());
        hash = hash_combine(hash, hash_of_bytes({bytes, values.size() * sizeof(values[0])}));
    };
    std::map<std::string, const Plane*> by_name;  // files sort their channels
    for (const Plane& plane : file.planes) by_name[plane.name] = &plane;
    for (const auto& [name, plane] : by_name) {
        const auto* const samples = std::get_if<std::vector<float>>(&plane->samples);
        if (samples) add(*samples);
    }
    for (const auto& [name, value] : file.metadata) {
        const std::string* const text = std::get_if<std::string>(&value);
        if (text && name.starts_with("lucerna:variant")) add(*text);
    }
    return fmt::format("{:016x}", hash);
}

/// The attributes of a file, each of which must be there.
class Attributes {
public:
    Attributes(const ImageFile& file, const fs::path& path) : file_(file), path_(path) {}

    template <typename T>
    T get(const std::string& name) const {
        const auto found = file_.metadata.find(name);
        const T* const value =
            found == file_.metadata.end() ? nullptr : std::get_if<T>(&found->second);
        if (!value) fail();
        return *value;
    }
    [[noreturn]] void fail() const {
        throw FileError(
            fmt::format("{} is damaged, or no round of a comparison; remove it, and "
                        "run its part again",
                        path_.string()));
    }

private:
    const ImageFile& file_;
    const fs::path& path_;
};

}  // namespace

void write_round(const fs::path& path, const Round& round, const std::string& comparison) {
    const Image& some = round.runs.front().snapshots.front().image;
    ImageFile file;
    file.width = some.width;
    file.height = some.height;
    const Machine& m = round.machine;
    file.metadata = {{"lucerna:comparison", comparison},
                     {"lucerna:round", round.repeat + 1},
                     {"lucerna:variants", static_cast<int>(round.runs.size())},
                     {"lucerna:node", m.node},
                     {"lucerna:processor", m.processor},
                     {"lucerna:system", m.system},
                     {"lucerna:cores", m.cores},
                     {"lucerna:threads", m.threads},
                     {"lucerna:other_load", m.other_load}};
    for (std::size_t v = 0; v < round.runs.size(); ++v) {
        const RunRecord& run = round.runs[v];
        file.metadata[run_name(v)] = run_text(run);
        for (std::size_t i = 0; i < run.snapshots.size(); ++i) {
            add_layer(file, run.snapshots[i].image, layer_name(v, i));
        }
    }
    file.metadata["lucerna:hash"] = content_hash(file);
    write_exr(path, file);
}

Round read_round(const fs::path& path, const std::string& comparison) {
    const ImageFile file = read_exr(path);
    const Attributes attributes(file, path);
    const auto theirs = attributes.get<std::string>("lucerna:comparison");
    if (theirs != comparison) {
        throw Error(fmt::format("{} is a round of another comparison:\n  it has  {}\n  not     {}",
                                path.string(), theirs, comparison));
    }
    Round round;
    round.repeat = attributes.get<int>("lucerna:round") - 1;
    round.machine = {.node = attributes.get<std::string>("lucerna:node"),
                     .processor = attributes.get<std::string>("lucerna:processor"),
                     .system = attributes.get<std::string>("lucerna:system"),
                     .cores = attributes.get<int>("lucerna:cores"),
                     .threads = attributes.get<int>("lucerna:threads"),
                     .other_load = attributes.get<double>("lucerna:other_load")};
    const int variants = attributes.get<int>("lucerna:variants");
    for (std::size_t v = 0; v < static_cast<std::size_t>(variants); ++v) {
        RunRecord run = run_from(attributes.get<std::string>(run_name(v)));
        if (run.snapshots.empty()) attributes.fail();
        for (std::size_t i = 0; i < run.snapshots.size(); ++i) {
            run.snapshots[i].image = to_image(file, layer_name(v, i));
        }
        round.runs.push_back(std::move(run));
    }
    if (attributes.get<std::string>("lucerna:hash") != content_hash(file)) attributes.fail();
    return round;
}

}  // namespace lucerna
