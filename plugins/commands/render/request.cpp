// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/render/request.h"

#include "core/base/error.h"
#include "core/render/output.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>

namespace lucerna {

void declare_what(Arguments& arguments, Request& request) {
    arguments.positional("SCENE", request.scene, "an XML file in Mitsuba's format");
    arguments.option("-o,--output", "FILE", request.output,
                     "the pictures: FILE.exr (linear, all layers) and FILE.png (as displayed); by "
                     "default they are named after the scene, in the current directory");
    declare_scene_options(arguments, request);
    arguments.option("--crop", "X,Y,W,H", request.crop, ',', 4, {.min = 0, .max = 65536},
                     "renders this part only; it is exactly a part of the whole image");
    arguments.option("--seed", "N", request.seed, non_negative,
                     "another number, another noise; 0 by default");
    declare_threads(arguments, request);
}

void declare_how(Arguments& arguments, Request& request) {
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
    arguments.flag("--json-progress", request.json_progress,
                   "prints a line of JSON a second, and the figures in the last one");
    arguments.option(
        "--preview", "WHERE", request.preview,
        "shows the picture while it grows: tev, or HOST:PORT where tev listens; web or "
        "web:PORT, a page for browsers on this machine that can also stop the render, "
        "or web:ADDRESS:PORT for others; its address is printed even with --quiet");
    arguments.footer(
        "The first limit that is reached ends the render. SIGINT and SIGTERM end it, too: pictures "
        "and checkpoint are written if there is any sample, and the exit code is 130.\n\n"
        "Exit codes: 0 success, 1 failure, 2 wrong arguments, 3 wrong scene or colour "
        "configuration, 4 plugin cannot be loaded, 5 file cannot be read or written, 75 with "
        "--part: a file cannot be written now, but may be later, 130 interrupted. Schedulers "
        "should run a part again after 75 and after 128 and above, and after nothing else.");
}

std::optional<Part> parse_part(const std::string& text) {
    Part part;
    const char* const end = text.data() + text.size();
    const auto number = std::from_chars(text.data(), end, part.number);
    if (number.ec != std::errc() || number.ptr == end || *number.ptr != '/') return {};
    const auto count = std::from_chars(number.ptr + 1, end, part.count);
    if (count.ec != std::errc() || count.ptr != end) return {};
    return part;
}

std::string contradiction_of_part(const Request& request) {
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

std::string contradiction(const Request& request) {
    if (request.json && request.json_progress) {
        return "--json-progress ends with the figures that --json prints; give one of them";
    }
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

SessionSettings session_settings(const Request& request) {
    SessionSettings settings = session_settings(static_cast<const SceneOptions&>(request));
    const char* names[] = {"offset_x", "offset_y", "width", "height"};
    for (std::size_t i = 0; i < request.crop.size(); ++i) {
        settings.overrides.push_back(
            fmt::format("sensor.film.crop_{}={}", names[i], request.crop[i]));
    }
    return settings;
}

}  // namespace lucerna
