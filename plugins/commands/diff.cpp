// SPDX-License-Identifier: Apache-2.0
/// diff: how far a picture is from a reference: relMSE, MSE, PSNR, and a picture of the error.
///
/// The figures and their formulas are those of core/image/metrics.h. Pixels that are not finite are
/// counted and never skipped silently.
#include "core/base/atomic_file.h"
#include "core/base/json.h"
#include "core/command_line/arguments.h"
#include "core/image/color.h"
#include "core/image/exr.h"
#include "core/image/metrics.h"
#include "core/image/png.h"
#include "core/image/read_image.h"
#include "core/interfaces/command.h"
#include "core/render/interrupt.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace lucerna {

namespace {

namespace fs = std::filesystem;

/// In the rendering space; PNG and JPEG are decoded from sRGB.
Image read_linear(const std::string& path) {
    Image image = read_image(path, ExrWindow::data);
    ColorConfig().to_rendering(image);
    return image;
}

/// The part W × H of a picture that begins at (X, Y), for crop = {X, Y, W, H}; a picture of this
/// size is taken for that part.
Image part_of(const Image& image, const std::vector<int>& crop, const std::string& path) {
    const int x = crop[0], y = crop[1], width = crop[2], height = crop[3];
    if (image.width == width && image.height == height) return image;
    if (width == 0 || height == 0 || x + width > image.width || y + height > image.height) {
        throw Error(fmt::format("--crop {},{},{},{} is not a part of {}, which has {} x {} pixels",
                                x, y, width, height, path, image.width, image.height));
    }
    Image part(width, height, image.channels);
    const auto row = static_cast<std::ptrdiff_t>(image.channel_count()) * width;
    for (int j = 0; j < height; ++j) std::copy_n(image.at(x, y + j), row, part.at(0, j));
    return part;
}

Json to_json(const Metrics& metrics) {
    Json json = Json::object();
    json.set("relative_mse", metrics.relmse).set("mse", metrics.mse).set("rmse", metrics.rmse);
    json.set("trimmed_relative_mse", metrics.trimmed_relmse);
    json.set("trimmed_share", metrics.trimmed_share);
    return json.set("psnr", metrics.psnr);
}

Json to_json(const Comparison& comparison) {
    Json json = Json::object();
    json.set("schema", 1).set("pixels", comparison.pixels);
    json.set("non_finite_pixels", comparison.non_finite);
    json.set("non_finite_reference_pixels", comparison.non_finite_reference);
    json.set("epsilon", comparison.epsilon);
    json.set("finite_pixels", to_json(comparison.finite));
    return json.set("all_pixels", to_json(comparison.all));
}

void print(const Comparison& comparison) {
    const Metrics& m = comparison.finite;
    fmt::print("relMSE {:.6g}\n", m.relmse);
    fmt::print("  trimmed {:.6g}: without the worst {} of {} pixels, which hold {:.1f} %\n",
               m.trimmed_relmse, comparison.trimmed_pixels, comparison.pixels,
               100 * m.trimmed_share);
    fmt::print("MSE {:.6g}, RMSE {:.6g}, PSNR {:.2f} dB\n", m.mse, m.rmse, m.psnr);
    const std::size_t broken = comparison.non_finite + comparison.non_finite_reference;
    if (broken == 0) return;
    fmt::print(
        "not finite: {} pixels of the image, {} of the reference; the figures are those of "
        "all others\n",
        comparison.non_finite, comparison.non_finite_reference);
}

/// An EXR holds relative squared errors; a PNG their square roots as false colours, from black, no
/// error, to pale yellow, an error of the pixel's own size.
void write_error_image(const fs::path& path, const Image& image, const Image& reference,
                       double epsilon) {
    Image map = error_image(image, reference, epsilon);
    if (path.extension() == ".exr") {
        ImageFile file;
        add_layer(file, map);
        write_exr(path, file);
        return;
    }
    for (float& x : map.pixels) x = std::sqrt(x);
    write_png(path, false_color(map, 1));
}

class DiffCommand final : public Command {
public:
    explicit DiffCommand(const Params&) {}

    int run(const std::vector<std::string>& words) const override {
        std::string image_path, reference_path, error_path;
        std::vector<int> crop;
        std::optional<double> max_relmse;
        bool json = false;
        Arguments arguments("diff", "Compares a picture with a reference.");
        arguments.positional("IMAGE", image_path, "an EXR, Radiance, PNG or JPEG file");
        arguments.positional("REFERENCE", reference_path, "the same size, and less noise");
        arguments.option("--crop", "X,Y,W,H", crop, ',', 4, {.min = 0, .max = 65536},
                         "compares this part only; a picture of its size is taken for the part");
        arguments.option("--error-image", "FILE", error_path,
                         "a picture of the relative squared error: an EXR, or a PNG in false "
                         "colours");
        arguments.option("--max-relmse", "X", max_relmse, non_negative,
                         "exit code 6 if the relMSE is larger, or if a pixel is not finite");
        arguments.flag("--json", json, "prints JSON");
        arguments.footer("relMSE = mean (x - r)^2 / (r^2 + e), e = 0.01 (mean r)^2");
        if (const std::optional<int> code = arguments.parse(words)) return *code;
        ignore_write_signals();
        if (!error_path.empty()) check_writable(error_path);

        Image image = read_linear(image_path);
        Image reference = read_linear(reference_path);
        if (!crop.empty()) {
            image = part_of(image, crop, image_path);
            reference = part_of(reference, crop, reference_path);
        }
        const Comparison comparison = compare_images(image, reference);
        if (json) {
            fmt::print("{}", to_json(comparison).text());
        } else {
            print(comparison);
        }
        if (!error_path.empty()) {
            write_error_image(error_path, image, reference, comparison.epsilon);
        }
        const bool too_far = max_relmse && !(comparison.all.relmse <= *max_relmse);
        return too_far ? exit_code::comparison : exit_code::success;
    }
};

}  // namespace

const PluginInfo plugin = describe<DiffCommand>("compares a picture with a reference");

}  // namespace lucerna
