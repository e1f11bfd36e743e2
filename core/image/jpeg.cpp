// SPDX-License-Identifier: Apache-2.0
#include "core/image/jpeg.h"

#include <fmt/format.h>
#include <turbojpeg.h>

#include <memory>
#include <new>

#include "core/base/error.h"
#include "core/base/file_bytes.h"
#include "core/image/jpeg_notice.h"

namespace lucerna {

namespace {

struct Destroy {
    void operator()(void* decoder) const { tjDestroy(decoder); }
};

/// A shortened file is only a warning to the library, which fills the rest with grey; not here.
void check(tjhandle decoder, int result, const std::string& name) {
    if (result == 0) return;
    throw FileError(fmt::format("{}: is a damaged JPEG image: {}; get it again", name,
                                tjGetErrorStr2(decoder)));
}

/// Light that ideal inks leave: what is stored is the paper that each leaves bare, as all writers
/// since Adobe's do it.
std::vector<std::uint8_t> rgb_of_inks(const std::vector<std::uint8_t>& cmyk) {
    std::vector<std::uint8_t> rgb;
    rgb.reserve(cmyk.size() / 4 * 3);
    for (std::size_t i = 0; i + 3 < cmyk.size(); i += 4) {
        for (std::size_t c = 0; c < 3; ++c) {
            rgb.push_back(static_cast<std::uint8_t>((cmyk[i + c] * cmyk[i + 3] + 127) / 255));
        }
    }
    return rgb;
}

Image decode(std::span<const std::uint8_t> bytes, const std::string& name) {
    const std::unique_ptr<void, Destroy> decoder(tjInitDecompress());
    if (!decoder) throw std::bad_alloc();
    int width = 0, height = 0, subsampling = 0, color_space = 0;
    const int header = tjDecompressHeader3(decoder.get(), bytes.data(), bytes.size(), &width,
                                           &height, &subsampling, &color_space);
    check(decoder.get(), header, name);
    const bool cmyk = color_space == TJCS_CMYK || color_space == TJCS_YCCK;
    const bool grey = color_space == TJCS_GRAY;
    check_image_size(name, width, height, grey ? 1 : 3, bytes.size());

    Image image(width, height,
                grey ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"});
    image.srgb_encoded = true;
    image.eight_bits = true;
    image.notice = jpeg_notice(bytes, image);
    std::vector<std::uint8_t> samples(cmyk ? 4 * image.pixel_count() : image.pixels.size());
    // The accurate transform gives the same values on every processor.
    constexpr int flags = TJFLAG_ACCURATEDCT | TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS;
    const int body =
        tjDecompress2(decoder.get(), bytes.data(), bytes.size(), samples.data(), width, 0, height,
                      cmyk   ? TJPF_CMYK
                      : grey ? TJPF_GRAY
                             : TJPF_RGB,
                      flags);
    check(decoder.get(), body, name);
    if (cmyk) {
        image.notice = "it is in CMYK, made for print; its inks are taken as ideal ones";
        samples = rgb_of_inks(samples);
    }
    for (std::size_t i = 0; i < samples.size(); ++i) {
        image.pixels[i] = static_cast<float>(samples[i]) / 255.0f;
    }
    return image;
}

}  // namespace

Image decode_jpeg(std::span<const std::uint8_t> bytes, const std::string& name) {
    try {
        return decode(bytes, name);
    } catch (const std::bad_alloc&) {
        throw FileError(fmt::format("{}: does not fit into memory", name));
    }
}

Image read_jpeg(const std::filesystem::path& path) {
    return decode_jpeg(read_file_bytes(path), path.string());
}

}  // namespace lucerna
