// SPDX-License-Identifier: Apache-2.0
#include "plugins/volumes/vol_file.h"

#include "core/base/error.h"
#include "core/base/file_bytes.h"
#include "core/base/parallel.h"
#include "plugins/volumes/machine_memory.h"

#include <fmt/format.h>

#include <array>
#include <bit>

namespace lucerna {

namespace {

static_assert(std::endian::native == std::endian::little, "the format is read as it is stored");

constexpr std::size_t header_size = 48;

/// Fills bytes with what begins at an offset.
using ReadAt = std::function<void(std::uint64_t, std::span<std::uint8_t>)>;

struct Header {
    std::array<char, 3> magic;
    std::uint8_t version;
    std::int32_t encoding;
    std::array<std::int32_t, 3> resolution;
    std::int32_t channels;
    std::array<float, 6> bounds;
};
static_assert(sizeof(Header) == header_size);

class VolReader {
public:
    VolReader(ReadAt read_at, std::uint64_t size, const std::string& name)
        : read_at_(std::move(read_at)), size_(size), name_(name) {}

    VolFile read() {
        read_header();
        const VoxelGrid::Encoding encoding = checked_encoding();
        check_layout(VoxelGrid::bytes_per_number(encoding));
        VolFile file;
        try {
            const auto& n = header_.resolution;
            file.grid = VoxelGrid({n[0], n[1], n[2]}, header_.channels, encoding);
        } catch (const std::bad_alloc&) {
            fail_memory();
        }
        read_numbers(file.grid.bytes());
        const auto& b = header_.bounds;
        file.bounds = {.min = {b[0], b[1], b[2]}, .max = {b[3], b[4], b[5]}};
        if (const std::uint64_t rest = size_ - header_size - needed_; rest > 0) {
            file.warnings.push_back(fmt::format("{}: {} bytes after its {} voxels are not read",
                                                name_, rest, layout()));
        }
        return file;
    }

private:
    void read_header() {
        std::array<std::uint8_t, header_size> bytes{};
        read_at_(0, std::span(bytes).first(std::min<std::uint64_t>(size_, header_size)));
        std::memcpy(&header_, bytes.data(), header_size);
        if (std::string_view(header_.magic.data(), 3) != "VOL") {
            fail("this is not a volume of Mitsuba, which begins with \"VOL\"");
        }
        if (size_ < header_size) {
            fail(fmt::format("the file ends within its header, after {} of {} bytes", size_,
                             header_size));
        }
        if (header_.version != 3) {
            fail(fmt::format("version {} of the format cannot be read, only 3", header_.version));
        }
    }

    VoxelGrid::Encoding checked_encoding() const {
        switch (header_.encoding) {
            case 1:
                return VoxelGrid::Encoding::float32;
            case 2:
                return VoxelGrid::Encoding::float16;
            case 3:
                return VoxelGrid::Encoding::uint8;
            default:
                fail(
                    fmt::format("encoding {} cannot be read, only 1 (float32), 2 (float16) and 3 "
                                "(uint8)",
                                header_.encoding));
        }
    }

    /// That the numbers are as many as the file holds. Products of four integers may overflow, so
    /// what is left of the file is divided instead.
    void check_layout(std::uint64_t bytes_each) {
        if (header_.channels != 1 && header_.channels != 3 && header_.channels != 6) {
            fail(fmt::format("it has {} channels; a volume has 1, 3 or 6", header_.channels));
        }
        std::uint64_t possible =
            (size_ - header_size) / bytes_each / static_cast<std::uint64_t>(header_.channels);
        needed_ = bytes_each * static_cast<std::uint64_t>(header_.channels);
        for (const std::int32_t n : header_.resolution) {
            if (n <= 0) {
                fail(
                    fmt::format("a resolution of {} is impossible: each number of voxels must be "
                                "at least 1",
                                layout()));
            }
            possible /= static_cast<std::uint64_t>(n);
            needed_ *= static_cast<std::uint64_t>(n);
        }
        if (possible == 0) {
            fail(
                fmt::format("the file ends too early: {} voxels of {} bytes do not fit into the "
                            "{} bytes after its header",
                            layout(), bytes_each * static_cast<std::uint64_t>(header_.channels),
                            size_ - header_size));
        }
        if (needed_ >= memory_of_machine()) fail_memory();
    }

    void read_numbers(std::span<std::uint8_t> bytes) const {
        constexpr std::size_t part = std::size_t{8} << 20;
        const std::size_t count = (bytes.size() + part - 1) / part;
        const auto read_part = [&](std::size_t i) {
            read_at_(header_size + i * part,
                     bytes.subspan(i * part, std::min(part, bytes.size() - i * part)));
        };
        if (count == 1) return read_part(0);
        Workers().run(static_cast<std::int64_t>(count),
                      [&](std::int64_t i) { read_part(static_cast<std::size_t>(i)); });
    }

    /// "256 × 256 × 128"
    std::string layout() const {
        const auto& n = header_.resolution;
        return fmt::format("{} × {} × {}", n[0], n[1], n[2]);
    }
    [[noreturn]] void fail_memory() const {
        fail(fmt::format("its {} voxels need {} bytes, more than this machine has", layout(),
                         needed_));
    }
    [[noreturn]] void fail(const std::string& message) const {
        throw Error(fmt::format("{}: {}", name_, message));
    }

    ReadAt read_at_;
    std::uint64_t size_;
    const std::string& name_;
    Header header_{};
    std::uint64_t needed_ = 0;  ///< bytes of all numbers
};

}  // namespace

VolFile read_vol(const std::filesystem::path& path) {
    const FileReader file(path);
    const ReadAt read_at = [&](std::uint64_t offset, std::span<std::uint8_t> bytes) {
        file.read(offset, bytes);
    };
    const std::string name = path.filename().string();
    return VolReader(read_at, file.size(), name).read();
}

VolFile read_vol(std::span<const std::uint8_t> bytes, const std::string& name) {
    const ReadAt read_at = [&](std::uint64_t offset, std::span<std::uint8_t> to) {
        if (!to.empty()) std::memcpy(to.data(), bytes.data() + offset, to.size());
    };
    return VolReader(read_at, bytes.size(), name).read();
}

}  // namespace lucerna
