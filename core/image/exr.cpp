// SPDX-License-Identifier: Apache-2.0
#include "core/image/exr.h"

#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <set>
#include <thread>

#include "core/base/atomic_file.h"
#include "core/base/error.h"
#include "core/base/file_bytes.h"
#include "core/image/exr_header.h"

namespace lucerna {

namespace {

constexpr float half_largest = 65504;

/// What must be set once in a process: limits against damaged headers, and OpenEXR's own threads
/// (none unless asked for), which only share the work of compression.
void prepare_library() {
    static const bool prepared = [] {
        Imf::Header::setMaxImageSize(65536, 65536);
        Imf::Header::setMaxTileSize(65536, 65536);
        Imf::setGlobalThreadCount(int(std::min(std::thread::hardware_concurrency(), 8u)));
        return true;
    }();
    static_cast<void>(prepared);
}

/// The bytes of a file, so that reading past their end is an exception and never waits.
class MemoryInput final : public Imf::IStream {
public:
    MemoryInput(std::span<const std::uint8_t> bytes, const std::string& name)
        : IStream(name.c_str()), bytes_(bytes) {}

    bool read(char out[], int count) override {
        const std::size_t n = static_cast<std::size_t>(count);
        if (count < 0 || position_ > bytes_.size() || n > bytes_.size() - position_) {
            throw FileError("it ends too early");
        }
        if (n > 0) std::memcpy(out, bytes_.data() + position_, n);
        position_ += n;
        return position_ < bytes_.size();
    }
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override { position_ = position; }
    void clear() override {}

private:
    std::span<const std::uint8_t> bytes_;
    std::size_t position_ = 0;
};

/// Collects a file in memory: OpenEXR's own stream swallows the errors of its last writes.
class MemoryOutput final : public Imf::OStream {
public:
    MemoryOutput() : OStream("memory") {}

