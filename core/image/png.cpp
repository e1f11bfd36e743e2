// SPDX-License-Identifier: Apache-2.0
#include "core/image/png.h"

#include <fmt/format.h>
#include <png.h>

#include <cmath>
#include <csetjmp>
#include <cstring>

#include "core/base/atomic_file.h"
#include "core/base/error.h"
#include "core/base/file_bytes.h"
#include "core/image/icc_profile.h"

namespace lucerna {

namespace {

/// libpng reports errors by longjmp, which must not cross a destructor. So everything that owns
/// memory lives here, in the caller of the functions that call libpng; those have only plain
/// locals, and do not call anything that can throw while libpng is on the stack.
struct Job {
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::string message;

    // Reading
    std::span<const std::uint8_t> input;
    std::size_t position = 0;
    png_uint_32 width = 0, height = 0;
    std::size_t channels = 0;
    std::size_t row_bytes = 0;
    int bits = 0;
    std::vector<std::uint8_t> samples;
    bool srgb = true;
    double file_gamma = 0;  ///< encoded = linear^file_gamma, unless `srgb`
    std::optional<Chromaticities> chromaticities;
    std::span<const std::uint8_t> profile;  ///< ICC; owned by libpng

    // Writing
    const Image8* image = nullptr;
    std::string output;

    bool writing() const { return image != nullptr; }
    ~Job() {
        if (png && writing()) png_destroy_write_struct(&png, &info);
        if (png && !writing()) png_destroy_read_struct(&png, &info, nullptr);
    }
};

Job& job_of(png_structp png) { return *static_cast<Job*>(png_get_error_ptr(png)); }

/// Appends without ever throwing: running out of memory must not unwind through libpng.
void add_message(Job& job, const char* message) noexcept {
    try {
        job.message += (job.message.empty() ? "" : ": ") + std::string(message);
    } catch (const std::exception&) {
        job.message.clear();
    }
}

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
    add_message(job_of(png), message);
    png_longjmp(png, 1);
}

/// Often the reason for the error that follows; of no interest if none does.
void on_warning(png_structp png, png_const_charp message) {
    Job& job = job_of(png);
    job.message.clear();
    add_message(job, message);
}

void on_read(png_structp png, png_bytep out, std::size_t count) {
    Job& job = job_of(png);
    if (count > job.input.size() - job.position) png_error(png, "it ends too early");
    std::memcpy(out, job.input.data() + job.position, count);
    job.position += count;
}

bool append(Job& job, const png_bytep data, std::size_t count) noexcept {
    try {
        job.output.append(reinterpret_cast<const char*>(data), count);
        return true;
    } catch (const std::exception&) {
        return false;
    }
}

void on_write(png_structp png, png_bytep data, std::size_t count) {
    if (!append(job_of(png), data, count)) png_error(png, "out of memory");
}

void on_flush(png_structp) {}

/// What the chunks say of the meaning of the samples (PNG 3rd edition, 4.3).
void read_color_space(Job& job) {
    png_charp name = nullptr;
    png_bytep profile = nullptr;
    png_uint_32 size = 0;
    int compression = 0;
    if (png_get_valid(job.png, job.info, PNG_INFO_sRGB) != 0) return;
    if (png_get_iCCP(job.png, job.info, &name, &compression, &profile, &size) != 0) {
        job.profile = {profile, size};
        return;
    }
    double gamma = 0;
    if (png_get_gAMA(job.png, job.info, &gamma) != 0) {
        job.file_gamma = gamma;
        job.srgb = std::abs(gamma * 2.2 - 1) < 0.05;  // as near as libpng takes for equal
    }
    Chromaticities c;
    if (png_get_cHRM(job.png, job.info, &c.white.x, &c.white.y, &c.red.x, &c.red.y, &c.green.x,
                     &c.green.y, &c.blue.x, &c.blue.y) != 0) {
        job.chromaticities = c;
    }
}

/// Reads the header and asks for whole samples of 8 or 16 bits. False: see `message`.
bool read_header(Job& job) {
    if (setjmp(png_jmpbuf(job.png))) return false;
    png_set_user_limits(job.png, 65536, 65536);
    png_set_chunk_malloc_max(job.png, 1 << 26);
    png_set_read_fn(job.png, nullptr, on_read);
    png_read_info(job.png, job.info);
    read_color_space(job);
    png_set_expand(job.png);
    if (png_get_bit_depth(job.png, job.info) == 16) png_set_swap(job.png);
    png_set_interlace_handling(job.png);
    png_read_update_info(job.png, job.info);
    job.width = png_get_image_width(job.png, job.info);
    job.height = png_get_image_height(job.png, job.info);
    job.channels = png_get_channels(job.png, job.info);
    job.bits = png_get_bit_depth(job.png, job.info);
    job.row_bytes = png_get_rowbytes(job.png, job.info);
    return true;
}

bool read_rows(Job& job, png_bytepp rows) {
    if (setjmp(png_jmpbuf(job.png))) return false;
    png_read_image(job.png, rows);
    png_read_end(job.png, nullptr);
    return true;
}

bool write_image(Job& job, png_bytepp rows) {
    if (setjmp(png_jmpbuf(job.png))) return false;
    png_set_write_fn(job.png, nullptr, on_write, on_flush);
    const Image8& image = *job.image;
    png_set_IHDR(job.png, job.info, static_cast<png_uint_32>(image.width),
                 static_cast<png_uint_32>(image.height), 8,
                 image.channel_count == 4 ? PNG_COLOR_TYPE_RGBA : PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(job.png, job.info, PNG_sRGB_INTENT_RELATIVE);
    png_write_info(job.png, job.info);
    png_write_image(job.png, rows);
    png_write_end(job.png, job.info);
    return true;
}

std::vector<png_bytep> rows_of(std::uint8_t* data, std::size_t height, std::size_t row_bytes) {
    std::vector<png_bytep> rows(height);
    for (std::size_t y = 0; y < height; ++y) rows[y] = data + y * row_bytes;
    return rows;
}

std::vector<std::string> channel_names(std::size_t count) {
    switch (count) {
        case 1:
            return {"Y"};
        case 2:
            return {"Y", "A"};
        case 3:
            return {"R", "G", "B"};
        default:
            return {"R", "G", "B", "A"};
    }
}

Image to_floats(const Job& job) {
    Image image(static_cast<int>(job.width), static_cast<int>(job.height),
                channel_names(job.channels));
    image.srgb_encoded = job.srgb;
    if (!job.srgb) image.gamma = static_cast<float>(1 / job.file_gamma);
    image.chromaticities = job.chromaticities;
    image.eight_bits = job.bits == 8;
    if (!job.profile.empty()) image.notice = follow_icc_profile(job.profile, image);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        if (job.bits == 16) {
            std::uint16_t value = 0;
            std::memcpy(&value, job.samples.data() + 2 * i, 2);
            image.pixels[i] = static_cast<float>(value) / 65535.0f;
        } else {
            image.pixels[i] = static_cast<float>(job.samples[i]) / 255.0f;
        }
    }
    return image;
}

[[noreturn]] void damaged(const std::string& name, const Job& job) {
    throw FileError(fmt::format("{}: is a damaged PNG image: {}; get it again", name, job.message));
}

Image decode(Job& job, const std::string& name) {
    job.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning);
    if (job.png) job.info = png_create_info_struct(job.png);
    if (!job.info) throw std::bad_alloc();
    if (!read_header(job)) damaged(name, job);
    check_image_size(name, job.width, job.height, static_cast<std::int64_t>(job.channels),
                     job.input.size());
    job.samples.resize(job.row_bytes * job.height);
    std::vector<png_bytep> rows = rows_of(job.samples.data(), job.height, job.row_bytes);
    if (!read_rows(job, rows.data())) damaged(name, job);
    return to_floats(job);
}

}  // namespace

