// SPDX-License-Identifier: Apache-2.0
/// What every volume must satisfy, tried on all that the registry finds, and what grids show.
#include "core/interfaces/volume.h"
#include "core/math/sequences.h"
#include "tests/paths.h"
#include "tests/plugins/workshop.h"
#include "tests/vol_writer.h"

#include <gtest/gtest.h>

#include <map>

namespace lucerna {
namespace {

using Size = std::array<std::int32_t, 3>;

std::string volume(const std::string& type, const std::string& body = "") {
    return fmt::format("<volume type='{}'>{}</volume>", type, body);
}
std::string grid(const std::string& file, const std::string& body = "") {
    return volume("gridvolume", word("filename", file) + body);
}
std::string to_world(const std::string& steps) {
    return "<transform name='to_world'>" + steps + "</transform>";
}
const std::string nearest = word("filter_type", "nearest");
const std::string file_box = "<boolean name='use_grid_bbox' value='true'/>";
const std::string turned = to_world(
    "<scale x='2' y='-0.5' z='3'/><rotate x='1' y='2' z='3' angle='40'/>"
    "<translate x='10' y='-20' z='5'/>");

/// The transform of `turned`.
Transform turn() {
    return Transform::translate({10, -20, 5}) * Transform::rotate({1, 2, 3}, 40) *
           Transform::scale({2, -0.5, 3});
}

double linear(Vector3d p) { return 1 + 2 * p.x + 0.5 * p.y + 3 * p.z; }
double bump(Vector3d p) { return std::exp(-20 * glm::dot(p - 0.5, p - 0.5)); }

class Volumes : public testing::Test {
protected:
    static constexpr Size noise_size{21, 9, 14};

    static void SetUpTestSuite() {
        folder = new TemporaryFolder;
        const auto write = [](const std::string& name, const VolHeader& header,
                              const std::vector<float>& numbers) {
            write_bytes(*folder / name, vol_bytes(header, numbers));
        };
        Rng rng(3);
        std::vector<float> noise(3 * 21 * 9 * 14);
        for (float& v : noise) v = std::pow(rng.next_float(), 8.0f);
        write("noise3.vol", {.resolution = noise_size, .channels = 3}, noise);
        noise.resize(21 * 9 * 14);
        write("noise.vol", {.resolution = noise_size}, noise);
        std::vector<std::uint8_t> bytes(21 * 9 * 14);
        for (auto& b : bytes) b = static_cast<std::uint8_t>(256 * rng.next_float());
        write_bytes(*folder / "bytes.vol",
                    vol_bytes({.resolution = noise_size, .encoding = 3}, bytes));
        const Size n{8, 5, 12};
        write("linear.vol", {.resolution = n}, sampled(n, linear));
        write("bump.vol", {.resolution = {32, 32, 32}}, sampled({32, 32, 32}, bump));
        write("two.vol", {.resolution = {2, 1, 1}, .box = {-1, 2, 3, 3, 4, 4}}, {0, 1});
        write("one.vol", {}, {0.7f});
        write("flat.vol", {.box = {0, 0, 0, 1, 0, 1}}, {1});
        write("negative.vol", {.resolution = {2, 1, 1}}, {0, -1});
    }
    static void TearDownTestSuite() { delete folder; }

    const Volume& make(const std::string& xml) { return workshop_.make<Volume>(xml); }

    /// Every volume with defaults, and some with parameters that are hard.
    std::vector<std::string> all() {
        const std::filesystem::path corpus = tests_folder() / "fuzz" / "corpus";
        const std::map<std::string, std::string> bodies = {
            {"gridvolume", word("filename", "noise.vol")},
            {"openvdb", word("filename", tests_folder() / "vdb" / "fog.vdb")},
            {"nanovdb", word("filename", corpus / "nanovdb_fuzz" / "fog.nvdb")}};
        std::vector<std::string> list;
        for (const std::string& name : workshop_.registry().names("volume")) {
            const auto body = bodies.find(name);
            const std::string parameters = body == bodies.end() ? "" : body->second;
            list.push_back(volume(name, parameters));
            list.push_back(volume(name, parameters + turned));
        }
        for (const char* wrap : {"repeat", "mirror", "clamp"}) {
            const std::string mode = word("wrap_mode", wrap);
            for (const char* file : {"noise3.vol", "bytes.vol", "one.vol", "bump.vol"}) {
                list.push_back(grid(file, mode + turned));
                list.push_back(grid(file, mode + nearest));
            }
        }
        return list;
    }

