// SPDX-License-Identifier: Apache-2.0
#include "plugins/volumes/openvdb_file.h"

#include "plugins/volumes/forked_process.h"
#include "plugins/volumes/vdb_bytes.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>

#include <istream>
#include <streambuf>

namespace lucerna {

namespace {

/// What a file says about one of its grids.
struct GridEntry {
    std::string name;    ///< for humans; of several grids of one name all but one have a number
    std::string type;    ///< as "Tree_float_5_4_3"
    bool half = false;   ///< whether floats are stored as halves
    std::string parent;  ///< the grid whose tree this one shares; empty: it has one of its own
    std::int64_t offset = 0, blocks = 0,
                 end = 0;  ///< of the grid, of its voxels, of the next entry
};

/// The parts of a file whose lengths OpenVDB would believe: strings, metadata, places of grids.
class HeaderReader {
public:
    explicit HeaderReader(const VdbBytes& file) : file_(file) {}

    std::vector<GridEntry> read_entries() {
        if (file_.size() < 8 || next<std::uint64_t>() != openvdb::OPENVDB_MAGIC) {
            file_.fail("this is not an OpenVDB file, which begins with \" BDV\"");
        }
        const auto version = next<std::uint32_t>();
        if (version < openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION ||
            version > openvdb::OPENVDB_FILE_VERSION) {
            file_.fail(fmt::format("version {} of the format cannot be read, only 222 to {}",
                                   version, openvdb::OPENVDB_FILE_VERSION));
        }
        skip(2 * sizeof(std::uint32_t));  // the version of the library
        if (next<std::uint8_t>() == 0) {
            file_.fail("it was written as a stream, without the places of its grids");
        }
        skip(36);  // an identifier
        skip_metadata();
        std::vector<GridEntry> entries(checked_count(next<std::int32_t>()));
        for (GridEntry& entry : entries) {
            read_entry(entry);
            offset_ = static_cast<std::uint64_t>(entry.end);
        }
        return entries;
    }

    /// That what lies between the place of a grid and its tree is as OpenVDB expects it.
    void check_grid(const GridEntry& entry, const std::string& what) {
        offset_ = static_cast<std::uint64_t>(entry.offset);
        skip(sizeof(std::uint32_t));  // compression
        skip_metadata();
        const std::string map = next_text();
        if (map == "NonlinearFrustumMap") {
            throw Error(what + " lies in a frustum; only affine transforms can be read");
        }
    }

private:
    template <typename T>
    T next() {
        const T value = file_.value<T>(offset_);
        offset_ += sizeof value;
        return value;
    }
    void skip(std::uint64_t count) {
        file_.check(offset_, count);
        offset_ += count;
    }
    std::string next_text() {
        const auto length = next<std::uint32_t>();
        const std::string text = file_.text(offset_, length);
        offset_ += length;
        return text;
    }
    void skip_metadata() {
        const auto count = next<std::uint32_t>();
        for (std::uint32_t i = 0; i < count; ++i) {
            skip(next<std::uint32_t>());  // name
            skip(next<std::uint32_t>());  // type
            skip(next<std::uint32_t>());  // value
        }
    }
    std::size_t checked_count(std::int32_t count) const {
        constexpr int smallest_entry = 3 * 4 + 3 * 8;
        if (count < 0) file_.fail(fmt::format("it says that it holds {} grids", count));
        file_.check(offset_, std::uint64_t{smallest_entry} * static_cast<std::uint64_t>(count));
        return static_cast<std::size_t>(count);
    }
    void read_entry(GridEntry& entry) {
        entry.name = openvdb::io::GridDescriptor::nameAsString(next_text());
        entry.type = next_text();
        constexpr std::string_view suffix = "_HalfFloat";
        entry.half = entry.type.ends_with(suffix);
        if (entry.half) entry.type.resize(entry.type.size() - suffix.size());
        entry.parent = openvdb::io::GridDescriptor::nameAsString(next_text());
        for (std::int64_t* place : {&entry.offset, &entry.blocks, &entry.end}) {
            *place = next<std::int64_t>();
            if (*place < 0) file_.fail("it says that a part of it lies before its begin");
            file_.check(static_cast<std::uint64_t>(*place), 0);
        }
    }

