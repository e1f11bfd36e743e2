// SPDX-License-Identifier: Apache-2.0
#include "plugins/volumes/nanovdb_file.h"

#include "plugins/volumes/nanovdb_stream.h"

#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/IO.h>

#include <algorithm>
#include <set>

namespace lucerna {

namespace {

using nanovdb::GridClass;
using nanovdb::GridType;
using Codec = StoredGrid::Codec;

constexpr std::uint64_t header_size = sizeof(nanovdb::io::Header);
constexpr std::uint64_t metadata_size = sizeof(nanovdb::io::MetaData);

/// What a file says about one of its grids.
struct GridEntry {
    std::string name;
    GridType type;
    GridClass grid_class;
    StoredGrid stored;
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
        if (header.codec > static_cast<std::uint16_t>(Codec::blosc)) {
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
            entry.stored.codec = static_cast<Codec>(header.codec);
            std::uint32_t name_size;
            get(entry.stored.size, offsetof(nanovdb::io::MetaData, gridSize));
            get(entry.stored.stored_size, offsetof(nanovdb::io::MetaData, fileSize));
            get(entry.type, offsetof(nanovdb::io::MetaData, gridType));
            get(entry.grid_class, offsetof(nanovdb::io::MetaData, gridClass));
            get(name_size, offsetof(nanovdb::io::MetaData, nameSize));
            offset += metadata_size;
            entry.name = file.text(offset, name_size).c_str();  // up to its zero
            offset += name_size;
            entries.push_back(std::move(entry));
        }
        for (std::size_t i = first; i < entries.size(); ++i) {
            StoredGrid& stored = entries[i].stored;
            file.check(offset, stored.stored_size);
            stored.offset = offset;
            offset += stored.stored_size;
        }
    }
    return entries;
}

void check_size(const VdbBytes& file, const GridEntry& entry) {
    // No file of zlib's becomes larger than by 1032, none of blosc's, as NanoVDB writes it, by 255.
    const auto& [codec, offset, stored_size, size] = entry.stored;
    if (size / (codec == Codec::none ? 1 : 1032) > stored_size) {
        file.fail(fmt::format("grid {}, stored in {} bytes, cannot have {}", quote(entry.name),
                              stored_size, size));
    }
}

/// Follows the nodes of a grid and writes their values into a dense one: level by level, each in
/// the order of the file, which is decoded once if its levels are in order, too.
template <typename Build>
class TreeReader {
public:
    TreeReader(GridStream& stream, std::string what) : stream_(stream), what_(std::move(what)) {}