Image decode_png(std::span<const std::uint8_t> bytes, const std::string& name) {
    Job job;
    job.input = bytes;
    try {
        return decode(job, name);
    } catch (const std::bad_alloc&) {
        throw FileError(fmt::format("{}: does not fit into memory", name));
    }
}

Image read_png(const std::filesystem::path& path) {
    return decode_png(read_file_bytes(path), path.string());
}

std::string encode_png(const Image8& image) {
    const bool channels_known = image.channel_count == 3 || image.channel_count == 4;
    const std::size_t row_bytes =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channel_count);
    const auto height = static_cast<std::size_t>(image.height);
    if (image.width <= 0 || image.height <= 0 || !channels_known ||
        image.pixels.size() != row_bytes * height) {
        throw Error(fmt::format("an image of {} x {} pixels, {} channels and {} bytes is no PNG",
                                image.width, image.height, image.channel_count,
                                image.pixels.size()));
    }
    Job job;
    job.image = &image;
    job.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning);
    if (job.png) job.info = png_create_info_struct(job.png);
    // libpng takes pointers to non-const rows, and does not write to them.
    auto* data = const_cast<std::uint8_t*>(image.pixels.data());
    std::vector<png_bytep> rows = rows_of(data, height, row_bytes);
    if (!job.info || !write_image(job, rows.data())) {
        throw Error(fmt::format("making a PNG image failed: {}",
                                job.message.empty() ? "out of memory" : job.message));
    }
    return std::move(job.output);
}

void write_png(const std::filesystem::path& path, const Image8& image) {
    write_file_atomically(path, encode_png(image));
}

}  // namespace lucerna