    const VdbBytes& file_;
    std::uint64_t offset_ = 0;
};

/// What OpenVDB reads from. It throws at the end of the file: the library would go on.
class StreamBuffer final : public std::streambuf {
public:
    explicit StreamBuffer(const VdbBytes& file) : file_(file) {}

protected:
    int_type underflow() override {
        const std::uint64_t left = file_.size() - end_;
        if (left == 0) file_.check(end_, 1);
        const std::size_t count = std::min<std::uint64_t>(left, buffer_.size());
        file_.read(end_, {reinterpret_cast<std::uint8_t*>(buffer_.data()), count});
        end_ += count;
        setg(buffer_.data(), buffer_.data(), buffer_.data() + count);
        return traits_type::to_int_type(buffer_.front());
    }
    pos_type seekoff(off_type offset, std::ios_base::seekdir direction,
                     std::ios_base::openmode mode) override {
        std::int64_t base = static_cast<std::int64_t>(end_) - (egptr() - gptr());
        if (direction == std::ios_base::beg) base = 0;
        if (direction == std::ios_base::end) base = static_cast<std::int64_t>(file_.size());
        return seekpos(base + offset, mode);
    }
    pos_type seekpos(pos_type position, std::ios_base::openmode) override {
        const auto offset = static_cast<std::uint64_t>(std::streamoff(position));
        file_.check(offset, 0);
        const std::uint64_t begin = end_ - static_cast<std::uint64_t>(egptr() - eback());
        if (offset >= begin && offset <= end_) {
            setg(eback(), eback() + (offset - begin), egptr());
        } else {
            end_ = offset;
            setg(nullptr, nullptr, nullptr);
        }
        return position;
    }

private:
    const VdbBytes& file_;
    std::vector<char> buffer_ = std::vector<char>(std::size_t{1} << 16);
    std::uint64_t end_ = 0;  ///< offset of what follows the buffer
};

/// OpenVDB's reader of files, but of a stream that throws.
class Reader final : public openvdb::io::Archive {
public:
    explicit Reader(const VdbBytes& file) : buffer_(file), stream_(&buffer_) {
        stream_.exceptions(std::ios_base::badbit | std::ios_base::failbit);
        openvdb::io::setStreamMetadataPtr(stream_, metadata_, /*transfer=*/false);
        readHeader(stream_);
        setFormatVersion(stream_);
        setLibraryVersion(stream_);
        setDataCompression(stream_);
    }

    /// The grid is never destroyed, not even by an exception: trees are freed by TBB.
    template <typename Grid>
    typename Grid::Ptr read(const GridEntry& entry) {
        const auto& grid = *new typename Grid::Ptr(Grid::create());
        openvdb::io::GridDescriptor descriptor(entry.name, entry.type, entry.half);
        descriptor.setInstanceParentName(entry.parent);
        descriptor.setGridPos(entry.offset);
        descriptor.setBlockPos(entry.blocks);
        descriptor.setEndPos(entry.end);
        stream_.seekg(entry.offset);
        readGrid(grid, descriptor, stream_);
        return grid;
    }

private:
    StreamBuffer buffer_;
    std::istream stream_;
    openvdb::SharedPtr<openvdb::io::StreamMetadata> metadata_ =
        openvdb::SharedPtr<openvdb::io::StreamMetadata>(new openvdb::io::StreamMetadata);
};

/// What the process that reads a grid says first. The voxels of the dense grid follow, or so many
/// letters of a message.
struct Answer {
    enum class Kind : std::uint32_t { grid, error, file_error, transient_file_error };

