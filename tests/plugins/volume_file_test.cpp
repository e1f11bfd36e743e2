// SPDX-License-Identifier: Apache-2.0
/// Volume files, right and wrong: what is read, and the words in which the rest is refused.
#include "core/math/sequences.h"
#include "plugins/volumes/block_maxima.h"
#include "plugins/volumes/grid_axis.h"
#include "plugins/volumes/vol_file.h"
#include "tests/paths.h"
#include "tests/vol_writer.h"

#include <gtest/gtest.h>

#include <bit>
#include <random>

namespace lucerna {
namespace {

using Bytes = std::vector<std::uint8_t>;

VolFile read(const Bytes& bytes) { return read_vol(bytes, "a.vol"); }

std::string refusal(const Bytes& bytes) {
    try {
        const VolFile file = read(bytes);
        BlockMaxima(file.grid, "a.vol");
        return "";
    } catch (const Error& error) {
        return error.what();
    }
}

const std::vector<float> six{0, 1, 2, 3, 4, 5};

TEST(VolFile, floats_lie_as_mitsuba_writes_them) {
    const VolFile file =
        read(vol_bytes({.resolution = {3, 2, 1}, .box = {-1, -2, -3, 4, 5, 6}}, six));
    EXPECT_EQ(file.grid.resolution(), Vector3i(3, 2, 1));
    EXPECT_EQ(file.grid.real({1, 0, 0}), 1);
    EXPECT_EQ(file.grid.real({2, 1, 0}), 5);
    EXPECT_EQ(file.grid.color({0, 1, 0}), Color(3));
    EXPECT_EQ(file.bounds.min, Vector3(-1, -2, -3));
    EXPECT_EQ(file.bounds.max, Vector3(4, 5, 6));
    EXPECT_TRUE(file.warnings.empty());
}

TEST(VolFile, three_channels_are_colours_and_their_luminance) {
    const VolFile file = read(vol_bytes({.resolution = {1, 1, 2}, .channels = 3}, six));
    EXPECT_EQ(file.grid.color({0, 0, 1}), Color(3, 4, 5));
    EXPECT_EQ(file.grid.real({0, 0, 1}), luminance({3, 4, 5}));
    EXPECT_EQ(file.grid.largest({0, 0, 1}), 5);
}

TEST(VolFile, bytes_stay_bytes_and_span_zero_to_one) {
    std::vector<std::uint8_t> all(256);
    for (std::size_t i = 0; i < 256; ++i) all[i] = static_cast<std::uint8_t>(i);
    const VolFile file = read(vol_bytes({.resolution = {16, 4, 4}, .encoding = 3}, all));
    EXPECT_EQ(file.grid.bytes().size(), 256u);
    for (std::size_t i = 0; i < 256; ++i) {
        EXPECT_EQ(file.grid.number(i), static_cast<float>(i) / 255);
    }
}

/// The value of binary16 by its definition (IEEE 754), for those that are finite.
double half_value(int half) {
    const int exponent = half >> 10 & 31, mantissa = half & 1023;
    const double magnitude =
        exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
    return half & 0x8000 ? -magnitude : magnitude;
}

TEST(VolFile, halves_stay_halves_and_have_their_values) {
    std::vector<std::uint16_t> all(0x10000);
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint16_t>(i);
    const VolFile file = read(vol_bytes({.resolution = {256, 256, 1}, .encoding = 2}, all));
    EXPECT_EQ(file.grid.bytes().size(), 0x20000u);
    for (int i = 0; i < 0x10000; ++i) {
        const float number = file.grid.number(static_cast<std::size_t>(i));
        if ((i >> 10 & 31) == 31) {
            EXPECT_FALSE(std::isfinite(number)) << i;
            EXPECT_EQ(std::isnan(number), (i & 1023) != 0) << i;
        } else {
            EXPECT_EQ(static_cast<double>(number), half_value(i)) << i;
        }
    }
}

TEST(VolFile, L15_what_is_wrong_is_named) {
    const auto message = [](VolHeader header) { return refusal(vol_bytes(header, six)); };
    EXPECT_EQ(refusal({}), "a.vol: this is not a volume of Mitsuba, which begins with \"VOL\"");
    EXPECT_EQ(refusal(Bytes(100, 'V')),
              "a.vol: this is not a volume of Mitsuba, which begins with \"VOL\"");
    EXPECT_EQ(refusal({'V', 'O', 'L', 3}),
              "a.vol: the file ends within its header, after 4 of 48 bytes");
    EXPECT_EQ(message({.version = 2}), "a.vol: version 2 of the format cannot be read, only 3");
    EXPECT_EQ(message({.encoding = 4}),
              "a.vol: encoding 4 cannot be read, only 1 (float32), 2 (float16) and 3 (uint8)");
    EXPECT_EQ(message({.channels = 2}), "a.vol: it has 2 channels; a volume has 1, 3 or 6");
    EXPECT_EQ(message({.channels = -1}), "a.vol: it has -1 channels; a volume has 1, 3 or 6");
    EXPECT_EQ(message({.resolution = {2, 0, 3}}),
              "a.vol: a resolution of 2 × 0 × 3 is impossible: each number of voxels must be at "
              "least 1");
    EXPECT_EQ(message({.resolution = {-2, -3, 1}}),
              "a.vol: a resolution of -2 × -3 × 1 is impossible: each number of voxels must be at "
              "least 1");
    EXPECT_EQ(message({.resolution = {7, 1, 1}}),
              "a.vol: the file ends too early: 7 × 1 × 1 voxels of 4 bytes do not fit into the 24 "
              "bytes after its header");
    EXPECT_EQ(message({.resolution = {3, 1, 1}, .channels = 3}),
              "a.vol: the file ends too early: 3 × 1 × 1 voxels of 12 bytes do not fit into the "
              "24 bytes after its header");
}

TEST(VolFile, L15_products_that_overflow_are_refused) {
    constexpr std::int32_t max = std::numeric_limits<std::int32_t>::max();
    for (const std::array<std::int32_t, 3> n :
         {std::array{max, max, max}, {1 << 22, 1 << 22, 1 << 20}, {1 << 30, 1 << 30, 4}}) {
        EXPECT_TRUE(refusal(vol_bytes({.resolution = n}, six)).starts_with("a.vol: the file ends"));
    }
}

TEST(VolFile, L15_every_truncation_is_refused) {
    const Bytes file = vol_bytes({.resolution = {3, 2, 1}}, six);
    EXPECT_EQ(refusal(file), "");
    for (std::size_t size = 0; size < file.size(); ++size) {
        const Bytes piece(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_TRUE(refusal(piece).starts_with("a.vol: ")) << size;
    }
}

TEST(VolFile, L15_bytes_after_the_last_number_are_told) {
    const VolFile file = read(vol_bytes({.resolution = {2, 2, 1}}, six));
    ASSERT_EQ(file.warnings.size(), 1u);
    EXPECT_EQ(file.warnings[0], "a.vol: 8 bytes after its 2 × 2 × 1 voxels are not read");
}

TEST(VolFile, L16_a_file_larger_than_the_memory_is_refused) {
    // Its bytes are a hole, which takes no place on the disk.
    const TemporaryFolder folder;
    const std::filesystem::path path = folder / "huge.vol";
    write_bytes(path, vol_bytes({.resolution = {16384, 16384, 4096}}, std::vector<float>()));
    std::filesystem::resize_file(path, 48 + (std::uint64_t{1} << 42));
    try {
        read_vol(path);
        FAIL() << "a machine of 4 TiB?";
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()),
                  "huge.vol: its 16384 × 16384 × 4096 voxels need 4398046511104 bytes, more than "
                  "this machine has");
    }
}

TEST(VolFile, L17_numbers_that_are_no_density_are_named_with_their_voxel) {
    const std::array<std::int32_t, 3> n{9, 3, 17};
    const auto with = [&](std::size_t at, float number) {
        std::vector<float> numbers(9 * 3 * 17, 1.0f);
        numbers[at] = number;
        return refusal(vol_bytes({.resolution = n}, numbers));
    };
    const std::string rest = "; a volume holds finite numbers of at least 0";
    EXPECT_EQ(with(0, -1), "a.vol: voxel (0, 0, 0) is -1" + rest);
    EXPECT_EQ(with(9 * 3 * 16 + 9 * 2 + 8, std::numeric_limits<float>::quiet_NaN()),
              "a.vol: voxel (8, 2, 16) is nan" + rest);
    EXPECT_EQ(with(9 * 3 * 10 + 4, infinity), "a.vol: voxel (4, 0, 10) is inf" + rest);
    EXPECT_EQ(with(7, std::numeric_limits<float>::max()), "");
    // The third of three channels.
    EXPECT_EQ(refusal(vol_bytes({.resolution = {2, 1, 1}, .channels = 3},
                                std::vector<float>{0, 0, 0, 0, 0, -0.5f})),
              "a.vol: voxel (1, 0, 0) is -0.5" + rest);
}

TEST(VolFile, L17_matrices_that_are_not_positive_definite_are_named_with_their_voxel) {
    const auto with = [](const std::vector<float>& second) {
        std::vector<float> numbers{1, 2, 3, -0.5f, 0.5f, 0.1f};
        numbers.insert(numbers.end(), second.begin(), second.end());
        return refusal(vol_bytes({.resolution = {1, 1, 2}, .channels = 6}, numbers));
    };
    EXPECT_EQ(with({1, 1, 1e-5f, 0, 0, 0}), "");
    EXPECT_EQ(with({0, 0, 0, 0, 0, 0}), "");
    const std::string rest =
        " (xx, yy, zz, xy, xz, yz); matrices must be positive definite, or zero";
    EXPECT_EQ(with({1, 1, 1, 2, 0, 0}),
              "a.vol: voxel (0, 0, 1) is the matrix 1, 1, 1, 2, 0, 0" + rest);
    EXPECT_EQ(with({1, 1, 0, 0, 0, 0}),
              "a.vol: voxel (0, 0, 1) is the matrix 1, 1, 0, 0, 0, 0" + rest);
    EXPECT_EQ(with({-1, -1, -1, 0, 0, 0}),
              "a.vol: voxel (0, 0, 1) is the matrix -1, -1, -1, 0, 0, 0" + rest);
    EXPECT_EQ(with({1, 1, 1, std::numeric_limits<float>::quiet_NaN(), 0, 0}),
              "a.vol: voxel (0, 0, 1) is the matrix 1, 1, 1, nan, 0, 0" + rest);
    EXPECT_EQ(with({infinity, 1, 1, 0, 0, 0}),
              "a.vol: voxel (0, 0, 1) is the matrix inf, 1, 1, 0, 0, 0" + rest);
}

TEST(BlockMaxima, are_the_largest_of_any_box) {
    std::mt19937 random(7);
    for (const int channels : {1, 3}) {
        const std::array<std::int32_t, 3> n{19, 8, 21};
        std::vector<float> numbers(static_cast<std::size_t>(19 * 8 * 21 * channels));
        for (float& number : numbers) number = static_cast<float>(random() % 100000);
        const VoxelGrid grid =
            read(vol_bytes({.resolution = n, .channels = channels}, numbers)).grid;
        const BlockMaxima maxima(grid, "a.vol");
        EXPECT_EQ(maxima.largest(), *std::max_element(numbers.begin(), numbers.end()));
        EXPECT_EQ(maxima.smallest(), *std::min_element(numbers.begin(), numbers.end()));
        for (int i = 0; i < 500; ++i) {
            VoxelBox box;
            for (int k = 0; k < 3; ++k) {
                const auto size = static_cast<unsigned>(n[static_cast<std::size_t>(k)]);
                const int a = static_cast<int>(random() % size);
                const int b = static_cast<int>(random() % size);
                box.min[k] = std::min(a, b);
                box.max[k] = std::max(a, b);
            }
            float expected = 0;
            for (int z = box.min.z; z <= box.max.z; ++z) {
                for (int y = box.min.y; y <= box.max.y; ++y) {
                    for (int x = box.min.x; x <= box.max.x; ++x) {
                        expected = std::max(expected, grid.largest({x, y, z}));
                    }
                }
            }
            EXPECT_EQ(maxima.largest(grid, box), expected);
        }
    }
}

TEST(GridAxis, wrapped_ranges_hold_exactly_the_voxels_of_their_numbers) {
    for (const GridWrap wrap : {GridWrap::repeat, GridWrap::mirror, GridWrap::clamp}) {
        for (int n = 1; n <= 6; ++n) {
            for (int lo = -15; lo <= 15; ++lo) {
                for (int hi = lo; hi <= 15; ++hi) {
                    std::vector<bool> expected(static_cast<std::size_t>(n)), found = expected;
                    for (int i = lo; i <= hi; ++i) {
                        expected[static_cast<std::size_t>(wrapped(i, n, wrap))] = true;
                    }
                    for (const VoxelRange range : wrapped(VoxelRange{lo, hi}, n, wrap)) {
                        for (int i = range.first; i <= range.last; ++i) {
                            found[static_cast<std::size_t>(i)] = true;
                        }
                    }
                    EXPECT_EQ(found, expected) << lo << ' ' << hi << " of " << n;
                }
            }
        }
    }
}

TEST(GridAxis, coordinates_beyond_all_bounds_find_a_voxel) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double x : {-1e300, 1e300, nan, 1e9, -1e9}) {
        for (const GridWrap wrap : {GridWrap::repeat, GridWrap::mirror, GridWrap::clamp}) {
            for (const GridFilter filter : {GridFilter::nearest, GridFilter::trilinear}) {
                const Between at = between(x, 7, filter, wrap);
                EXPECT_TRUE(at.first >= 0 && at.first < 7 && at.second >= 0 && at.second < 7);
                EXPECT_TRUE(at.t >= 0 && at.t < 1);
            }
        }
    }
}

}  // namespace
}  // namespace lucerna
