// SPDX-License-Identifier: Apache-2.0
#include "plugins/volumes/nanovdb_file.h"

#include "plugins/volumes/vdb_bytes.h"

#include <blosc.h>
#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/IO.h>
#include <zlib.h>

#include <set>

namespace lucerna {

namespace {

using nanovdb::GridClass;
using nanovdb::GridType;
using nanovdb::io::Codec;

constexpr std::uint64_t header_size = sizeof(nanovdb::io::Header);
constexpr std::uint64_t metadata_size = sizeof(nanovdb::io::MetaData);

/// What a file says about one of its grids.
struct GridEntry {
    std::string name;
    GridType type;
    GridClass grid_class;
    Codec codec;
    std::uint64_t offset, stored_size, size;  ///< [bytes]
};

/// The head of a file is that of NanoVDB.h, but for types that cannot be made of any bytes.
struct Header {
    std::array<char, 8> magic;
    std::uint32_t version;
    std::uint16_t grid_count;
    std::uint16_t codec;
};
static_assert(sizeof(Header) == header_size);

/// All grids of a file: segments, each a header, entries, and grids.
std::vector<GridEntry> read_entries(const VdbBytes& file) {
    std::vector<GridEntry> entries;
    for (std::uint64_t offset = 0; offset < file.size() || offset == 0;) {
        const std::uint64_t there = std::min(file.size() - offset, std::uint64_t{8});
        const std::string magic = file.text(offset, there);
        // Newer libraries write a 2 before the same content.
        if (magic != "NanoVDB0" && magic != "NanoVDB2") {
            file.fail("this is not a NanoVDB file, which begins with \"NanoVDB0\" or \"NanoVDB2\"");
        }
        const auto header = file.value<Header>(offset);
        if (const std::uint32_t major = header.version >> 21; major != 32) {
            file.fail(fmt::format("version {} of the format cannot be read, only 32", major));
        }
        if (header.codec > static_cast<std::uint16_t>(Codec::BLOSC)) {
            file.fail(
                fmt::format("compression {} is unknown; there are 0 (none), 1 (zip) and 2 "
                            "(blosc)",
                            header.codec));
        }
        offset += header_size;
        const std::size_t first = entries.size();
        for (int i = 0; i < header.grid_count; ++i) {
            const auto metadata = file.value<std::array<std::uint8_t, metadata_size>>(offset);
            const auto get = [&](auto& value, std::size_t at) {
                std::memcpy(&value, metadata.data() + at, sizeof value);
            };
            GridEntry entry{};
            entry.codec = static_cast<Codec>(header.codec);
            std::uint32_t name_size;
            get(entry.size, offsetof(nanovdb::io::MetaData, gridSize));
            get(entry.stored_size, offsetof(nanovdb::io::MetaData, fileSize));
            get(entry.type, offsetof(nanovdb::io::MetaData, gridType));
            get(entry.grid_class, offsetof(nanovdb::io::MetaData, gridClass));
            get(name_size, offsetof(nanovdb::io::MetaData, nameSize));
            offset += metadata_size;
            entry.name = file.text(offset, name_size).c_str();  // up to its zero
            offset += name_size;
            entries.push_back(std::move(entry));
        }
        for (std::size_t i = first; i < entries.size(); ++i) {
            file.check(offset, entries[i].stored_size);
            entries[i].offset = offset;
            offset += entries[i].stored_size;
        }
    }
    return entries;
}

/// The grid as it lies in memory: NanoVDB aligns nodes to 32 bytes.
class GridMemory {
public:
    explicit GridMemory(std::uint64_t size) : size_(size), blocks_((size + 31) / 32) {}

