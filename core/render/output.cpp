// SPDX-License-Identifier: Apache-2.0
#include "core/render/output.h"

#include "core/base/atomic_file.h"
#include "core/image/exr.h"
#include "core/image/png.h"
#include "core/plugin/registry.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

/// Only the colour: a viewer would show what lies behind alpha.
ImageFile color_planes(const ImageFile& image) {
    ImageFile result = image;
    std::erase_if(result.planes, [](const Plane& plane) {
        return plane.name != "R" && plane.name != "G" && plane.name != "B";
    });
    return result;
}

}  // namespace

PicturePaths::PicturePaths(fs::path output, const fs::path& scene) {
    if (output.empty()) output = scene.stem();
    const fs::path extension = output.extension();
    if (extension == ".exr" || extension == ".png" || extension == ".pfm") {
        output.replace_extension();
    }
    exr = png = output;
    exr += ".exr";
    png += ".png";
}

fs::path PicturePaths::other(const char* extension) const {
    fs::path path = exr;
    return path.replace_extension(extension);
}

void PicturePaths::check(const char* own) const {
    check_writable(exr);
    check_writable(png);
    check_writable(other(own));
}

PictureView picture_view(const std::string& name, double exposure) {
    PictureView view = {ColorConfig::choose(), name, exposure};
    if (!view.color.notice().empty()) fmt::print(stderr, "{}\n", view.color.notice());
    view.color.display(Image(1, 1), name);
    return view;
}

ImageFile annotated_image(const FilmState& film, const RenderFigures& figures,
                          const std::string& command, const std::string& scene) {
    ImageFile image = film.resolve();
    Metadata& metadata = image.metadata;
    metadata["lucerna:version"] = std::string(core_version());
    metadata["lucerna:built_with"] = std::string(core_built_with());
    metadata["lucerna:command"] = command;
    metadata["lucerna:scene"] = scene;
    metadata["lucerna:scene_hash"] = fmt::format("{:016x}", figures.scene_hash);
    metadata["lucerna:seed"] = std::to_string(figures.seed);
    metadata["lucerna:samples_per_pixel"] = std::to_string(figures.samples);
    metadata["lucerna:render_seconds"] = figures.earlier_seconds + figures.render_seconds;
    metadata["lucerna:build_seconds"] = figures.load_seconds + figures.build_seconds;
    metadata["lucerna:rays_per_second"] = figures.rays_per_second();
    metadata["lucerna:threads"] = figures.threads;
    metadata["lucerna:dropped_samples"] = std::to_string(figures.dropped_samples);
    if (!figures.light_sampler.empty()) metadata["lucerna:light_sampler"] = figures.light_sampler;
    if (figures.error) {
        metadata["lucerna:relative_mse"] = figures.error->relative_mse;
        metadata["lucerna:relative_mse_low"] = figures.error->low;
        metadata["lucerna:relative_mse_high"] = figures.error->high;
    }
    return image;
}

std::vector<fs::path> write_pictures(const Film& film, const ImageFile& image,
                                     const PicturePaths& paths, const PictureView& view) {
    const std::string_view kind = film.extension();
    std::vector<fs::path> written{paths.exr, paths.png};
    if (kind == ".exr") {
        film.write(image, paths.exr);
    } else {
        write_exr(paths.exr, image);
    }
    if (kind == ".png") {
        film.write(image, paths.png);
    } else {
        write_png(paths.png,
                  view.color.display(to_image(color_planes(image)), view.name, view.exposure));
    }
    if (kind != ".exr" && kind != ".png") {
        written.push_back(paths.other(film.extension()));
        film.write(image, written.back());
    }
    return written;
}

}  // namespace lucerna