    void write(const char data[], int count) override {
        const std::size_t n = static_cast<std::size_t>(count);
        if (position_ + n > bytes.size()) bytes.resize(position_ + n);
        std::memcpy(bytes.data() + position_, data, n);
        position_ += n;
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override { position_ = position; }

    std::string bytes;

private:
    std::size_t position_ = 0;
};

/// The attributes that describe the file itself.
bool reserved(const std::string& name) {
    static const std::set<std::string> names = [] {
        std::set<std::string> all{"type",           "name",       "view",
                                  "multiView",      "chunkCount", "version",
                                  "chromaticities", "tiles",      "maxSamplesPerPixel"};
        const Imf::Header plain;
        for (auto it = plain.begin(); it != plain.end(); ++it) all.insert(it.name());
        return all;
    }();
    return names.contains(name);
}

Metadata metadata_of(const Imf::Header& header) {
    Metadata metadata;
    for (auto it = header.begin(); it != header.end(); ++it) {
        if (reserved(it.name())) continue;
        const Imf::Attribute* attribute = &it.attribute();
        if (const auto* s = dynamic_cast<const Imf::StringAttribute*>(attribute)) {
            metadata[it.name()] = s->value();
        } else if (const auto* i = dynamic_cast<const Imf::IntAttribute*>(attribute)) {
            metadata[it.name()] = i->value();
        } else if (const auto* d = dynamic_cast<const Imf::DoubleAttribute*>(attribute)) {
            metadata[it.name()] = d->value();
        } else if (const auto* f = dynamic_cast<const Imf::FloatAttribute*>(attribute)) {
            metadata[it.name()] = double{f->value()};
        }
    }
    return metadata;
}

void add_metadata(Imf::Header& header, const Metadata& metadata) {
    for (const auto& [name, value] : metadata) {
        if (name.empty() || name.size() > 255 || reserved(name)) {
            throw Error(fmt::format("\"{}\" cannot be the name of metadata in an EXR file", name));
        }
        if (const auto* s = std::get_if<std::string>(&value)) {
            header.insert(name, Imf::StringAttribute(*s));
        } else if (const auto* i = std::get_if<int>(&value)) {
            header.insert(name, Imf::IntAttribute(*i));
        } else {
            header.insert(name, Imf::DoubleAttribute(std::get<double>(value)));
        }
    }
}

Vector2d vector2d(Imath::V2f v) { return {double{v.x}, double{v.y}}; }
Imath::V2f v2f(Vector2d v) { return {static_cast<float>(v.x), static_cast<float>(v.y)}; }

std::optional<Chromaticities> chromaticities_of(const Imf::Header& header) {
    if (!Imf::hasChromaticities(header)) return {};
    const Imf::Chromaticities c = Imf::chromaticities(header);
    return Chromaticities{vector2d(c.red), vector2d(c.green), vector2d(c.blue), vector2d(c.white)};
}

/// Luminance, and chroma at every second pixel of every second row (Imf::WRITE_YC). Together they
/// are a colour.
bool is_luminance_chroma(std::string_view channel) {
    return channel == "Y" || channel == "RY" || channel == "BY";
}

/// Whether the colour is stored as luminance and chroma.
bool check_channels(const Imf::Header& header, const std::string& name) {
    const Imf::ChannelList& channels = header.channels();
    if (channels.begin() == channels.end()) {
        throw FileError(fmt::format("{}: the image has no channels", name));
    }
    const bool chroma =
        !channels.findChannel("R") && (channels.findChannel("RY") || channels.findChannel("BY"));
    for (const char* needed : {"Y", "RY", "BY"}) {
        if (chroma && !channels.findChannel(needed)) {
            throw FileError(
                fmt::format("{}: stores luminance and chroma, but has no channel "
                            "\"{}\"; save it as RGB",
                            name, needed));
        }
    }
    for (auto it = channels.begin(); it != channels.end(); ++it) {
        const std::string channel = it.name();
        const int x = it.channel().xSampling, y = it.channel().ySampling;
        const int expected = chroma && (channel == "RY" || channel == "BY") ? 2 : 1;
        if (x == expected && y == expected) continue;
        throw FileError(expected == 1
                            ? fmt::format("{}: channel \"{}\" is subsampled; save it at full "
                                          "resolution",
                                          name, channel)
                            : fmt::format("{}: channel \"{}\" has a value for {} x {} pixels, not "
                                          "for 2 x 2; save it as RGB",
                                          name, channel, x, y));
    }
    return chroma;
}

/// Where sample (0, 0) of the file would lie, given where the first one of the data window does.
template <typename T>
Imf::Slice slice(Imf::PixelType type, const std::vector<T>& samples, const Imath::Box2i& window) {
    const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
    return Imf::Slice::Make(type, samples.data(), window, sizeof(T), sizeof(T) * width);
}

/// All channels, but for those of luminance and chroma if they are read by themselves.
void read_planes(Imf::InputFile& input, bool chroma_apart, ImageFile& file) {
    const Imath::Box2i window = input.header().dataWindow();
    const std::size_t count = std::size_t(file.width) * std::size_t(file.height);
    const Imf::ChannelList& channels = input.header().channels();
    Imf::FrameBuffer buffer;
    for (auto it = channels.begin(); it != channels.end(); ++it) {
        if (chroma_apart && is_luminance_chroma(it.name())) continue;
        Plane plane{.name = it.name(), .half = it.channel().type == Imf::HALF};
        if (it.channel().type == Imf::UINT) {
            plane.samples = std::vector<std::uint32_t>(count);
        } else {
            plane.samples = std::vector<float>(count);
        }
        file.planes.push_back(std::move(plane));
    }
    for (Plane& plane : file.planes) {
        if (const auto* floats = std::get_if<std::vector<float>>(&plane.samples)) {
            buffer.insert(plane.name, slice(Imf::FLOAT, *floats, window));
        } else {
            const auto& ids = std::get<std::vector<std::uint32_t>>(plane.samples);
            buffer.insert(plane.name, slice(Imf::UINT, ids, window));
        }
    }
    input.setFrameBuffer(buffer);
    input.readPixels(window.min.y, window.max.y);
}

/// Red, green and blue of a file of luminance and chroma, by OpenEXR's own filter between the
/// values of chroma.
void read_luminance_chroma(Imf::IStream& stream, const std::string& name, ImageFile& file) {
    stream.seekg(0);
    Imf::RgbaInputFile input(stream);
    const Imath::Box2i window = input.dataWindow();
    const auto width = static_cast<std::size_t>(file.width);
    std::vector<Imf::Rgba> pixels(width * static_cast<std::size_t>(file.height));
    input.setFrameBuffer(Imf::ComputeBasePointer(pixels.data(), window), 1, width);
    input.readPixels(window.min.y, window.max.y);
    const auto add = [&](const char* plane, half Imf::Rgba::*component) {
        std::vector<float> samples(pixels.size());
        std::ranges::transform(pixels, samples.begin(),
                               [&](const Imf::Rgba& pixel) { return pixel.*component; });
        if (!std::ranges::all_of(samples, [](float x) { return std::isfinite(x); })) {
            throw FileError(fmt::format(
                "{}: luminance and chroma give a colour above 65504; save it as RGB", name));
        }
        file.planes.push_back({.name = plane, .samples = std::move(samples), .half = true});
    };
    add("R", &Imf::Rgba::r);
    add("G", &Imf::Rgba::g);
    add("B", &Imf::Rgba::b);
}

enum class Content { all, header };

ImageFile decode(std::span<const std::uint8_t> bytes, const std::string& name, Content content) {
    prepare_library();
    const int parts = check_exr_header(bytes);
    MemoryInput stream(bytes, name);
    Imf::InputFile input(stream);
    const Imf::Header& header = input.header();
    if (header.hasType() && header.type() != Imf::SCANLINEIMAGE &&
        header.type() != Imf::TILEDIMAGE) {
        throw FileError(fmt::format("{}: holds deep data; flatten it to an ordinary image", name));
    }
    const bool chroma = check_channels(header, name);

    const Imath::Box2i& data = header.dataWindow();
    const Imath::Box2i& full = header.displayWindow();
    const auto size = [](int low, int high) { return std::int64_t{high} - low + 1; };
    std::int64_t channels = 0;
    for (auto it = header.channels().begin(); it != header.channels().end(); ++it) ++channels;
    check_image_size(name, size(data.min.x, data.max.x), size(data.min.y, data.max.y), channels,
                     bytes.size());
    check_image_size(name, size(full.min.x, full.max.x), size(full.min.y, full.max.y), 1,
                     SIZE_MAX >> 1);

    ImageFile file;
    file.width = data.max.x - data.min.x + 1;
    file.height = data.max.y - data.min.y + 1;
    file.x = data.min.x - full.min.x;
    file.y = data.min.y - full.min.y;
    file.full_width = full.max.x - full.min.x + 1;
    file.full_height = full.max.y - full.min.y + 1;
    if (parts > 1) file.notice = fmt::format("it has {} parts, of which the first is used", parts);
    file.metadata = metadata_of(header);
    file.chromaticities = chromaticities_of(header);
    if (content == Content::header) return file;
    read_planes(input, chroma, file);
    if (chroma) read_luminance_chroma(stream, name, file);
    return file;
}

Imf::Header make_header(const ImageFile& file, ExrCompression compression) {
    const int full_width = file.full_width > 0 ? file.full_width : file.width;
    const int full_height = file.full_height > 0 ? file.full_height : file.height;
    const Imath::Box2i full({0, 0}, {full_width - 1, full_height - 1});
    const Imath::Box2i data({file.x, file.y}, {file.x + file.width - 1, file.y + file.height - 1});
    Imf::Header header(full, data);
    header.compression() =
        compression == ExrCompression::piz ? Imf::PIZ_COMPRESSION : Imf::ZIP_COMPRESSION;
    const Chromaticities c = file.chromaticities.value_or(Chromaticities::rec709());
    Imf::addChromaticities(header, {v2f(c.red), v2f(c.green), v2f(c.blue), v2f(c.white)});
    add_metadata(header, file.metadata);
    for (const Plane& plane : file.planes) {
        const std::size_t samples =
            std::visit([](const auto& s) { return s.size(); }, plane.samples);
        if (plane.name.empty() || samples != std::size_t(file.width) * std::size_t(file.height)) {
            throw Error(fmt::format("channel \"{}\" has {} samples, the image has {} x {} pixels",
                                    plane.name, samples, file.width, file.height));
        }
        if (header.channels().findChannel(plane.name)) {
            throw Error(fmt::format("the channel \"{}\" is there twice", plane.name));
        }
        const bool ids = std::holds_alternative<std::vector<std::uint32_t>>(plane.samples);
        const Imf::PixelType type = ids ? Imf::UINT : plane.half ? Imf::HALF : Imf::FLOAT;
        header.channels().insert(plane.name, Imf::Channel(type));
    }
    return header;
}

/// Finite values stay finite: above 65519 a half would be an infinity.
std::vector<half> to_half(const std::vector<float>& values, std::size_t& clamped) {
    std::vector<half> result(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float v = values[i];
        const bool too_large = std::isfinite(v) && std::abs(v) > half_largest;
        clamped += too_large ? 1 : 0;
        result[i] = half(too_large ? std::copysign(half_largest, v) : v);
    }
    return result;
}

ImageFile decode_safely(std::span<const std::uint8_t> bytes, const std::string& name,
                        Content content) {
    // Flag 0x800 of the version field: deep data, whose readers are best never entered.
    constexpr int deep_flag = 0x800;
    int version = 0;
    if (bytes.size() >= 8) version = bytes[4] | bytes[5] << 8;
    if (version & deep_flag) {
        throw FileError(fmt::format("{}: holds deep data; flatten it to an ordinary image", name));
    }
    try {
        return decode(bytes, name, content);
    } catch (const std::bad_alloc&) {
        throw FileError(fmt::format("{}: does not fit into memory, or is damaged", name));
    } catch (const FileError& error) {
        const std::string_view message = error.what();
        if (message.starts_with(name)) throw;
        throw FileError(fmt::format("{}: is damaged: {}; get it again", name, message));
    } catch (const std::exception& error) {
        throw FileError(fmt::format("{}: is damaged or not an OpenEXR image: {}; get it again",
                                    name, error.what()));
    }
}

}  // namespace

ImageFile decode_exr(std::span<const std::uint8_t> bytes, const std::string& name) {
    return decode_safely(bytes, name, Content::all);
}

ImageFile decode_exr_header(std::span<const std::uint8_t> bytes, const std::string& name) {
    return decode_safely(bytes, name, Content::header);
}

ImageFile read_exr(const std::filesystem::path& path) {
    return decode_exr(read_file_bytes(path), path.string());
}

std::string encode_exr(const ImageFile& file, ExrCompression compression, std::size_t* clamped) {
    if (file.width <= 0 || file.height <= 0 || file.planes.empty()) {
        throw Error(fmt::format("an image of {} x {} pixels and {} channels cannot be written",
                                file.width, file.height, file.planes.size()));
    }
    prepare_library();
    MemoryOutput stream;
    std::size_t clamped_values = 0;
    try {
        const Imf::Header header = make_header(file, compression);
        std::vector<std::vector<half>> halves;
        halves.reserve(file.planes.size());
        Imf::FrameBuffer buffer;
        for (const Plane& plane : file.planes) {
            const Imath::Box2i& window = header.dataWindow();
            if (const auto* ids = std::get_if<std::vector<std::uint32_t>>(&plane.samples)) {
                buffer.insert(plane.name, slice(Imf::UINT, *ids, window));
                continue;
            }
            const auto& floats = std::get<std::vector<float>>(plane.samples);
            if (plane.half) {
                halves.push_back(to_half(floats, clamped_values));
                buffer.insert(plane.name, slice(Imf::HALF, halves.back(), window));
            } else {
                buffer.insert(plane.name, slice(Imf::FLOAT, floats, window));
            }
        }
        Imf::OutputFile output(stream, header);
        output.setFrameBuffer(buffer);
        output.writePixels(file.height);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error("there is not enough memory to make an EXR file");
    } catch (const std::exception& error) {
        throw Error(fmt::format("making an EXR file failed: {}", error.what()));
    }
    if (clamped) *clamped = clamped_values;
    return std::move(stream.bytes);
}

std::size_t write_exr(const std::filesystem::path& path, const ImageFile& file,
                      ExrCompression compression) {
    std::size_t clamped = 0;
    write_file_atomically(path, encode_exr(file, compression, &clamped));
    return clamped;
}

}  // namespace lucerna