    VdbGrid read(std::uint64_t memory) {
        const Transform transform = world_from_index(at<nanovdb::GridData>(0).mMap);
        constexpr auto tree_offset = static_cast<std::int64_t>(sizeof(nanovdb::GridData));
        const std::int64_t offset =
            sum(tree_offset, at<nanovdb::TreeData<3>>(tree_offset).mNodeOffset[3]);
        const auto& root = at<Root>(offset);
        const std::int64_t tiles = root.mTableSize;
        const Value background = root.mBackground;
        dense_ = dense_grid({vector(root.mBBox.min()), vector(root.mBBox.max())}, channels,
                            transform, what_, memory);
        end_ = dense_.first + dense_.voxels.resolution();
        if (background != Value(0)) fill({dense_.first, end_ - 1}, background);
        std::set<typename Root::KeyT> keys;
        std::vector<Place> children;
        for (std::int64_t i = 0; i < tiles; ++i) {
            constexpr std::int64_t head = sizeof(Root), size = sizeof(Tile);
            const auto& tile = at<Tile>(sum(offset, head + i * size));
            if (!keys.insert(tile.key).second) fail("two nodes have one place");
            const Vector3i origin = vector(tile.origin());
            if (tile.isChild()) {
                add<Upper>(children, offset, tile.child, origin);
            } else {
                fill(cube<Upper>(origin), tile.value);
            }
        }
        copy<Upper>(std::move(children));
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
    /// Where a node lies: its offset in the grid, its least index.
    struct Place {
        std::int64_t offset;
        Vector3i origin;
    };

    /// The node at an offset, with `more` bytes behind it, which is inside of the grid; valid until
    /// the next call.
    template <typename T>
    const T& at(std::int64_t offset, std::uint64_t more = 0) {
        const auto place = static_cast<std::uint64_t>(offset);
        const std::uint64_t size = stream_.size(), count = sizeof(T) + more;
        if (offset < 0 || place % alignof(T) != 0 || count > size || place > size - count) {
            fail("a node lies outside of it");
        }
        node_.resize((count + sizeof(Block) - 1) / sizeof(Block));
        const std::span<const std::uint8_t> bytes = stream_.read(place, count);
        std::memcpy(node_.data(), bytes.data(), bytes.size());
        return *reinterpret_cast<const T*>(node_.data());
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

    /// A child of the node at `parent`, unless the dense grid holds nothing of it.
    template <typename Node, typename Offset>
    void add(std::vector<Place>& children, std::int64_t parent, Offset child,
             Vector3i origin) const {
        const VoxelBox needed = inside(cube<Node>(origin));
        if (glm::any(glm::greaterThan(needed.min, needed.max))) return;
        children.push_back({sum(parent, child), origin});
    }

    /// The values of nodes of one level and of all below them.
    template <typename Node>
    void copy(std::vector<Place> places) {
        std::ranges::sort(places, {}, &Place::offset);
        if constexpr (Node::LEVEL == 0) {
            for (const Place& place : places) copy_leaf(place);
        } else {
            using Child = typename Node::ChildNodeType;
            std::vector<Place> children;
            for (const Place& place : places) {
                const auto& node = at<typename Node::DataType>(place.offset);
                constexpr int log2 = Node::LOG2DIM, mask = (1 << log2) - 1;
                for (int i = 0; i < 1 << 3 * log2; ++i) {
                    const Vector3i child(i >> 2 * log2, i >> log2 & mask, i & mask);
                    const Vector3i origin = place.origin + width<Child> * child;
                    const auto index = static_cast<std::uint32_t>(i);
                    if (node.isChild(index)) {
                        add<Child>(children, place.offset, node.mTable[index].child, origin);
                    } else {
                        fill(cube<Child>(origin), node.getValue(index));
                    }
                }
            }
            places = {};
            copy<Child>(std::move(children));
        }
    }

    void copy_leaf(const Place& place) {
        using Data = typename Leaf::DataType;
        const Data* leaf = &at<Data>(place.offset);
        if constexpr (std::is_same_v<Build, nanovdb::FpN>) {
            if (leaf->mFlags >> 5 > 4) fail("values have more than 16 bits");
            leaf = &at<Data>(place.offset, std::uint64_t{64} * leaf->bitWidth());
        }
        for_each(inside(cube<Leaf>(place.origin)), [&](Vector3i index) {
            const Vector3i in_leaf = index - place.origin;
            const int i = in_leaf.x << 6 | in_leaf.y << 3 | in_leaf.z;
            set(index, leaf->getValue(static_cast<std::uint32_t>(i)));
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

    struct alignas(32) Block {
        std::array<std::uint8_t, 32> bytes;
    };

    GridStream& stream_;
    std::string what_;         ///< begins messages
    std::vector<Block> node_;  ///< that was read last; NanoVDB aligns nodes to 32 bytes
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
VdbGrid read_tree(const VdbBytes& file, const GridEntry& entry, const std::string& what,
                  std::uint64_t memory) {
    GridStream stream(file, entry.stored);
    try {
        VdbGrid grid = TreeReader<Build>(stream, what).read(memory);
        stream.finish();
        return grid;
    } catch (const Error&) {
        stream.finish();  // what a damaged grid says is no cause
        throw;
    }
}

VdbGrid read_grid(const VdbBytes& file, const std::string& wanted, std::uint64_t memory) {
    const std::vector<GridEntry> entries = read_entries(file);
    std::vector<std::string> names;
    for (const GridEntry& entry : entries) names.push_back(entry.name);
    const GridEntry& entry = entries[choose_grid(names, wanted, file.name())];
    const std::string what = fmt::format("{}: grid {}", file.name(), quote(entry.name));
    check_class(what, name_of(entry.grid_class));
    check_size(file, entry);
    switch (entry.type) {
        case GridType::Float:
            return read_tree<float>(file, entry, what, memory);
        case GridType::Vec3f:
            return read_tree<nanovdb::Vec3f>(file, entry, what, memory);
        case GridType::Fp4:
            return read_tree<nanovdb::Fp4>(file, entry, what, memory);
        case GridType::Fp8:
            return read_tree<nanovdb::Fp8>(file, entry, what, memory);
        case GridType::Fp16:
            return read_tree<nanovdb::Fp16>(file, entry, what, memory);
        case GridType::FpN:
            return read_tree<nanovdb::FpN>(file, entry, what, memory);
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
