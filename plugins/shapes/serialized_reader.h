// SPDX-License-Identifier: Apache-2.0
/// Reads meshes of Mitsuba's "serialized" files, versions 3 and 4.
///
/// A file is a row of meshes, each a header of four bytes and a zlib stream, and at the end a table
/// of their offsets; all little-endian (documentation of Mitsuba 3, "serialized"). The only user of
/// zlib.
#pragma once

#include "plugins/shapes/mesh.h"

#include <fmt/format.h>
#include <zlib.h>

#include <bit>
#include <cstring>

namespace lucerna {

static_assert(std::endian::native == std::endian::little, "the format is read as it is stored");

/// A zlib stream, inflated as far as it is asked for.
class InflatingReader {
public:
    InflatingReader(std::span<const std::uint8_t> compressed, const std::string& name)
        : name_(name), compressed_size_(compressed.size()) {
        stream_.next_in = const_cast<Bytef*>(compressed.data());  // zlib does not write to it
        stream_.avail_in = static_cast<uInt>(std::min<std::size_t>(compressed.size(), 0xffffffff));
        if (inflateInit(&stream_) != Z_OK) throw Error("zlib could not be started");
    }
    ~InflatingReader() { inflateEnd(&stream_); }
    InflatingReader(const InflatingReader&) = delete;
    InflatingReader& operator=(const InflatingReader&) = delete;

    void read(void* target, std::size_t bytes) {
        stream_.next_out = static_cast<Bytef*>(target);
        while (bytes > 0) {
            const auto part = static_cast<uInt>(std::min<std::size_t>(bytes, 1U << 30));
            stream_.avail_out = part;
            const int status = inflate(&stream_, Z_NO_FLUSH);
            bytes -= part - stream_.avail_out;
            if (bytes > 0 && (status != Z_OK || stream_.avail_out == part)) fail(status);
        }
        stream_.next_out = nullptr;  // the target may go away
    }
    template <typename T>
    T read() {
        T value;
        read(&value, sizeof(T));
        return value;
    }
    /// Deflate cannot shrink anything by more than a factor of 1032: what promises to become larger
    /// than that is damaged, and must not cost memory (zlib, "Technical Details").
    bool can_hold(std::uint64_t count, std::uint64_t bytes_each) const {
        return count <= 1032 * (static_cast<std::uint64_t>(compressed_size_) + 16) / bytes_each;
    }
    [[noreturn]] void fail(std::string_view message) const {
        throw Error(fmt::format("{}: {}", name_, message));
    }

private:
    [[noreturn]] void fail(int status) const {
        if (status == Z_DATA_ERROR) fail("the compressed data is damaged");
        fail(status == Z_STREAM_END ? "the mesh ends too early: the file is damaged"
                                    : "the file ends too early");
    }

    z_stream stream_{};
    std::string name_;
    std::size_t compressed_size_;
};

class SerializedReader {
public:
    SerializedReader(std::span<const std::uint8_t> file, std::string name,
                     const Transform& world_from_file)
        : file_(file) {
        mesh_.name = std::move(name);
        mesh_.world_from_file = world_from_file;
    }

    /// Mesh number `index`, from 0. Throws Error.
    MeshData read(std::uint32_t index) {
        version_ = read_version(0);
        const std::uint64_t offset = index == 0 ? 0 : find(index);
        if (offset > 0 && read_version(offset) != version_) fail("its meshes differ in version");
        InflatingReader stream(file_.subspan(offset + header_size), mesh_.name);
        read_mesh(stream);
        return std::move(mesh_);
    }

private:
    static constexpr std::size_t header_size = 4;
    enum Flags : std::uint32_t {
        has_normals = 0x1,
        has_uvs = 0x2,
        has_colors = 0x8,
        face_normals = 0x10,
        double_precision = 0x2000
    };

    template <typename T>
    T load(std::uint64_t offset) const {
        T value;
        if (file_.size() < sizeof(T) || offset > file_.size() - sizeof(T)) {
            fail("the file ends too early");
        }
        std::memcpy(&value, file_.data() + offset, sizeof(T));
        return value;
    }

    std::uint16_t read_version(std::uint64_t offset) const {
        if (load<std::uint16_t>(offset) != 0x041c) fail("this is not a serialized mesh of Mitsuba");
        const auto number = load<std::uint16_t>(offset + 2);
        if (number != 3 && number != 4) {
            fail(fmt::format("version {} cannot be read, only 3 and 4", number));
        }
        return number;
    }