    std::span<std::uint8_t> bytes() {
        return {reinterpret_cast<std::uint8_t*>(blocks_.data()), size_};
    }
    /// What begins at an offset, with `more` bytes behind it; null if the grid does not hold that.
    template <typename T>
    const T* at(std::int64_t offset, std::uint64_t more = 0) const {
        const auto place = static_cast<std::uint64_t>(offset);
        const bool inside = offset >= 0 && place % alignof(T) == 0 && sizeof(T) <= size_ &&
                            place <= size_ - sizeof(T) && more <= size_ - sizeof(T) - place;
        const auto* const bytes = reinterpret_cast<const std::uint8_t*>(blocks_.data());
        return inside ? reinterpret_cast<const T*>(bytes + place) : nullptr;
    }

private:
    struct alignas(32) Block {
        std::array<std::uint8_t, 32> bytes;
    };
    std::uint64_t size_;
    std::vector<Block> blocks_;
};

void unzip(std::span<const std::uint8_t> from, std::span<std::uint8_t> to, const VdbBytes& file) {
    uLongf size = to.size();
    if (uncompress(to.data(), &size, from.data(), from.size()) != Z_OK || size != to.size()) {
        file.fail("its compressed (zip) grid is damaged");
    }
}

void unblosc(std::span<const std::uint8_t> from, std::span<std::uint8_t> to, const VdbBytes& file) {
    std::size_t size = 0;
    const bool valid =
        blosc_cbuffer_validate(from.data(), from.size(), &size) == 0 && size == to.size() &&
        blosc_decompress_ctx(from.data(), to.data(), to.size(), 1) == static_cast<int>(to.size());
    if (!valid) file.fail("its compressed (blosc) grid is damaged");
}

/// Compressed grids are parts with a size before each: one of zip, of blosc one for each GiB.
void read_compressed(const VdbBytes& file, const GridEntry& entry, std::span<std::uint8_t> to) {
    const bool zip = entry.codec == Codec::ZIP;
    const std::size_t part = zip ? to.size() : std::size_t{nanovdb::io::Internal::MAX_SIZE};
    std::uint64_t offset = entry.offset;
    std::vector<std::uint8_t> stored;
    while (!to.empty()) {
        const auto stored_size = file.value<std::uint64_t>(offset);
        offset += sizeof stored_size;
        file.check(offset, stored_size);
        stored.resize(stored_size);
        file.read(offset, stored);
        offset += stored_size;
        const std::size_t count = std::min(part, to.size());
        (zip ? unzip : unblosc)(stored, to.first(count), file);
        to = to.subspan(count);
    }
}

GridMemory read_memory(const VdbBytes& file, const GridEntry& entry, std::uint64_t memory) {
    // No file of zlib's becomes larger than by 1032, none of blosc's, as NanoVDB writes it, by 255.
    const std::uint64_t factor = entry.codec == Codec::NONE ? 1 : 1032;
    if (entry.size / factor > entry.stored_size) {
        file.fail(fmt::format("grid {}, stored in {} bytes, cannot have {}", quote(entry.name),
                              entry.stored_size, entry.size));
    }
    const std::string too_large = fmt::format("grid {} needs {} bytes, more than this machine has",
                                              quote(entry.name), entry.size);
    if (entry.size >= memory) file.fail(too_large);
    try {
        GridMemory grid(entry.size);
        if (entry.codec == Codec::NONE) {
            file.read(entry.offset, grid.bytes());
        } else {
            read_compressed(file, entry, grid.bytes());
        }
        return grid;
    } catch (const std::bad_alloc&) {
        file.fail(too_large);
    }
}

/// Follows the nodes of a grid and writes their values into a dense one.
template <typename Build>
class TreeReader {
public:
    TreeReader(const GridMemory& memory, std::string what)
        : memory_(memory), what_(std::move(what)) {}

