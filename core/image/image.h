// SPDX-License-Identifier: Apache-2.0
/// Images in memory. `Image` is what textures, metrics and displays work on: interleaved floats.
/// `ImageFile` is what a file can hold: named planes of either type, and metadata. `Image8` is
/// what a screen shows.
///
/// Rows run from top to bottom, pixels from left to right.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/math/vector.h"

namespace lucerna {

/// CIE 1931 xy of the primaries and of white.
struct Chromaticities {
    Vector2d red{0.64, 0.33}, green{0.30, 0.60}, blue{0.15, 0.06}, white{0.3127, 0.3290};

    /// Equal as far as the floats of an EXR file can tell.
    bool operator==(const Chromaticities& o) const {
        const auto near = [](Vector2d a, Vector2d b) { return glm::length(a - b) < 1e-6; };
        return near(red, o.red) && near(green, o.green) && near(blue, o.blue) &&
               near(white, o.white);
    }
    /// Rec. ITU-R BT.709, which is also sRGB: the default values.
    static Chromaticities rec709() { return {}; }
};

/// Interleaved float pixels. Colour comes first: with three or more channels the first three are
/// red, green and blue, or X, Y and Z up to `ColorConfig::to_rendering`; with one or two the first
/// is grey.
struct Image {
    int width = 0;
    int height = 0;
    std::vector<std::string> channels;  ///< "R", "G", "B", "A"; "Y" for grey
    std::vector<float> pixels;          ///< width · height · channels.size() values
    /// The values are encoded for display by the sRGB curve, in [0, 1]: 8 and 16 bit files that
    /// do not say otherwise.
    bool srgb_encoded = false;
    /// If they are not: linear light is value^gamma.
    float gamma = 1;
    /// All values are k / 255 for whole numbers k.
    bool eight_bits = false;
    /// What red, green and blue mean, where the file says so.
    std::optional<Chromaticities> chromaticities{};
    /// What the file says about its pixels and is not followed; empty if there is no such thing.
    std::string notice{};

    Image() = default;
    /// All zero. Throws Error if a dimension is not positive.
    Image(int width, int height, std::vector<std::string> channels = {"R", "G", "B"});

    std::size_t pixel_count() const { return std::size_t(width) * std::size_t(height); }
    std::size_t channel_count() const { return channels.size(); }
    /// The channels of one pixel.
    float* at(int x, int y) { return pixels.data() + offset(x, y); }
    const float* at(int x, int y) const { return pixels.data() + offset(x, y); }

    /// The colour of a pixel; grey images give it three times.
    Color rgb(int x, int y) const { return rgb(at(x, y)); }
    /// The colour of the pixel with index x + y · width.
    Color rgb(std::size_t index) const { return rgb(pixels.data() + index * channels.size()); }
    void set_rgb(int x, int y, Color color);

    /// The position of a channel within a pixel, if there is one of that name.
    std::optional<std::size_t> channel(std::string_view name) const;

private:
    std::size_t offset(int x, int y) const {
        return (std::size_t(y) * std::size_t(width) + std::size_t(x)) * channels.size();
    }
    Color rgb(const float* p) const {
        return channels.size() >= 3 ? Color(p[0], p[1], p[2]) : Color(p[0]);
    }
};

/// Bytes for a screen, 3 or 4 channels, interleaved, encoded for the display.
struct Image8 {
    int width = 0;
    int height = 0;
    int channel_count = 3;
    std::vector<std::uint8_t> pixels{};
    /// Pixels with a NaN or an infinity in the source; they are shown, but must be told of.
    std::size_t non_finite = 0;
};

/// One named channel of a file.
struct Plane {
    std::string name;                                                        ///< "R", or "layer.R"
    std::variant<std::vector<float>, std::vector<std::uint32_t>> samples{};  ///< width · height
    bool half = false;  ///< floats: 16 bits in the file are enough
};

using MetadataValue = std::variant<std::string, int, double>;
using Metadata = std::map<std::string, MetadataValue, std::less<>>;

/// The content of a file: planes of one size, and what is known about them.
struct ImageFile {
    int width = 0;   ///< of the planes (the data window)
    int height = 0;  ///< of the planes (the data window)
    /// Where the planes lie in the full image, whose size is `full_width` × `full_height`;
    /// zero sizes: the planes are the full image.
    int x = 0, y = 0;
    int full_width = 0, full_height = 0;
    std::vector<Plane> planes{};
    Metadata metadata{};
    std::optional<Chromaticities> chromaticities{};
    std::string notice{};  ///< as of an Image

    const Plane* plane(std::string_view name) const;
    /// The names before the last dot of the planes' names, each once; "" is the main layer.
    std::vector<std::string> layers() const;
};

/// The planes of one layer as floats, colour first. Throws Error naming the layers if there is
/// no such layer.
Image to_image(const ImageFile& file, std::string_view layer = "");

/// The channel with this index as a grey image; alpha is not encoded.
Image one_channel(const Image& image, std::size_t index);

/// An image of `size` that has `image` at `offset` and is zero elsewhere; what lies outside of it
/// is cut off.
Image placed(const Image& image, Vector2i offset, Vector2i size);

/// Adds the channels of an image as float planes "layer.R", … ; the main layer is "".
/// Throws Error if the sizes differ or a plane of that name is there already.
void add_layer(ImageFile& file, const Image& image, std::string_view layer = "", bool half = false);

/// Throws Error where an image is larger than this program reads (65536 a side), or so much larger
/// than its file that the file must be damaged or malicious. `samples` counts values of all
/// channels, `file_bytes` is the length of the file.
void check_image_size(const std::string& name, std::int64_t width, std::int64_t height,
                      std::int64_t channels, std::size_t file_bytes);

}  // namespace lucerna
