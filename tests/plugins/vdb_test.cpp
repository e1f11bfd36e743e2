// SPDX-License-Identifier: Apache-2.0
/// OpenVDB files, right and wrong: what they show as volumes, and the words in which the rest is
/// refused.
#ifdef LUCERNA_OPENVDB
#include "core/interfaces/volume.h"
#include "core/math/sequences.h"
#include "plugins/volumes/vdb_reader.h"
#include "tests/paths.h"
#include "tests/plugins/workshop.h"
#include "tests/vol_writer.h"

#include <gtest/gtest.h>

#include <random>

namespace lucerna {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;

double linear(Vector3d p) { return 3 + p.x + 2 * p.y - 0.5 * p.z; }

/// A linear function of the indices from (-3, 0, 2) to (12, 9, 11).
FloatGrid::Ptr ramp() {
    openvdb::initialize();
    const FloatGrid::Ptr grid = FloatGrid::create(0);
    auto voxels = grid->getAccessor();
    for (int x = -3; x <= 12; ++x) {
        for (int y = 0; y <= 9; ++y) {
            for (int z = 2; z <= 11; ++z) {
                voxels.setValue({x, y, z}, static_cast<float>(linear({x, y, z})));
            }
        }
    }
    grid->setName("density");
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    return grid;
}

std::string file_of(const openvdb::GridPtrVec& grids, std::uint32_t compression) {
    const TemporaryFolder folder;
    openvdb::io::File file(folder / "a.vdb");
    file.setCompression(compression);
    file.write(grids);
    file.close();
    std::ifstream stream(folder / "a.vdb", std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

constexpr std::uint32_t plain = openvdb::io::COMPRESS_NONE;
constexpr std::uint32_t masked = openvdb::io::COMPRESS_ACTIVE_MASK;
constexpr std::uint32_t zipped = masked | openvdb::io::COMPRESS_ZIP;

std::string error_of(const std::string& bytes, const std::string& grid = "density") {
    try {
        VdbReader(bytes, "a.vdb").read(grid);
        return "";
    } catch (const Error& error) {
        return error.what();
    }
}

class VdbVolume : public testing::Test {
protected:
    std::string volume(const FloatGrid::Ptr& grid, const std::string& body = "") {
        const std::string bytes = file_of({grid}, zipped);
        write_bytes(folder_ / "a.vdb", {bytes.begin(), bytes.end()});
        return "<volume type='openvdb'>" + word("filename", "a.vdb") + body + "</volume>";
    }
    const Volume& make(const FloatGrid::Ptr& grid, const std::string& body = "") {
        return workshop_.make<Volume>(volume(grid, body));
    }
    std::string said(const FloatGrid::Ptr& grid, const std::string& body = "") {
        return refusal(volume(grid, body), folder_.path());
    }

    TemporaryFolder folder_;
    Workshop workshop_{folder_.path()};
};

TEST(VdbFile, grids_are_found_by_their_name_in_any_compression) {
    const FloatGrid::Ptr heat = FloatGrid::create(0);
    heat->setName("heat");
    for (const std::uint32_t compression : {plain, masked, zipped}) {
        const std::string file = file_of({heat, ramp()}, compression);
        const FloatGrid::Ptr grid = VdbReader(file, "a.vdb").read("density");
        EXPECT_EQ(grid->activeVoxelCount(), 16u * 10 * 10);
        EXPECT_EQ(grid->tree().getValue({12, 9, 11}), static_cast<float>(linear({12, 9, 11})));
        EXPECT_EQ(VdbReader(file, "a.vdb").read("heat")->activeVoxelCount(), 0u);
        EXPECT_EQ(error_of(file, "hest"),
                  "a.vdb: there is no grid \"hest\"; did you mean \"heat\"?\n"
                  "  there are: density, heat");
    }
}

TEST(VdbFile, L15_what_is_wrong_is_named) {
    EXPECT_EQ(error_of("VOL"), "a.vdb: the file ends too early, or is damaged");
    EXPECT_EQ(error_of(std::string(100, 'V')),
              "a.vdb: this is not an OpenVDB file, or of a version that the library does not read");
    EXPECT_EQ(error_of("NanoVDB0" + std::string(100, ' ')),
              "a.vdb: this is a NanoVDB file; convert it to OpenVDB with nanovdb_convert");
    const auto vectors = openvdb::Vec3SGrid::create();
    vectors->setName("density");
    EXPECT_EQ(error_of(file_of({vectors}, plain)),
              "a.vdb: grid \"density\" is a Tree_vec3s_5_4_3; only Tree_float_5_4_3 is read");
}

TEST(VdbFile, L15_truncated_files_are_refused) {
    for (const std::uint32_t compression : {plain, masked, zipped}) {
        const std::string file = file_of({ramp()}, compression);
        ASSERT_EQ(error_of(file), "");
        for (std::size_t size = 0; size < file.size(); size += 1 + size / 40) {
            EXPECT_TRUE(error_of(file.substr(0, size)).starts_with("a.vdb: ")) << size;
        }
    }
}

TEST(VdbFile, L15_damaged_files_are_read_or_refused) {
    std::mt19937 random(5);
    for (const std::uint32_t compression : {plain, masked, zipped}) {
        const std::string file = file_of({ramp()}, compression);
        for (int i = 0; i < 200; ++i) {
            std::string mutant = file;
            for (std::size_t k = 0; k < 1 + random() % 8; ++k) {
                // Half of the changes meet the header and the metadata. Lengths stay below 2^24.
                const std::size_t range = random() % 2 ? 900 : mutant.size();
                mutant[random() % range] = static_cast<char>(random() % 2 ? random() : 0);
            }
            const std::string error = error_of(mutant);
            EXPECT_TRUE(error.empty() || error.starts_with("a.vdb: ")) << error;
        }
    }
}

TEST_F(VdbVolume, TransformsOfTheFileAndOfTheSceneAreHonoured) {
    const FloatGrid::Ptr grid = ramp();
    const auto transform = openvdb::math::Transform::createLinearTransform(0.25);
    transform->postRotate(0.4, openvdb::math::Y_AXIS);
    transform->postTranslate({5, 6, 7});
    grid->setTransform(transform);
    const Volume& v = make(grid,
                           "<transform name='to_world'><scale x='2' y='-1' z='3'/>"
                           "</transform>");
    Rng rng(1);
    for (int i = 0; i < 500; ++i) {
        const Vector3d u(rng.next_float(), rng.next_float(), rng.next_float());
        const Vector3d index = Vector3d(-3, 0, 2) + u * Vector3d(15, 9, 9);
        const openvdb::Vec3d p = transform->indexToWorld(openvdb::Vec3d(index.x, index.y, index.z));
        const Vector3 world(static_cast<float>(2 * p.x()), static_cast<float>(-p.y()),
                            static_cast<float>(3 * p.z()));
        // `world` is rounded: numbers near 30, and slopes of up to 2 for 0.25.
        EXPECT_NEAR(static_cast<double>(v.real(world)), linear(index), 1e-4);
        EXPECT_TRUE(v.bounds().contains(world));
    }
}

TEST_F(VdbVolume, EndsWhereInterpolationDoes) {
    const Volume& v = make(ramp());
    EXPECT_EQ(v.bounds().min, Vector3(-4, -1, 1));
    EXPECT_EQ(v.bounds().max, Vector3(13, 10, 12));
    EXPECT_EQ(v.resolution(), glm::ivec3(17, 11, 11));
    EXPECT_EQ(v.real({-4, 0, 2}), 0);
    EXPECT_EQ(v.real({-3.5f, 0, 2}), 0.5f * v.real({-3, 0, 2}));
    const Volume& voxels = make(ramp(), word("filter_type", "nearest"));
    EXPECT_EQ(voxels.bounds().max, Vector3(12.5f, 9.5f, 11.5f));
    EXPECT_EQ(voxels.real({12.4f, 8.6f, 11.4f}), static_cast<float>(linear({12, 9, 11})));
}

TEST_F(VdbVolume, StaysBelowTheMaximumOfAnyBox) {
    const FloatGrid::Ptr grid = ramp();
    auto accessor = grid->getAccessor();
    std::mt19937 random(3);
    for (int i = 0; i < 400; ++i) {
        const auto at = [&] { return static_cast<int>(random() % 60) - 30; };
        accessor.setValue({at(), at(), at()}, static_cast<float>(random() % 100));
    }
    // A tile: one number for 16³ voxels.
    grid->fill(openvdb::CoordBBox(32, 32, 32, 47, 47, 47), 50, true);
    for (const char* filter : {"trilinear", "nearest"}) {
        const Volume& v = make(grid, word("filter_type", filter));
        EXPECT_EQ(v.real({40, 40, 40}), 50);
        Rng rng(2);
        const auto point = [&] {
            const Vector3 u(rng.next_float(), rng.next_float(), rng.next_float());
            return v.bounds().min + u * v.bounds().extent();
        };
        double bounds = 0;
        for (int i = 0; i < 500; ++i) {
            Bounds3 box;
            box.include(point());
            box.include(glm::mix(box.min, point(), i % 2 ? 1.0f : 0.1f));
            bounds += static_cast<double>(v.max(box));
            for (int k = 0; k < 20; ++k) {
                const Vector3 u(rng.next_float(), rng.next_float(), rng.next_float());
                EXPECT_LE(v.real(glm::min(box.min + u * box.extent(), box.max)), v.max(box));
            }
        }
        EXPECT_LT(bounds / 500, 90);  // not the maximum of everything, which is 99
        EXPECT_EQ(v.max({.min = Vector3(-infinity), .max = Vector3(infinity)}), 99);
    }
}

TEST_F(VdbVolume, L17_WhatIsNoDensityIsRefused) {
    const auto with = [](float number) {
        const FloatGrid::Ptr grid = ramp();
        grid->getAccessor().setValue({70, 3, 4}, number);
        return grid;
    };
    const std::string rest = "; a volume holds finite numbers of at least 0";
    const auto expect = [&](const FloatGrid::Ptr& grid, const std::string& message) {
        EXPECT_NE(said(grid).find("a.vdb: grid \"density\" " + message), std::string::npos)
            << said(grid);
    };
    expect(with(-2.5f), "holds -2.5" + rest);
    expect(with(std::numeric_limits<float>::quiet_NaN()), "holds NaN" + rest);
    expect(with(infinity), "holds infinity" + rest);
    const FloatGrid::Ptr empty = FloatGrid::create(0);
    empty->setName("density");
    expect(empty, "has no active voxels");
    const FloatGrid::Ptr distances = ramp();
    distances->setGridClass(openvdb::GRID_LEVEL_SET);
    expect(distances,
           "is a level set, whose numbers are distances; a volume needs a density (a fog volume)");
}

TEST_F(VdbVolume, VoxelsFarApartCostNoMoreThanTheirNodes) {
    const FloatGrid::Ptr grid = ramp();
    for (const int far : {-1'000'000, 1'000'000}) {
        grid->getAccessor().setValue({far, far, far}, 1);
    }
    const Volume& v = make(grid);
    EXPECT_EQ(v.max(v.bounds()), static_cast<float>(linear({12, 9, 2})));
    EXPECT_EQ(v.real({1e6f, 1e6f, 1e6f}), 1);
}

TEST_F(VdbVolume, ABackgroundThatIsNotSeenIsTold) {
    const FloatGrid::Ptr grid = FloatGrid::create(0.5f);
    grid->setName("density");
    grid->getAccessor().setValue({0, 0, 0}, 2);
    make(grid);
    EXPECT_NE(workshop_.warnings().find("a.vdb: the background of grid \"density\" is 0.5; beyond "
                                        "its active voxels it is not seen"),
              std::string::npos);
}

}  // namespace
}  // namespace lucerna
#endif  // LUCERNA_OPENVDB