    /// Where a mesh starts, from the table at the end of the file.
    std::uint64_t find(std::uint32_t index) const {
        const std::uint64_t count_at = file_.size() - sizeof(std::uint32_t);
        const auto count = load<std::uint32_t>(count_at);
        if (index >= count) {
            fail(fmt::format("\"shape_index\" is {}, but the file holds {} {}, counted from 0",
                             index, count, count == 1 ? "mesh" : "meshes"));
        }
        const std::uint64_t entry = version_ == 4 ? sizeof(std::uint64_t) : sizeof(std::uint32_t);
        if (entry * count > count_at) fail("its table of meshes is damaged");
        const std::uint64_t at = count_at - entry * (count - index);
        const std::uint64_t offset =
            version_ == 4 ? load<std::uint64_t>(at) : load<std::uint32_t>(at);
        if (offset > file_.size() - header_size) fail("its table of meshes is damaged");
        return offset;
    }

    void skip_name(InflatingReader& stream) const {
        for (int length = 0; stream.read<char>() != 0; ++length) {
            if (length == 65536) fail("the name of the mesh has no end");
        }
    }

    void read_mesh(InflatingReader& stream) {
        const auto flags = stream.read<std::uint32_t>();
        if (version_ == 4) skip_name(stream);
        const auto vertices = stream.read<std::uint64_t>();
        const auto triangles = stream.read<std::uint64_t>();
        const bool is_double = (flags & double_precision) != 0;
        if (!stream.can_hold(vertices, is_double ? 24 : 12) || !stream.can_hold(triangles, 12)) {
            fail(fmt::format("{} vertices and {} triangles do not fit into its {} bytes", vertices,
                             triangles, file_.size()));
        }
        if (vertices >= PrimitiveId::none) fail(fmt::format("{} vertices are too many", vertices));
        mesh_.face_normals = (flags & face_normals) != 0;
        mesh_.reserve(vertices, triangles);
        const auto read_all = [&](auto number) {
            using Number = decltype(number);
            using Triple = std::array<Number, 3>;
            read_array<Triple>(stream, vertices, [&](const Triple& p) {
                mesh_.add_position({p[0], p[1], p[2]});
            });
            read_array<Triple>(stream, flags & has_normals ? vertices : 0, [&](const Triple& n) {
                mesh_.add_normal({n[0], n[1], n[2]});
            });
            read_array<std::array<Number, 2>>(
                stream, flags & has_uvs ? vertices : 0,
                [&](const auto& uv) { mesh_.uvs.emplace_back(Vector2d(uv[0], uv[1])); });
            if (!(flags & has_colors)) return;
            MeshAttribute colors{.name = "vertex_color", .values = {}};
            read_array<Triple>(stream, vertices, [&](const Triple& c) {
                for (const Number x : c) colors.values.push_back(static_cast<float>(x));
            });
            mesh_.attributes.push_back(std::move(colors));
        };
        is_double ? read_all(double()) : read_all(float());
        read_array<std::uint32_t>(stream, 3 * triangles,
                                  [&](std::uint32_t index) { mesh_.indices.push_back(index); });
    }

    /// Passes `count` items on, some at a time.
    template <typename Item, typename Take>
    static void read_array(InflatingReader& stream, std::uint64_t count, const Take& take) {
        std::array<Item, 1024> items;
        while (count > 0) {
            const std::uint64_t part = std::min<std::uint64_t>(count, items.size());
            stream.read(items.data(), part * sizeof(Item));
            for (std::uint64_t i = 0; i < part; ++i) take(items[i]);
            count -= part;
        }
    }

    [[noreturn]] void fail(std::string_view message) const {
        throw Error(fmt::format("{}: {}", mesh_.name, message));
    }

    std::span<const std::uint8_t> file_;
    MeshData mesh_;
    std::uint16_t version_ = 0;
};

/// Mesh number `index` of a serialized file. Throws Error.
inline MeshData read_serialized(std::span<const std::uint8_t> file, std::string name,
                                std::uint32_t index, const Transform& world_from_file = {}) {
    return SerializedReader(file, std::move(name), world_from_file).read(index);
}

}  // namespace lucerna