    Kind kind = Kind::grid;
    std::uint32_t letters = 0;
    std::array<std::int32_t, 3> min{}, max{};  ///< of the active voxels; max < min: none are
    Matrix4d world_from_index{1};
};

VoxelBox active_box(const Answer& answer) {
    return {{answer.min[0], answer.min[1], answer.min[2]},
            {answer.max[0], answer.max[1], answer.max[2]}};
}

template <typename T>
std::span<std::uint8_t> bytes_of(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    return {reinterpret_cast<std::uint8_t*>(&value), sizeof value};
}

template <typename Grid>
constexpr int channels_of = std::is_same_v<typename Grid::ValueType, float> ? 1 : 3;

/// The voxels of a dense grid, a few layers at a time: as many as lie in one layer of leaves. No
/// message can follow any more: an exception ends the process.
template <typename Grid>
void send_voxels(const Grid& grid, const VoxelBox& box,
                 const ForkedProcess::Output& output) noexcept {
    using Value = typename Grid::ValueType;
    static_assert(sizeof(Value) == channels_of<Grid> * sizeof(float));
    using Layers = openvdb::tools::Dense<Value, openvdb::tools::LayoutXYZ>;
    constexpr int leaf = Grid::TreeType::LeafNodeType::DIM;
    for (int z = box.min.z; z <= box.max.z;) {
        const int last = std::min(z | (leaf - 1), box.max.z);
        Layers layers(openvdb::CoordBBox({box.min.x, box.min.y, z}, {box.max.x, box.max.y, last}));
        openvdb::tools::copyToDense(grid.constTree(), layers, /*serial=*/true);
        output.write({reinterpret_cast<const std::uint8_t*>(layers.data()),
                      layers.valueCount() * sizeof(Value)});
        z = last + 1;
    }
}

template <typename Grid>
void send_grid(const VdbBytes& file, const GridEntry& entry, const GridEntry* parent,
               const std::string& what, std::uint64_t memory, const ForkedProcess::Output& output) {
    Reader reader(file);
    const auto grid = reader.read<Grid>(entry);
    if (parent) grid->setTree(reader.read<Grid>(*parent)->treePtr());
    check_class(what, openvdb::GridBase::gridClassToString(grid->getGridClass()));
    const openvdb::CoordBBox active = grid->evalActiveVoxelBoundingBox();
    Answer answer;
    for (std::size_t k = 0; k < 3; ++k) {
        answer.min[k] = active.min()[k];
        answer.max[k] = active.max()[k];
    }
    // OpenVDB multiplies rows: its matrix is the transpose, as GLM's columns are.
    const openvdb::Mat4d rows = grid->transform().baseMap()->getAffineMap()->getMat4();
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 4; ++k) answer.world_from_index[i][k] = rows(i, k);
    }
    index_transform(answer.world_from_index, what);
    const VoxelBox box = dense_box(active_box(answer), channels_of<Grid>, what, memory);
    output.write(bytes_of(answer));
    send_voxels(*grid, box, output);
}

void send_error(Answer::Kind kind, const std::string& message,
                const ForkedProcess::Output& output) {
    Answer answer{.kind = kind, .letters = static_cast<std::uint32_t>(message.size())};
    output.write(bytes_of(answer));
    output.write({reinterpret_cast<const std::uint8_t*>(message.data()), message.size()});
}

/// What the other process does: reads a grid, and tells of it or of what is wrong with it.
template <typename Grid>
void answer(const VdbBytes& file, const GridEntry& entry, const GridEntry* parent,
            const std::string& what, std::uint64_t memory, const ForkedProcess::Output& output) {
    using Kind = Answer::Kind;
    try {
        send_grid<Grid>(file, entry, parent, what, memory, output);
    } catch (const TransientFileError& error) {
        send_error(Kind::transient_file_error, error.what(), output);
    } catch (const FileError& error) {
        send_error(Kind::file_error, error.what(), output);
    } catch (const Error& error) {
        send_error(Kind::error, error.what(), output);
    } catch (const std::bad_alloc&) {
        send_error(Kind::error, what + " needs more memory than this machine has, or is damaged",
                   output);
    } catch (const std::exception& error) {
        send_error(Kind::error, fmt::format("{} cannot be read: {}", what, error.what()), output);
    }
}

