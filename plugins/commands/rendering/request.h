// SPDX-License-Identifier: Apache-2.0
/// What the command line of `lucerna render` says.
#pragma once

#include "core/command_line/arguments.h"
#include "core/render/output.h"
#include "core/render/session.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lucerna {

/// Part `number` of `count`, 1 … count.
struct Part {
    std::uint64_t number = 0, count = 0;
};

struct Request {
    std::string scene, output, checkpoint, view;
    RenderBudget budget;
    std::uint64_t seed = 0;
    int threads = 0;
    std::string part_text;
    std::optional<Part> part;
    std::vector<int> resolution, crop;
    std::vector<std::pair<std::string, std::string>> defines;
    std::vector<std::string> overrides, plugin_folders;
    double checkpoint_seconds = 60, exposure = 0;
    bool resume = false, quiet = false, json = false;
};

inline void declare_what(Arguments& arguments, Request& request) {
    arguments.positional("SCENE", request.scene, "an XML file in Mitsuba's format");
    arguments.option("-o,--output", "FILE", request.output,
                     "the pictures: FILE.exr (linear, all layers) and FILE.png (as displayed); by "
                     "default they are named after the scene, in the current directory");
    arguments.option("--resolution", "WxH", request.resolution, 'x', 2, {.min = 1, .max = 65536},
                     "size of the whole image [pixels]");
    arguments.option("--crop", "X,Y,W,H", request.crop, ',', 4, {.min = 0, .max = 65536},
                     "renders this part only; it is exactly a part of the whole image");
    arguments.option("-D,--define", "NAME=VALUE", request.defines,
                     "value of $NAME in the scene; may be repeated");
    arguments.option("--set", "PATH=VALUE", request.overrides,
                     "changes the scene, for example integrator.max_depth=8 or "
                     "integrator.light_sampler=power; may be repeated");
    arguments.option("--plugins", "DIR", request.plugin_folders,
                     "looks for plugins in DIR first; may be repeated");
    arguments.option("--seed", "N", request.seed, non_negative,
                     "another number, another noise; 0 by default");
    arguments.option("--threads", "N", request.threads, {.min = 0, .max = 4096},
                     "0, the default: one for each processor");
}

inline void declare_how(Arguments& arguments, Request& request) {
    arguments.option("--spp", "N", request.budget.samples, {.min = 1, .max = 1 << 30},
                     "samples per pixel; unless there is a limit, the sampler's sample_count");
    arguments.option("--time", "SECONDS", request.budget.seconds, positive,
                     "time to render, without loading and building");
    arguments.option("--error", "RELMSE", request.budget.error, positive,
                     "renders until the estimate of the relative mean squared error is below this");
    arguments.option("--part", "K/N", request.part_text,
                     "renders the samples of part K of N, for `lucerna merge`: FILE of --output is "
                     "then the state of the part, not a picture; run again, it goes on from its "
                     "own checkpoint, FILE.checkpoint");
    arguments.option("--checkpoint", "FILE", request.checkpoint,
                     "keeps the state of the render in this EXR file");
    arguments.option("--checkpoint-every", "SECONDS", request.checkpoint_seconds, positive,
                     "60 by default; it is also written at the end");
    arguments.flag("--resume", request.resume,
                   "continues from the checkpoint, if the file is there; exactly as if the render "
                   "had never stopped");
    arguments.option("--view", "DISPLAY/VIEW", request.view,
                     "of the PNG; `lucerna tonemap --list` shows all");
    arguments.option("--exposure", "EV", request.exposure, {.min = -100, .max = 100},
                     "of the PNG, in factors of two");
    arguments.flag("-q,--quiet", request.quiet, "prints nothing but warnings and errors");
    arguments.flag("--json", request.json, "prints the figures as JSON");
    arguments.footer(
        "The first limit that is reached ends the render. SIGINT and SIGTERM end it, too: pictures "
        "and checkpoint are written if there is any sample, and the exit code is 130.\n\n"
        "Exit codes: 0 success, 1 failure, 2 wrong arguments, 3 wrong scene or colour "
        "configuration, 4 plugin cannot be loaded, 5 file cannot be read or written, 75 with "
        "--part: a file cannot be written now, but may be later, 130 interrupted. Schedulers "
        "should run a part again after 75 and after 128 and above, and after nothing else.");
}

/// "3/64"; nothing for any other text.
inline std::optional<Part> parse_part(const std::string& text) {
    Part part;
    const char* const end = text.data() + text.size();
    const auto number = std::from_chars(text.data(), end, part.number);
    if (number.ec != std::errc() || number.ptr == end || *number.ptr != '/') return {};
    const auto count = std::from_chars(number.ptr + 1, end, part.count);
    if (count.ec != std::errc() || count.ptr != end) return {};
    return part;
}

/// What is wrong with the arguments of a part, or empty.
inline std::string contradiction_of_part(const Request& request) {
    if (!request.part) {
        return fmt::format("--part: expected K/N, such as 3/64, not {}", quote(request.part_text));
    }
    const auto [number, count] = *request.part;
    if (count == 0)
        return fmt::format("--part {}: there must be one part at least", request.part_text);
    if (number == 0 || number > count) {
        return fmt::format("--part {}: there are only parts 1 to {}", request.part_text, count);
    }
    if (request.output.empty()) {
        return "--part needs --output FILE, the file for the state of the part";
    }
    if (request.resume || !request.checkpoint.empty()) {
        return "--part keeps a checkpoint of its own and goes on from it; leave out --checkpoint "
               "and --resume";
    }
    if (request.budget.error) {
        return "--part cannot know the error of the whole picture; leave out --error";
    }
    return "";
}

/// What is wrong with the arguments taken together, or empty.
inline std::string contradiction(const Request& request) {
    if (!request.part_text.empty()) return contradiction_of_part(request);
    if (request.checkpoint.empty()) return request.resume ? "--resume needs --checkpoint FILE" : "";
    const PicturePaths pictures(request.output, request.scene);
    const std::filesystem::path checkpoint = std::filesystem::weakly_canonical(request.checkpoint);
    for (const std::filesystem::path& picture : {pictures.exr, pictures.png}) {
        if (checkpoint != std::filesystem::weakly_canonical(picture)) continue;
        return fmt::format("the picture {} would replace the checkpoint; give them different names",
                           picture.string());
    }
    return "";
}

inline SessionSettings session_settings(const Request& request) {
    SessionSettings settings;
    settings.scene = request.scene;
    settings.threads = request.threads;
    settings.defines = request.defines;
    settings.overrides = request.overrides;
    settings.plugin_folders.assign(request.plugin_folders.begin(), request.plugin_folders.end());
    const auto set_film = [&](const char* name, int value) {
        settings.overrides.push_back(fmt::format("sensor.film.{}={}", name, value));
    };
    if (!request.resolution.empty()) {
        set_film("width", request.resolution[0]);
        set_film("height", request.resolution[1]);
    }
    if (!request.crop.empty()) {
        set_film("crop_offset_x", request.crop[0]);
        set_film("crop_offset_y", request.crop[1]);
        set_film("crop_width", request.crop[2]);
        set_film("crop_height", request.crop[3]);
    }
    return settings;
}

}  // namespace lucerna