    static inline TemporaryFolder* folder = nullptr;
    Workshop workshop_{folder->path()};
};

Vector3 point_in(const Bounds3& box, Rng& rng) {
    const Vector3 u(rng.next_float(), rng.next_float(), rng.next_float());
    return glm::clamp(box.min + u * box.extent(), box.min, box.max);
}

TEST_F(Volumes, StayBelowTheMaximumOfAnyBoxTheyAreIn) {
    for (const std::string& xml : all()) {
        SCOPED_TRACE(xml);
        const Volume& v = make(xml);
        Rng rng(2);
        for (int i = 0; i < 300; ++i) {
            Bounds3 box;
            box.include(point_in(v.bounds(), rng));
            // Some boxes are a point, some a plate.
            if (i % 7 != 0) box.include(point_in(v.bounds(), rng));
            if (i % 3 == 0) box.max = glm::min(box.max, box.min + 0.05f * v.bounds().extent());
            if (i % 5 == 0) box.max.y = box.min.y;
            const float bound = v.max(box);
            for (int k = 0; k < 20; ++k) {
                const Vector3 p = k == 0 ? box.min : k == 1 ? box.max : point_in(box, rng);
                EXPECT_LE(max_component(v.color(p)), bound);
                EXPECT_GE(min_component(v.color(p)), 0);
                EXPECT_NEAR(v.real(p), luminance(v.color(p)), 1e-6f * (1 + bound));
            }
        }
        const Bounds3 whole = v.bounds();
        EXPECT_EQ(v.max({.min = Vector3(-infinity), .max = Vector3(infinity)}), v.max(whole));
    }
}

TEST_F(Volumes, BoundsAreReachedWhereABoxHoldsAVoxel) {
    // The largest voxel of a box is a value of the volume at its centre: bounds are not loose.
    const Volume& v = make(grid("noise.vol"));
    const Vector3 n(21, 9, 14);
    Rng rng(4);
    for (int i = 0; i < 200; ++i) {
        const Vector3 voxel(std::floor(21 * rng.next_float()), std::floor(9 * rng.next_float()),
                            std::floor(14 * rng.next_float()));
        const Vector3 centre = (voxel + 0.5f) / n;
        // Within a voxel, its neighbours on all sides count.
        float expected = 0;
        for (int k = 0; k < 27; ++k) {
            const Vector3 shift(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
            expected = std::max(expected, v.real(centre + shift / n));
        }
        // Centres are rounded by up to 2^-24, in rows of 21 voxels that differ by up to 1.
        EXPECT_NEAR(v.max({.min = centre - 0.25f / n, .max = centre + 0.25f / n}), expected,
                    3 * 21 * 0x1p-24);
    }
}

TEST_F(Volumes, TrilinearLookupReproducesLinearFunctionsExactly) {
    const Volume& plain = make(grid("linear.vol"));
    const Volume& moved = make(grid("linear.vol", turned));
    const Transform world_from_cube = turn();
    const Vector3d margin = 0.5 / Vector3d(8, 5, 12);
    Rng rng(5);
    for (int i = 0; i < 1000; ++i) {
        const Vector3d u(rng.next_float(), rng.next_float(), rng.next_float());
        const Vector3d p = margin + u * (1.0 - 2.0 * margin);
        EXPECT_NEAR(static_cast<double>(plain.real(Vector3(p))), linear(p), 1e-5 * linear(p));
        const Vector3 q(world_from_cube.point(p));
        // The point itself is rounded, near (10, -20, 5).
        EXPECT_NEAR(static_cast<double>(moved.real(q)), linear(p), 2e-5);
    }
}

TEST_F(Volumes, InterpolationIsThatOfTheDefinition) {
    // Against the weights (1 − |x|)(1 − |y|)(1 − |z|) of all voxels, in double.
    const Volume& v = make(grid("bump.vol"));
    Rng rng(6);
    double largest_error = 0;
    for (int i = 0; i < 300; ++i) {
        const Vector3 p =
            0.02f + 0.96f * Vector3(rng.next_float(), rng.next_float(), rng.next_float());
        double expected = 0;
        for (int z = 0; z < 32; ++z) {
            for (int y = 0; y < 32; ++y) {
                for (int x = 0; x < 32; ++x) {
                    const Vector3d c = (Vector3d(x, y, z) + 0.5) / 32.0;
                    const Vector3d w = glm::max(1.0 - 32.0 * absolute(Vector3d(p) - c), 0.0);
                    expected += w.x * w.y * w.z * bump(c);
                }
            }
        }
        EXPECT_NEAR(static_cast<double>(v.real(p)), expected, 1e-6);
        largest_error = std::max(largest_error, std::abs(expected - bump(Vector3d(p))));
    }
    // |f'' | ≤ 40 along each axis, so linear interpolation errs by at most 3 · 40 h² / 8.
    EXPECT_LE(largest_error, 3 * 40.0 / (8 * 32 * 32));
}

TEST_F(Volumes, NearestLookupGivesTheVoxelThatHoldsThePoint) {
    const Volume& v = make(grid("linear.vol", nearest));
    Rng rng(7);
    for (int i = 0; i < 1000; ++i) {
        const Vector3 p(rng.next_float(), rng.next_float(), rng.next_float());
        const Vector3d n(8, 5, 12);
        const Vector3d centre = (glm::floor(Vector3d(p) * n) + 0.5) / n;
        EXPECT_EQ(v.real(p), static_cast<float>(linear(centre)));
    }
}

TEST_F(Volumes, WrapModesAreMitsubas) {
    // What Mitsuba 3.9.1 finds at these x in a grid of two voxels, 0 and 1.
    const std::vector<float> at{-0.3f, 0.1f, 0.3f, 0.6f, 0.9f, 1.2f, 1.7f, 2.3f};
    const auto expect = [&](const std::string& mode, const std::string& filter,
                            const std::vector<double>& values) {
        const Volume& v =
            make(grid("two.vol", word("wrap_mode", mode) + word("filter_type", filter)));
        for (std::size_t i = 0; i < at.size(); ++i) {
            EXPECT_NEAR(static_cast<double>(v.real({at[i], 0.25f, 0.25f})), values[i], 1e-6)
                << mode << ' ' << filter << ' ' << at[i];
        }
    };
    expect("clamp", "trilinear", {0, 0, 0.1, 0.7, 1, 1, 1, 1});
    expect("clamp", "nearest", {0, 0, 0, 1, 1, 1, 1, 1});
    expect("repeat", "trilinear", {0.9, 0.3, 0.1, 0.7, 0.7, 0.1, 0.9, 0.1});
    expect("repeat", "nearest", {1, 0, 0, 1, 1, 0, 1, 0});
    expect("mirror", "trilinear", {0.1, 0, 0.1, 0.7, 1, 1, 0.1, 0.1});
    expect("mirror", "nearest", {0, 0, 0, 1, 1, 1, 0, 0});
}

TEST_F(Volumes, AGridLiesInTheUnitCubeOrInTheBoxOfItsFile) {
    const Volume& cube = make(grid("two.vol"));
    EXPECT_EQ(cube.bounds().min, Vector3(0));
    EXPECT_EQ(cube.bounds().max, Vector3(1));
    EXPECT_EQ(cube.resolution(), glm::ivec3(2, 1, 1));
    const Volume& box = make(grid("two.vol", file_box));
    EXPECT_EQ(box.bounds().min, Vector3(-1, 2, 3));
    EXPECT_EQ(box.bounds().max, Vector3(3, 4, 4));
    EXPECT_EQ(box.real({-0.5f, 2.5f, 3.5f}), 0);
    EXPECT_EQ(box.real({2.5f, 2.5f, 3.5f}), 1);
    const Volume& moved = make(grid("two.vol", file_box + to_world("<scale value='2'/>")));
    EXPECT_EQ(moved.bounds().max, Vector3(6, 8, 8));
    const Volume& standing =
        make(grid("linear.vol", to_world("<rotate z='1' angle='90'/><scale value='3'/>")));
    EXPECT_EQ(standing.resolution(), glm::ivec3(5, 8, 12));
}

TEST_F(Volumes, L18_AGridOfOneVoxelIsConstant) {
    const Volume& v = make(grid("one.vol", turned));
    EXPECT_EQ(v.max(v.bounds()), 0.7f);
    Rng rng(8);
    for (int i = 0; i < 100; ++i) EXPECT_EQ(v.real(point_in(v.bounds(), rng)), 0.7f);
}

TEST_F(Volumes, ConstantsAreTheSameEverywhere) {
    const Volume& v = make(
        volume("constvolume", "<rgb name='value' value='1, 2, 3'/>" + to_world("<scale x='4'/>")));
    EXPECT_EQ(v.color({9, -8, 7}), Color(1, 2, 3));
    EXPECT_EQ(v.real({0, 0, 0}), luminance({1, 2, 3}));
    EXPECT_EQ(v.bounds().max, Vector3(4, 1, 1));
    EXPECT_EQ(v.resolution(), glm::ivec3(1));
    EXPECT_EQ(make(volume("constvolume", number("value", 0.3))).real({0, 0, 0}), 0.3f);
    EXPECT_NE(refusal(volume("constvolume", number("value", -1))), "");
}

TEST_F(Volumes, L15_L17_WhatIsWrongIsNamed) {
    const auto said = [](const std::string& xml) { return refusal(xml, folder->path()); };
    EXPECT_NE(said(grid("negative.vol"))
                  .find("negative.vol: voxel (1, 0, 0) is -1; a volume holds finite numbers"),
              std::string::npos);
    EXPECT_EQ(said(grid("flat.vol")), "");
    EXPECT_NE(said(grid("flat.vol", file_box))
                  .find("flat.vol: its box from (0, 0, 0) to (1, 0, 1) is empty or not finite; "
                        "leave \"use_grid_bbox\" out and place the grid with \"to_world\""),
              std::string::npos);
    const std::string projective = to_world("<matrix value='1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1'/>");
    for (const std::string& xml :
         {grid("one.vol", projective), volume("constvolume", projective)}) {
        EXPECT_NE(said(xml).find("\"to_world\" of a volume must be affine"), std::string::npos);
    }
}

TEST_F(Volumes, ParametersWithoutEffectAreReported) {
    make(grid("one.vol", "<boolean name='raw' value='true'/>"));
    EXPECT_NE(
        workshop_.warnings().find("\"raw\" has no effect: the numbers of a volume are linear"),
        std::string::npos);
}

}  // namespace
}  // namespace lucerna
