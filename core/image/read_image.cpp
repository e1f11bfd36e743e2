// SPDX-License-Identifier: Apache-2.0
#include "core/image/read_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string_view>

#include "core/base/error.h"
#include "core/base/file_bytes.h"
#include "core/image/exr.h"
#include "core/image/hdr.h"
#include "core/image/jpeg.h"
#include "core/image/plain_formats.h"
#include "core/image/png.h"

namespace lucerna {

namespace {

bool starts_with(std::span<const std::uint8_t> bytes, std::string_view signature) {
    return bytes.size() >= signature.size() &&
           std::equal(signature.begin(), signature.end(), bytes.begin(),
                      [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

/// The format has no signature in front, and the one at its end is newer than many files.
bool is_tga(std::span<const std::uint8_t> bytes, const std::filesystem::path& path) {
    constexpr std::string_view signature("TRUEVISION-XFILE.\0", 18);
    if (bytes.size() > signature.size() &&
        starts_with(bytes.subspan(bytes.size() - signature.size()), signature)) {
        return true;
    }
    const std::string extension = path.extension().string();
    return !bytes.empty() && (extension == ".tga" || extension == ".TGA");
}

/// The layer without a name, or, where all have one, the first of a whole colour: programs that
/// write many layers give a name to each.
Image main_layer(const ImageFile& file) {
    const std::vector<std::string> layers = file.layers();
    if (std::ranges::find(layers, "") != layers.end()) return to_image(file);
    for (const std::string& layer : layers) {
        Image image = to_image(file, layer);
        const auto has = [&](const char* channel) { return image.channel(channel).has_value(); };
        if (!has("R") || !has("G") || !has("B")) continue;
        image.notice += fmt::format("{}all its channels are in layers, of which \"{}\" is used",
                                    image.notice.empty() ? "" : "; ", layer);
        return image;
    }
    return to_image(file);
}

}  // namespace

Image read_image(const std::filesystem::path& path, ExrWindow window) {
    const std::vector<std::uint8_t> bytes = read_file_bytes(path);
    const std::string name = path.string();
    if (starts_with(bytes, "\x76\x2f\x31\x01")) {
        const ImageFile file = decode_exr(bytes, name);
        try {
            const Image stored = main_layer(file);
            const Vector2i size(file.full_width, file.full_height);
            const bool whole =
                size == Vector2i(file.width, file.height) && file.x == 0 && file.y == 0;
            if (whole || window == ExrWindow::data) return stored;
            return placed(stored, {file.x, file.y}, size);
        } catch (const Error& error) {
            throw FileError(fmt::format("{}: {}", name, error.what()));
        }
    }
    if (starts_with(bytes, "\x89PNG")) return decode_png(bytes, name);
    if (starts_with(bytes, "\xff\xd8\xff")) return decode_jpeg(bytes, name);
    if (starts_with(bytes, "#?")) return decode_hdr(bytes, name);
    if (starts_with(bytes, "BM")) return decode_bmp(bytes, name);
    for (const char* type : {"P5", "P6", "Pf", "PF"}) {
        if (starts_with(bytes, type)) return decode_portable_map(bytes, name);
    }
    if (is_tga(bytes, path)) return decode_tga(bytes, name);
    throw FileError(
        fmt::format("{}: is {}; convert it to OpenEXR, PNG, JPEG or Radiance (.hdr)", name,
                    bytes.empty() ? "empty" : "not an image of a format that can be read"));
}

}  // namespace lucerna
