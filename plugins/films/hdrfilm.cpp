// SPDX-License-Identifier: Apache-2.0
/// hdrfilm: an image of linear radiance in an OpenEXR file, or for the screen in a PNG.
///
/// As `ldrfilm` it writes a PNG unless file_format says otherwise: sRGB-encoded, 8 bits, values
/// above 1 clipped. Layers of the integrator go to the EXR only. There, colours have 16 bits by
/// default, and what may be a distance, a position or a number has 32. A portable float map has
/// 32 bits, and no alpha, as in Mitsuba.
#include "core/image/color.h"
#include "core/image/exr.h"
#include "core/image/plain_formats.h"
#include "core/image/png.h"
#include "core/interfaces/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace lucerna {

namespace {

enum class FileFormat { openexr, png, pfm };
enum class PixelColor { luminance, rgb, xyz };

struct PixelFormat {
    PixelColor color = PixelColor::rgb;
    bool alpha = false;
    bool operator==(const PixelFormat&) const = default;
};

bool is_color(const Plane& plane) {
    return plane.name == "R" || plane.name == "G" || plane.name == "B";
}
/// A channel of the image or of a layer that holds colours, by its name.
bool holds_color(const Plane& plane) {
    constexpr std::array<std::string_view, 5> names{"R", "G", "B", "A", "Y"};
    const std::string_view channel = std::string_view(plane.name).substr(plane.name.rfind('.') + 1);
    return std::find(names.begin(), names.end(), channel) != names.end();
}

/// R, G and B of `image` as one channel Y.
void add_luminance(const ImageFile& image, bool half, ImageFile& result) {
    const Image color = to_image(image);
    std::vector<float> y(color.pixel_count());
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = luminance(color.rgb(i));
    result.planes.push_back({.name = "Y", .samples = std::move(y), .half = half});
}

/// R, G and B of `image` as X, Y and Z of CIE 1931, of which the white D65 has Y = 1.
void add_xyz(const ImageFile& image, bool half, ImageFile& result) {
    static const Matrix3d xyz_from_rec709 = glm::inverse(rec709_from_xyz);
    const Image color = to_image(image);
    constexpr std::array names{"X", "Y", "Z"};
    for (int c = 0; c < 3; ++c) {
        std::vector<float> samples(color.pixel_count());
        for (std::size_t i = 0; i < samples.size(); ++i) {
            samples[i] = static_cast<float>((xyz_from_rec709 * ColorD(color.rgb(i)))[c]);
        }
        result.planes.push_back({.name = names[static_cast<std::size_t>(c)],
                                 .samples = std::move(samples),
                                 .half = half});
    }
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
               {"png", FileFormat::png},
               {"pfm", FileFormat::pfm}},
              "of the file")),
          pixel_format_(
              params.choice<PixelFormat>("pixel_format", {PixelColor::rgb, false},
                                         {{"luminance", {PixelColor::luminance, false}},
                                          {"luminance_alpha", {PixelColor::luminance, true}},
                                          {"rgb", {PixelColor::rgb, false}},
                                          {"rgba", {PixelColor::rgb, true}},
                                          {"xyz", {PixelColor::xyz, false}},
                                          {"xyza", {PixelColor::xyz, true}}},
                                         "channels of the file")),
          half_(params.choice<bool>("component_format", true,
                                    {{"float16", true}, {"float32", false}},
                                    "of OpenEXR channels; if not given, float32 for those that "
                                    "are no colours")),
          half_data_(half_ && params.has("component_format")),
          rfilter_(params.nested_or<RFilter>("gaussian", "the reconstruction filter")) {
        check_crop(params);
        check_formats(params);
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
        return file_format_ == FileFormat::png   ? ".png"
               : file_format_ == FileFormat::pfm ? ".pfm"
                                                 : ".exr";
    }

    void write(const ImageFile& image, const std::filesystem::path& path) const override {
        switch (file_format_) {
            case FileFormat::openexr:
                write_exr(path, selected(image, true));
                break;
            case FileFormat::png:
                write_png(path, ColorConfig().display(to_image(selected(image, false))));
                break;
            case FileFormat::pfm:
                write_portable_float_map(path, to_image(selected(image, false)));
                break;
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

    /// What the kind of file cannot hold becomes what is nearest to it, as in Mitsuba.
    void check_formats(const Params& params) {
        const bool pfm = file_format_ == FileFormat::pfm;
        if (pfm && half_ && params.has("component_format")) {
            params.warning("component_format", "the values of a PFM file have 32 bits");
        }
        if (pfm && pixel_format_.alpha) {
            params.warning("pixel_format", "a PFM file has no alpha, which is left out");
            pixel_format_.alpha = false;
        }
        if (file_format_ != FileFormat::openexr && pixel_format_.color == PixelColor::xyz) {
            params.warning("pixel_format", "only OpenEXR files hold X, Y and Z; it will be RGB");
            pixel_format_.color = PixelColor::rgb;
        }
    }

    /// The image in the pixel format; EXR files keep all other channels.
    ImageFile selected(const ImageFile& image, bool layers) const {
        ImageFile result = image;
        std::erase_if(result.planes, [&](const Plane& plane) {
            if (is_color(plane)) return pixel_format_.color != PixelColor::rgb;
            if (plane.name == "A") return !pixel_format_.alpha;
            return !layers;
        });
        for (Plane& plane : result.planes) {
            plane.half = (holds_color(plane) ? half_ : half_data_) &&
                         std::holds_alternative<std::vector<float>>(plane.samples);
        }
        if (pixel_format_.color == PixelColor::luminance) {
            add_luminance(image, half_, result);
        } else if (pixel_format_.color == PixelColor::xyz) {
            add_xyz(image, half_, result);
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

const PluginInfo plugin = describe<HdrFilm>("an image in an OpenEXR, PNG or PFM file");

}  // namespace lucerna
