// SPDX-License-Identifier: Apache-2.0
/// Numbers at the centres of the voxels of a regular grid, kept in the encoding of their file.
#pragma once

#include "core/base/huge_pages.h"
#include "core/math/symmetric_matrix.h"
#include "core/math/vector.h"

#include <cstring>
#include <span>
#include <vector>

namespace lucerna {

using Vector3i = glm::ivec3;

/// x changes fastest, then y, then z; the channels of a voxel lie side by side: one number, the
/// three of a colour, or the six of a symmetric matrix, xx, yy, zz, xy, xz, yz.
class VoxelGrid {
public:
    enum class Encoding : std::uint8_t { float32, float16, uint8 };

    VoxelGrid() = default;
    /// Zeros. Resolution and channels are positive. Throws std::bad_alloc.
    VoxelGrid(Vector3i resolution, int channels, Encoding encoding)
        : resolution_(resolution), channels_(channels), encoding_(encoding) {
        const std::size_t numbers = row_stride() * static_cast<std::size_t>(resolution.y) *
                                    static_cast<std::size_t>(resolution.z);
        bytes_.resize(numbers * bytes_per_number(encoding));
    }

    static constexpr std::size_t bytes_per_number(Encoding encoding) {
        return encoding == Encoding::float32 ? 4 : encoding == Encoding::float16 ? 2 : 1;
    }

    Vector3i resolution() const { return resolution_; }
    int channels() const { return channels_; }
    Encoding encoding() const { return encoding_; }
    std::span<std::uint8_t> bytes() { return bytes_; }
    std::span<const std::uint8_t> bytes() const { return bytes_; }

    /// The place of the first channel of a voxel, for `number`.
    std::size_t place(Vector3i voxel) const {
        const std::size_t row =
            static_cast<std::size_t>(voxel.z) * static_cast<std::size_t>(resolution_.y) +
            static_cast<std::size_t>(voxel.y);
        return row * row_stride() +
               static_cast<std::size_t>(voxel.x) * static_cast<std::size_t>(channels_);
    }
    /// Bytes stand for 0 to 1.
    float number(std::size_t place) const {
        switch (encoding_) {
            case Encoding::float32:
                return load<float>(place);
            case Encoding::float16:
                return from_half(load<std::uint16_t>(place));
            case Encoding::uint8:
                break;
        }
        return static_cast<float>(bytes_[place]) / 255;
    }
    /// Changes a number of a grid of float32.
    void set(std::size_t place, float number) {
        std::memcpy(bytes_.data() + place * sizeof number, &number, sizeof number);
    }
    /// One number: the luminance of three channels.
    float real(Vector3i voxel) const {
        return channels_ == 1 ? number(place(voxel)) : luminance(color(voxel));
    }
    /// Equal red, green and blue where there is one channel.
    Color color(Vector3i voxel) const {
        const std::size_t at = place(voxel);
        if (channels_ == 1) return Color(number(at));
        return {number(at), number(at + 1), number(at + 2)};
    }
    bool has_matrices() const { return channels_ == 6; }
    /// That of the voxel whose first number is at a place.
    SymmetricMatrix matrix(std::size_t at) const {
        return {.xx = number(at),
                .yy = number(at + 1),
                .zz = number(at + 2),
                .xy = number(at + 3),
                .xz = number(at + 4),
                .yz = number(at + 5)};
    }
    /// The largest channel, or eigenvalue.
    float largest(Vector3i voxel) const {
        if (has_matrices()) return static_cast<float>(eigenvalues(matrix(place(voxel))).largest);
        const std::size_t at = place(voxel);
        return channels_ == 1 ? number(at) : max_component(color(voxel));
    }

private:
    std::size_t row_stride() const {
        return static_cast<std::size_t>(resolution_.x) * static_cast<std::size_t>(channels_);
    }
    template <typename T>
    T load(std::size_t place) const {
        T value;
        std::memcpy(&value, bytes_.data() + place * sizeof(T), sizeof(T));
        return value;
    }
    /// IEEE 754 binary16, by integers: threads that render take denormal floats as zero.
    static float from_half(std::uint16_t half) {
        const int mantissa = half & 0x3ff, exponent = half >> 10 & 0x1f;
        const float sign = half & 0x8000 ? -1.0f : 1.0f;
        if (exponent == 0) return sign * static_cast<float>(mantissa) * 0x1p-24f;
        if (exponent == 31)
            return mantissa ? std::numeric_limits<float>::quiet_NaN() : sign * infinity;
        const auto bits = static_cast<std::uint32_t>((exponent + 112) << 23 | mantissa << 13);
        float magnitude;
        std::memcpy(&magnitude, &bits, sizeof bits);
        return sign * magnitude;
    }

    Vector3i resolution_{0};
    int channels_ = 1;
    Encoding encoding_ = Encoding::float32;
    std::vector<std::uint8_t, HugePages<std::uint8_t>> bytes_;
};

}  // namespace lucerna