[[noreturn]] void rethrow(Answer::Kind kind, const std::string& message) {
    if (kind == Answer::Kind::transient_file_error) throw TransientFileError(message);
    if (kind == Answer::Kind::file_error) throw FileError(message);
    throw Error(message);
}

[[noreturn]] void fail(ForkedProcess& process, const std::string& what) {
    if (process.killed()) {
        throw Error(what +
                    " cannot be read: the process that read it was killed; it may need more "
                    "memory than this machine has");
    }
    throw Error(what + " cannot be read: libopenvdb crashed reading it; the file is damaged");
}

/// Damage that the checks of this file do not find can crash the library, in a process of its own.
template <typename Grid>
VdbGrid read(const VdbBytes& file, const GridEntry& entry, const GridEntry* parent,
             const std::string& what, std::uint64_t memory) {
    openvdb::initialize();  // here, where other threads may hold its locks
    ForkedProcess process([&](const ForkedProcess::Output& output) {
        answer<Grid>(file, entry, parent, what, memory, output);
    });
    Answer said;
    if (!process.read(bytes_of(said))) fail(process, what);
    if (said.kind != Answer::Kind::grid) {
        constexpr std::uint32_t longest = 1 << 20;
        std::string message(std::min(said.letters, longest), '\0');
        if (!process.read({reinterpret_cast<std::uint8_t*>(message.data()), message.size()})) {
            fail(process, what);
        }
        rethrow(said.kind, message);
    }
    VdbGrid grid = dense_grid(active_box(said), channels_of<Grid>,
                              index_transform(said.world_from_index, what), what, memory);
    if (!process.read(grid.voxels.bytes())) fail(process, what);
    return grid;
}

VdbGrid read_grid(const VdbBytes& file, const std::string& wanted, std::uint64_t memory) {
    HeaderReader header(file);
    const std::vector<GridEntry> entries = header.read_entries();
    std::vector<std::string> names;
    for (const GridEntry& entry : entries) names.push_back(entry.name);
    const GridEntry& entry = entries[choose_grid(names, wanted, file.name())];
    const std::string what = fmt::format("{}: grid {}", file.name(), quote(entry.name));
    header.check_grid(entry, what);
    const GridEntry* parent = nullptr;
    if (!entry.parent.empty()) {
        parent = &entries[choose_grid(names, entry.parent, file.name())];
        header.check_grid(*parent, what);
        if (parent->type != entry.type || !parent->parent.empty()) {
            throw Error(what + " is damaged: it cannot share the tree that it names");
        }
    }
    if (entry.type == openvdb::FloatGrid::gridType()) {
        return read<openvdb::FloatGrid>(file, entry, parent, what, memory);
    }
    if (entry.type == openvdb::Vec3SGrid::gridType()) {
        return read<openvdb::Vec3SGrid>(file, entry, parent, what, memory);
    }
    throw Error(fmt::format("{} has the type {}; a volume is read from {} or {}", what,
                            quote(entry.type), openvdb::FloatGrid::gridType(),
                            openvdb::Vec3SGrid::gridType()));
}

}  // namespace

VdbGrid read_openvdb(const std::filesystem::path& path, const std::string& grid) {
    return read_grid(VdbBytes(path), grid, memory_of_machine());
}

VdbGrid read_openvdb(std::span<const std::uint8_t> bytes, const std::string& name,
                     const std::string& grid, std::uint64_t memory) {
    return read_grid(VdbBytes(bytes, name), grid, memory);
}

}  // namespace lucerna
