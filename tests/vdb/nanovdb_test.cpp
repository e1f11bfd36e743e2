// SPDX-License-Identifier: Apache-2.0
/// NanoVDB files, right and wrong, against the library's own sampler.
#include "plugins/volumes/nanovdb_file.h"
#include "plugins/volumes/nanovdb_stream.h"
#include "tests/vdb/vdb_volumes.h"

// The library can then write these.
#define NANOVDB_USE_ZIP
#define NANOVDB_USE_BLOSC
#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/IO.h>
#include <nanovdb/util/SampleFromVoxels.h>

namespace lucerna {
namespace {

using nanovdb::Coord;
using nanovdb::GridClass;
using nanovdb::io::Codec;
using Handle = nanovdb::GridHandle<>;

/// From 8 by 12 by 20 voxels on both sides of index 0.
template <typename Build = float>
Handle fog(const std::string& name = "density", GridClass grid_class = GridClass::FogVolume,
           float background = 0) {
    nanovdb::GridBuilder<float, Build> builder(background);
    builder.setGridClass(grid_class);
    builder([](const Coord& c) { return noise_at(c[0], c[1], c[2]); },
            nanovdb::CoordBBox(Coord(-4, 5, -10), Coord(3, 16, 9)));
    return builder.getHandle(0.25, nanovdb::Vec3d(3, -4, 5), name);
}

Bytes bytes(const std::vector<Handle>& grids, Codec codec = Codec::NONE) {
    const TemporaryFolder folder;
    const std::filesystem::path path = folder / "a.nvdb";
    nanovdb::io::writeGrids(path.string(), grids, codec);
    return bytes_of(path);
}
template <typename... Handles>
Bytes file_of(Handles&&... handles) {
    std::vector<Handle> grids;
    (grids.push_back(std::move(handles)), ...);
    return bytes(grids);
}
Bytes compressed(Codec codec) {
    std::vector<Handle> grids;
    grids.push_back(fog());
    return bytes(grids, codec);
}

VdbGrid read(const Bytes& bytes, const std::string& grid = "") {
    // Files that lie may ask for all the memory of the machine.
    return read_nanovdb(bytes, "a", grid, std::uint64_t{1} << 28);
}

template <typename Build>
class NanoVdbValues : public testing::Test {};
using Builds = testing::Types<float, nanovdb::Fp4, nanovdb::Fp8, nanovdb::Fp16, nanovdb::FpN>;
TYPED_TEST_SUITE(NanoVdbValues, Builds);

TYPED_TEST(NanoVdbValues, AreThoseOfTheLibrarysSampler) {
    Handle handle = fog<TypeParam>();
    const auto& grid = *handle.template grid<TypeParam>();
    const TemporaryFolder folder;
    const std::filesystem::path path = folder / "a.nvdb";
    nanovdb::io::writeGrid(path.string(), handle);
    Workshop workshop;
    const auto sampler = nanovdb::createSampler<1>(grid.tree());
    expect_values(
        workshop.make<Volume>(vdb_volume("nanovdb", path)),
        [&](Vector3d p) {
            const auto index = grid.worldToIndex(nanovdb::Vec3d(p.x, p.y, p.z));
            return static_cast<double>(sampler(nanovdb::Vec3d(index)));
        },
        1e-6);
    const auto nearest = nanovdb::createSampler<0>(grid.tree());
    expect_values(
        workshop.make<Volume>(vdb_volume("nanovdb", path, word("filter_type", "nearest"))),
        [&](Vector3d p) {
            const auto index = grid.worldToIndex(nanovdb::Vec3d(p.x, p.y, p.z));
            return static_cast<double>(nearest(nanovdb::Vec3d(index)));
        },
        0);
}

TEST(NanoVdbFile, ColoursHaveThreeChannels) {
    nanovdb::GridBuilder<nanovdb::Vec3f> builder(nanovdb::Vec3f(0));
    builder.getAccessor().setValue(Coord(7, -8, 9), nanovdb::Vec3f(0.1f, 0.2f, 0.3f));
    const VdbGrid grid = read(file_of(builder.getHandle()));
    EXPECT_EQ(grid.voxels.resolution(), Vector3i(3));
    EXPECT_EQ(grid.first, Vector3i(6, -9, 8));
    EXPECT_EQ(grid.voxels.color({1, 1, 1}), Color(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(grid.voxels.color({0, 1, 1}), Color(0));
}

TEST(NanoVdbFile, TilesAndBackgroundAreFilledIn) {
    nanovdb::GridBuilder<float> builder(0.5f);
    builder([](const Coord&) { return 2.0f; }, nanovdb::CoordBBox(Coord(0), Coord(15)));
    Handle handle = builder.getHandle();
    ASSERT_EQ(handle.grid<float>()->tree().nodeCount(0), 0u);
    const VdbGrid grid = read(file_of(handle));
    EXPECT_EQ(grid.voxels.resolution(), Vector3i(18));
    EXPECT_EQ(grid.voxels.real({0, 9, 15}), 0.5f);
    EXPECT_EQ(grid.voxels.real({1, 9, 16}), 2);
    EXPECT_EQ(grid.voxels.real({1, 9, 17}), 0.5f);
}

TEST(NanoVdbFile, CompressionsChangeNothing) {
    const VdbGrid plain = read(file_of(fog()));
    for (const Codec codec : {Codec::ZIP, Codec::BLOSC}) {
        const VdbGrid other = read(compressed(codec));
        EXPECT_TRUE(std::ranges::equal(other.voxels.bytes(), plain.voxels.bytes()));
    }
    Bytes newer = file_of(fog());
    newer[7] = '2';
    EXPECT_TRUE(std::ranges::equal(read(newer).voxels.bytes(), plain.voxels.bytes()));
}

/// Nodes may lie in any order.
TEST(NanoVdbFile, ReadsInAnyOrderAreThoseOfTheGrid) {
    const Bytes plain = file_of(fog());
    const std::size_t size = fog().size(), head = plain.size() - size;
    for (const Codec codec : {Codec::NONE, Codec::ZIP, Codec::BLOSC}) {
        const Bytes file = compressed(codec);
        const VdbBytes bytes(file, "a");
        const StoredGrid grid{static_cast<StoredGrid::Codec>(codec), head, file.size() - head,
                              size};
        GridStream stream(bytes, grid);
        Rng rng(13);
        for (int i = 0; i < 100; ++i) {
            const auto offset =
                static_cast<std::size_t>(rng.next_float() * static_cast<float>(size));
            const auto count =
                static_cast<std::size_t>(rng.next_float() * static_cast<float>(size - offset));
            EXPECT_TRUE(std::ranges::equal(stream.read(offset, count),
                                           std::span(plain).subspan(head + offset, count)))
                << offset << " " << count;
        }
    }
}

TEST(NanoVdbFile, GridsAreFoundByNameInAnySegment) {
    Bytes file = file_of(fog("heat"), fog("density"));
    const Bytes more = file_of(fog("flames"));
    file.insert(file.end(), more.begin(), more.end());
    for (const char* const name : {"", "heat", "density", "flames"}) {
        EXPECT_EQ(refusal_of(read, file, name), "");
    }
    EXPECT_EQ(refusal_of(read, file, "flame"),
              "a: there is no grid \"flame\"; it holds \"heat\", \"density\", \"flames\"; did you "
              "mean \"flames\"?");
    EXPECT_EQ(refusal_of(read, file_of(fog("heat"), fog("flames"))),
              "a: it holds \"heat\", \"flames\"; say which one is meant with \"grid\"");
}

TEST(NanoVdbFile, L23_AGridWithoutActiveVoxelsIsItsBackground) {
    const VdbGrid grid = read(file_of(nanovdb::GridBuilder<float>(0.0f).getHandle()));
    EXPECT_EQ(grid.voxels.resolution(), Vector3i(3));
    EXPECT_EQ(grid.voxels.real({1, 1, 1}), 0);
}

TEST(NanoVdbFile, L22_GridsThatAreNoVolumesAreRefused) {
    EXPECT_EQ(refusal_of(read, file_of(fog("sphere", GridClass::LevelSet))),
              "a: grid \"sphere\" is a level set, of distances to a surface; a volume needs a fog "
              "volume, of densities");
    nanovdb::GridBuilder<nanovdb::Vec3f> velocity(nanovdb::Vec3f(0));
    velocity.setGridClass(GridClass::Staggered);
    EXPECT_EQ(refusal_of(read, file_of(velocity.getHandle(1, nanovdb::Vec3d(0), "v"))),
              "a: grid \"v\" is of the class \"staggered\"; a volume needs a fog volume");
    EXPECT_EQ(refusal_of(read, file_of(nanovdb::GridBuilder<double>(0.0).getHandle())),
              "a: grid \"\" has values of type double; a volume is read from float, Vec3f, Float4, "
              "Float8, Float16 or FloatN");
}

TEST(NanoVdbFile, L16_ABoxThatDoesNotFitIsRefusedBeforeItIsMade) {
    nanovdb::GridBuilder<float> builder(0.0f);
    auto accessor = builder.getAccessor();
    accessor.setValue(Coord(0), 1);
    accessor.setValue(Coord(99999), 1);
    EXPECT_EQ(refusal_of(read, file_of(builder.getHandle())),
              "a: grid \"\": the box of its active voxels, 100000 × 100000 × 100000, takes 4 bytes "
              "for each of them, more than this machine has");
}

TEST(NanoVdbFile, L15_WhatIsNoSuchFileIsNamed) {
    const std::string wanted =
        "a: this is not a NanoVDB file, which begins with \"NanoVDB0\" or \"NanoVDB2\"";
    EXPECT_EQ(refusal_of(read, {}), wanted);
    EXPECT_EQ(refusal_of(read, Bytes(100, 'N')), wanted);
    Bytes file = file_of(fog());
    file[14] = 3;
    EXPECT_EQ(refusal_of(read, file),
              "a: compression 3 is unknown; there are 0 (none), 1 (zip) and 2 (blosc)");
    file = file_of(fog());
    file[11] = 0;
    EXPECT_EQ(refusal_of(read, file), "a: version 0 of the format cannot be read, only 32");
}

TEST(NanoVdbFile, L15_EveryTruncationIsRefused) {
    expect_truncations_are_refused(read, compressed(Codec::ZIP));
    expect_truncations_are_refused(read, compressed(Codec::BLOSC));
}

TEST(NanoVdbFile, L15_FilesThatLieAreReadOrRefused) {
    expect_damage_is_survived(read, file_of(fog<nanovdb::FpN>()));
    expect_damage_is_survived(read, compressed(Codec::ZIP));
    expect_damage_is_survived(read, compressed(Codec::BLOSC));
}

/// Whatever the damaged bytes say, and also in the checksum at the end. A copy of zeros from
/// elsewhere is no damage.
TEST(NanoVdbFile, L15_DamageIsThatOfTheCompression) {
    const Bytes right = compressed(Codec::ZIP);
    const VdbGrid grid = read(right);
    const std::size_t head = file_of(fog()).size() - fog().size() + sizeof(std::uint64_t);
    int refused = 0;
    for (std::size_t at = head; at < right.size(); at += right.size() - 1 - at < 199 ? 1 : 199) {
        Bytes file = right;
        file[at] ^= 0x10;
        try {
            const VdbGrid same = read(file);
            EXPECT_TRUE(std::ranges::equal(same.voxels.bytes(), grid.voxels.bytes())) << at;
        } catch (const Error& error) {
            EXPECT_STREQ(error.what(), "a: its compressed (zip) grid is damaged") << at;
            ++refused;
        }
    }
    EXPECT_GT(refused, 150);
}

/// Offsets of nodes: where TreeData says that the root is.
TEST(NanoVdbFile, L15_NodesOutsideOfTheGridAreRefused) {
    const Bytes right = file_of(fog());
    const std::size_t tree = right.size() - fog().size() + sizeof(nanovdb::GridData);
    for (const std::int64_t offset : {std::int64_t{-1}, std::int64_t{32} << 40,
                                      std::numeric_limits<std::int64_t>::max(), std::int64_t{33}}) {
        Bytes file = right;
        std::memcpy(file.data() + tree + 24, &offset, sizeof offset);
        EXPECT_EQ(refusal_of(read, file),
                  "a: grid \"density\" is damaged: a node lies outside of it");
    }
}

}  // namespace
}  // namespace lucerna
