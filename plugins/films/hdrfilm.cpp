// SPDX-License-Identifier: Apache-2.0
/// hdrfilm: an image of linear radiance in an OpenEXR file, or for the screen in a PNG.
///
/// As `ldrfilm` it writes a PNG unless file_format says otherwise: sRGB-encoded, 8 bits, values
/// above 1 clipped. Layers of the integrator go to the EXR only. There, colours have 16 bits by
/// default, and what may be a distance, a position or a number has 32.
#include "core/image/color.h"
#include "core/image/exr.h"
#include "core/image/png.h"
#include "core/interfaces/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace lucerna {

namespace {

enum class FileFormat { openexr, png };
enum class PixelFormat { luminance, luminance_alpha, rgb, rgba };

bool has_alpha(PixelFormat format) {
    return format == PixelFormat::luminance_alpha || format == PixelFormat::rgba;
}
bool is_grey(PixelFormat format) {
    return format == PixelFormat::luminance || format == PixelFormat::luminance_alpha;
}
bool is_color(const Plane& plane) {
    return plane.name == "R" || plane.name == "G" || plane.name == "B";
}
/// A channel of the image or of a layer that holds colours, by its name.
bool holds_color(const Plane& plane) {
    constexpr std::array<std::string_view, 5> names{"R", "G", "B", "A", "Y"};
    const std::string_view channel = std::string_view(plane.name).substr(plane.name.rfind('.') + 1);
    return std::find(names.begin(), names.end(), channel) != names.end();
}

/// R, G and B as one channel Y.
Plane luminance_plane(const ImageFile& image) {
    const Image color = to_image(image);
    std::vector<float> y(color.pixel_count());
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = luminance(color.rgb(i));
    return {.name = "Y", .samples = std::move(y)};
}

class HdrFilm final : public Film {
public:
    explicit HdrFilm(const Params& params)
        : size_{params.int32("width", 768, side, "of the whole image [pixels]"),
                params.int32("height", 576, side, "of the whole image [pixels]")},
          crop_{
              .offset = {params.int32("crop_offset_x", 0, {.min = 0}, "left of the crop window"),
                         params.int32("crop_offset_y", 0, {.min = 0}, "top of the crop window")},
              .size = {params.int32("crop_width", size_.x, side, "the whole width by default"),
                       params.int32("crop_height", size_.y, side, "the whole height by default")}},
          file_format_(params.choice<FileFormat>(
              "file_format", params.type() == "ldrfilm" ? FileFormat::png : FileFormat::openexr,
              {{"openexr", FileFormat::openexr},
               {"exr", FileFormat::openexr},
               {"png", FileFormat::png}},
              "of the file")),
          pixel_format_(
              params.choice<PixelFormat>("pixel_format", PixelFormat::rgb,
                                         {{"luminance", PixelFormat::luminance},
                                          {"luminance_alpha", PixelFormat::luminance_alpha},
                                          {"rgb", PixelFormat::rgb},
                                          {"rgba", PixelFormat::rgba}},
                                         "channels of the file")),
          half_(params.choice<bool>("component_format", true,
                                    {{"float16", true}, {"float32", false}},
                                    "of OpenEXR channels; if not given, float32 for those that "
                                    "are no colours")),
          half_data_(half_ && params.has("component_format")),
          rfilter_(params.nested_or<RFilter>("gaussian", "the reconstruction filter")) {
        check_crop(params);
        for (const char* name : {"banner", "label", "attach_log", "compensate"}) {
            params.no_effect(name, "files hold nothing but the image, and sums are exact");
        }
        for (const char* name : {"high_quality_edges", "sample_border"}) {
            params.no_effect(name, "no samples are taken beyond the edges of the whole image");
        }
        for (const char* name : {"gamma", "exposure", "tonemap_method", "key", "burn"}) {
            params.no_effect(name, "PNG files are encoded by the sRGB curve");
        }
    }

    Vector2i size() const override { return size_; }
    CropWindow crop() const override { return crop_; }
    const RFilter& rfilter() const override { return rfilter_; }
    const char* extension() const override {
        return file_format_ == FileFormat::png ? ".png" : ".exr";
    }

    void write(const ImageFile& image, const std::filesystem::path& path) const override {
        if (file_format_ == FileFormat::png) {
            write_png(path, ColorConfig().display(to_image(selected(image, false))));
        } else {
            write_exr(path, selected(image, true));
        }
    }

private:
    static constexpr Range side{.min = 1, .max = 65536};

    void check_crop(const Params& params) {
        const Vector2i end = crop_.offset + crop_.size;
        if (end.x <= size_.x && end.y <= size_.y) return;
        params.error(params.has("crop_width") ? "crop_width" : "crop_offset_x",
                     fmt::format("the crop window of {} × {} at ({}, {}) does not fit into the "
                                 "image of {} × {}",
                                 crop_.size.x, crop_.size.y, crop_.offset.x, crop_.offset.y,
                                 size_.x, size_.y));
    }

    /// The image in the pixel format; EXR files keep all other channels.
    ImageFile selected(const ImageFile& image, bool layers) const {
        ImageFile result = image;
        std::erase_if(result.planes, [&](const Plane& plane) {
            if (is_color(plane)) return is_grey(pixel_format_);
            if (plane.name == "A") return !has_alpha(pixel_format_);
            return !layers;
        });
        if (is_grey(pixel_format_)) {
            result.planes.insert(result.planes.begin(), luminance_plane(image));
        }
        for (Plane& plane : result.planes) {
            plane.half = (holds_color(plane) ? half_ : half_data_) &&
                         std::holds_alternative<std::vector<float>>(plane.samples);
        }
        return result;
    }

    Vector2i size_;
    CropWindow crop_;
    FileFormat file_format_;
    PixelFormat pixel_format_;
    bool half_, half_data_;
    const RFilter& rfilter_;
};

}  // namespace

const PluginInfo plugin = describe<HdrFilm>("an image in an OpenEXR or PNG file");

}  // namespace lucerna