    VdbGrid read(std::uint64_t memory) {
        const auto& grid = *at<nanovdb::GridData>(0);
        constexpr auto tree_offset = static_cast<std::int64_t>(sizeof(nanovdb::GridData));
        const auto& tree = *at<nanovdb::TreeData<3>>(tree_offset);
        const std::int64_t offset = sum(tree_offset, tree.mNodeOffset[3]);
        const auto& root = *at<Root>(offset);
        const std::uint64_t tiles = sizeof(Tile) * std::uint64_t{root.mTableSize};
        at<Root>(offset, tiles);

        dense_ = dense_grid({vector(root.mBBox.min()), vector(root.mBBox.max())}, channels,
                            world_from_index(grid.mMap), what_, memory);
        end_ = dense_.first + dense_.voxels.resolution();
        if (root.mBackground != Value(0)) fill({dense_.first, end_ - 1}, root.mBackground);
        std::set<typename Root::KeyT> keys;
        for (std::uint32_t i = 0; i < root.mTableSize; ++i) {
            const Tile& tile = *root.tile(i);
            if (!keys.insert(tile.key).second) fail("two nodes have one place");
            const Vector3i origin = vector(tile.origin());
            if (tile.isChild()) {
                copy<Upper>(sum(offset, tile.child), origin);
            } else {
                fill(cube<Upper>(origin), tile.value);
            }
        }
        return std::move(dense_);
    }

private:
    using Upper = nanovdb::NanoUpper<Build>;
    using Lower = nanovdb::NanoLower<Build>;
    using Leaf = nanovdb::NanoLeaf<Build>;
    using Root = typename nanovdb::NanoRoot<Build>::DataType;
    using Tile = typename Root::Tile;
    using Value = typename Leaf::ValueType;
    static constexpr int channels = std::is_same_v<Value, float> ? 1 : 3;
    template <typename Node>
    static constexpr int width = static_cast<int>(Node::DIM);

    /// The node at an offset, which is inside of the grid.
    template <typename T>
    const T* at(std::int64_t offset, std::uint64_t more = 0) const {
        const T* const found = memory_.at<T>(offset, more);
        if (!found) fail("a node lies outside of it");
        return found;
    }
    /// Offsets are any numbers: a sum that is no integer is no place either.
    template <typename Offset>
    std::int64_t sum(std::int64_t base, Offset offset) const {
        std::int64_t result;
        if (__builtin_add_overflow(base, offset, &result)) fail("a node lies outside of it");
        return result;
    }
    [[noreturn]] void fail(const char* why) const {
        throw Error(fmt::format("{} is damaged: {}", what_, why));
    }

    static Vector3i vector(const nanovdb::Coord& c) { return {c[0], c[1], c[2]}; }
    Transform world_from_index(const nanovdb::Map& map) const {
        Matrix4d matrix(1.0);
        for (int column = 0; column < 3; ++column) {
            for (int row = 0; row < 3; ++row) {
                matrix[column][row] = map.mMatD[3 * row + column];
            }
            matrix[3][column] = map.mVecD[column];
        }
        return index_transform(matrix, what_);
    }

    template <typename Node>
    static VoxelBox cube(Vector3i origin) {
        return {origin, origin + (width<Node> - 1)};
    }
    /// What the dense grid holds of a box; empty (min > max) if that is nothing.
    VoxelBox inside(const VoxelBox& box) const {
        return {glm::max(box.min, dense_.first), glm::min(box.max, end_ - 1)};
    }

    /// The values of a node and of all below it.
    template <typename Node>
    void copy(std::int64_t offset, Vector3i origin) {
        const VoxelBox needed = inside(cube<Node>(origin));
        if (glm::any(glm::greaterThan(needed.min, needed.max))) return;
        if constexpr (Node::LEVEL == 0) {
            copy_leaf(offset, origin, needed);
        } else {
            using Child = typename Node::ChildNodeType;
            const auto& node = *at<typename Node::DataType>(offset);
            constexpr int log2 = Node::LOG2DIM, mask = (1 << log2) - 1;
            for (int i = 0; i < 1 << 3 * log2; ++i) {
                const Vector3i child(i >> 2 * log2, i >> log2 & mask, i & mask);
                const Vector3i place = origin + width<Child> * child;
                const auto index = static_cast<std::uint32_t>(i);
                if (node.isChild(index)) {
                    copy<Child>(sum(offset, node.mTable[index].child), place);
                } else {
                    fill(cube<Child>(place), node.getValue(index));
                }
            }
        }
    }

