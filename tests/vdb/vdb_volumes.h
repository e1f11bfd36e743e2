// SPDX-License-Identifier: Apache-2.0
/// What tests of OpenVDB and NanoVDB files share: volumes of them, and damage.
#pragma once

#include "core/interfaces/volume.h"
#include "core/math/sequences.h"
#include "plugins/volumes/vdb_grid.h"
#include "tests/plugins/workshop.h"
#include "tests/vol_writer.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <iterator>

namespace lucerna {

using Bytes = std::vector<std::uint8_t>;
/// One of the two readers.
using ReadVdb = std::function<VdbGrid(const Bytes&, const std::string& grid)>;

inline Bytes bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return Bytes(std::istreambuf_iterator<char>(file), {});
}

/// The message with which bytes are refused; empty if they are not.
inline std::string refusal_of(const ReadVdb& read, const Bytes& bytes,
                              const std::string& grid = "") {
    try {
        read(bytes, grid);
        return "";
    } catch (const Error& error) {
        return error.what();
    }
}

/// A value between 0 and 1 for each index, and 0 for half of them.
inline float noise_at(int x, int y, int z) {
    const auto u = [](int i) { return static_cast<std::uint32_t>(i); };
    const std::uint32_t h = u(x) * 374761393u + u(y) * 668265263u + u(z) * 1274126177u;
    Rng rng(h);
    const float v = rng.next_float();
    return v < 0.5f ? 0 : v;
}

inline std::string vdb_volume(const std::string& type, const std::filesystem::path& file,
                              const std::string& body = "") {
    return fmt::format("<volume type='{}'>{}{}</volume>", type, word("filename", file.string()),
                       body);
}

/// That a volume has the values of `expected` at random points of its bounds.
inline void expect_values(const Volume& volume, const std::function<double(Vector3d)>& expected,
                          double tolerance) {
    Rng rng(11);
    const Bounds3 box = volume.bounds();
    int above_zero = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vector3 u(rng.next_float(), rng.next_float(), rng.next_float());
        const Vector3 p = glm::clamp(box.min + u * box.extent(), box.min, box.max);
        const double value = expected(Vector3d(p));
        EXPECT_NEAR(static_cast<double>(volume.real(p)), value, tolerance)
            << p.x << ' ' << p.y << ' ' << p.z;
        above_zero += value > 0;
    }
    EXPECT_GT(above_zero, 200);
}

/// That each beginning of a file is refused.
inline void expect_truncations_are_refused(const ReadVdb& read, const Bytes& file) {
    EXPECT_EQ(refusal_of(read, file), "");
    // All of the head, and some of the rest.
    for (std::size_t size = 0; size < file.size(); size += size < 600 ? 1 : file.size() / 300 + 1) {
        const Bytes piece(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_TRUE(refusal_of(read, piece).starts_with("a: ")) << size;
    }
}

/// That a file with bytes changed at random is read or refused.
inline void expect_damage_is_survived(const ReadVdb& read, const Bytes& file) {
    Rng rng(5);
    int refused = 0;
    constexpr int rounds = 300;
    for (int i = 0; i < rounds; ++i) {
        Bytes damaged = file;
        // Lengths and places are in the head.
        const std::size_t end = i % 2 ? file.size() : std::min<std::size_t>(file.size(), 1500);
        for (int k = 0; k < 1 + i % 3; ++k) {
            const auto at = static_cast<std::size_t>(rng.next_float() * static_cast<float>(end));
            const auto value = static_cast<std::uint8_t>(256 * rng.next_float());
            damaged[at] = i % 5 ? value : 0xff;
        }
        const std::string message = refusal_of(read, damaged);
        EXPECT_TRUE(message.empty() || message.starts_with("a: ")) << message;
        refused += !message.empty();
    }
    EXPECT_GT(refused, 0);
}

}  // namespace lucerna
