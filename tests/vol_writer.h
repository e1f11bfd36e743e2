// SPDX-License-Identifier: Apache-2.0
/// Writes Mitsuba's volume files for tests.
#pragma once

#include "core/math/vector.h"

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <vector>

namespace lucerna {

/// What the header of a volume file says.
struct VolHeader {
    std::array<std::int32_t, 3> resolution{1, 1, 1};
    std::int32_t channels = 1;
    std::int32_t encoding = 1;
    std::array<float, 6> box{0, 0, 0, 1, 1, 1};
    std::uint8_t version = 3;
};

/// A header and numbers of any type behind it, whether they fit together or not.
template <typename T>
std::vector<std::uint8_t> vol_bytes(const VolHeader& header, const std::vector<T>& numbers) {
    std::vector<std::uint8_t> bytes{'V', 'O', 'L', header.version};
    const auto append = [&](const void* data, std::size_t size) {
        const auto* const first = static_cast<const std::uint8_t*>(data);
        bytes.insert(bytes.end(), first, first + size);
    };
    append(&header.encoding, sizeof header.encoding);
    append(header.resolution.data(), sizeof header.resolution);
    append(&header.channels, sizeof header.channels);
    append(header.box.data(), sizeof header.box);
    append(numbers.data(), numbers.size() * sizeof(T));
    return bytes;
}

inline void write_bytes(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
}

/// The floats of a function of the centres of voxels, which lie in the unit cube.
inline std::vector<float> sampled(std::array<std::int32_t, 3> n,
                                  const std::function<double(Vector3d)>& function) {
    std::vector<float> numbers;
    for (int z = 0; z < n[2]; ++z) {
        for (int y = 0; y < n[1]; ++y) {
            for (int x = 0; x < n[0]; ++x) {
                const Vector3d p((x + 0.5) / n[0], (y + 0.5) / n[1], (z + 0.5) / n[2]);
                numbers.push_back(static_cast<float>(function(p)));
            }
        }
    }
    return numbers;
}

}  // namespace lucerna