    void copy_leaf(std::int64_t offset, Vector3i origin, const VoxelBox& needed) {
        const auto& leaf = *at<typename Leaf::DataType>(offset);
        if constexpr (std::is_same_v<Build, nanovdb::FpN>) {
            if (leaf.mFlags >> 5 > 4) fail("values have more than 16 bits");
            at<typename Leaf::DataType>(offset, std::uint64_t{64} * leaf.bitWidth());
        }
        for_each(needed, [&](Vector3i index) {
            const Vector3i in_leaf = index - origin;
            const int i = in_leaf.x << 6 | in_leaf.y << 3 | in_leaf.z;
            set(index, leaf.getValue(static_cast<std::uint32_t>(i)));
        });
    }
    void fill(const VoxelBox& box, const Value& value) {
        for_each(inside(box), [&](Vector3i index) { set(index, value); });
    }
    template <typename Visit>
    static void for_each(const VoxelBox& box, const Visit& visit) {
        for (int z = box.min.z; z <= box.max.z; ++z) {
            for (int y = box.min.y; y <= box.max.y; ++y) {
                for (int x = box.min.x; x <= box.max.x; ++x) visit({x, y, z});
            }
        }
    }
    void set(Vector3i index, const Value& value) {
        const std::size_t place = dense_.voxels.place(index - dense_.first);
        if constexpr (channels == 1) {
            dense_.voxels.set(place, value);
        } else {
            for (int k = 0; k < 3; ++k) {
                dense_.voxels.set(place + static_cast<std::size_t>(k), value[k]);
            }
        }
    }

    const GridMemory& memory_;
    std::string what_;  ///< begins messages
    VdbGrid dense_;
    Vector3i end_{0};  ///< index after that of the last voxel of the dense grid
};

/// As OpenVDB calls it.
std::string name_of(GridClass grid_class) {
    constexpr std::array names{"unknown",   "level set",    "fog volume",
                               "staggered", "point index",  "point data",
                               "topology",  "voxel volume", "index grid"};
    static_assert(names.size() == static_cast<std::size_t>(GridClass::End));
    return grid_class < GridClass::End ? names[static_cast<std::size_t>(grid_class)] : "?";
}

template <typename Build>
VdbGrid read_tree(const GridMemory& memory, const std::string& what, std::uint64_t bytes) {
    return TreeReader<Build>(memory, what).read(bytes);
}

VdbGrid read_grid(const VdbBytes& file, const std::string& wanted, std::uint64_t memory) {
    const std::vector<GridEntry> entries = read_entries(file);
    std::vector<std::string> names;
    for (const GridEntry& entry : entries) names.push_back(entry.name);
    const GridEntry& entry = entries[choose_grid(names, wanted, file.name())];
    const std::string what = fmt::format("{}: grid {}", file.name(), quote(entry.name));
    check_class(what, name_of(entry.grid_class));
    const GridMemory grid = read_memory(file, entry, memory);
    switch (entry.type) {
        case GridType::Float:
            return read_tree<float>(grid, what, memory);
        case GridType::Vec3f:
            return read_tree<nanovdb::Vec3f>(grid, what, memory);
        case GridType::Fp4:
            return read_tree<nanovdb::Fp4>(grid, what, memory);
        case GridType::Fp8:
            return read_tree<nanovdb::Fp8>(grid, what, memory);
        case GridType::Fp16:
            return read_tree<nanovdb::Fp16>(grid, what, memory);
        case GridType::FpN:
            return read_tree<nanovdb::FpN>(grid, what, memory);
        default:
            throw Error(
                fmt::format("{} has values of type {}; a volume is read from float, Vec3f, "
                            "Float4, Float8, Float16 or FloatN",
                            what, entry.type < GridType::End ? nanovdb::toStr(entry.type) : "?"));
    }
}

}  // namespace

VdbGrid read_nanovdb(const std::filesystem::path& path, const std::string& grid) {
    return read_grid(VdbBytes(path), grid, memory_of_machine());
}

VdbGrid read_nanovdb(std::span<const std::uint8_t> bytes, const std::string& name,
                     const std::string& grid, std::uint64_t memory) {
    return read_grid(VdbBytes(bytes, name), grid, memory);
}

}  // namespace lucerna
