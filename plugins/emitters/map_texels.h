// SPDX-License-Identifier: Apache-2.0
/// The colours of the picture of an environment map in memory.
#pragma once

#include "core/base/huge_pages.h"
#include "core/math/four_floats.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace lucerna {

/// Colours that are finite and not negative. If numbers of 16 bits hold all of them exactly, as
/// those of most files, they are kept as such, in tiles of 4 × 4 texels: directions are drawn all
/// over the picture, and most of them wait for memory.
class MapTexels {
public:
    MapTexels() = default;
    /// `colors`: rows of `width`, upper row first.
    MapTexels(const std::vector<Color>& colors, int width)
        : tiles_per_row_((static_cast<std::size_t>(width) + side - 1) / side) {
        const std::size_t columns = static_cast<std::size_t>(width);
        const std::size_t rows = colors.size() / columns;
        const std::size_t size = tiles_per_row_ * ((rows + side - 1) / side) * side * side;
        bool fits = true;
        for (const Color& c : colors) fits = fits && is_half(c.x) && is_half(c.y) && is_half(c.z);
        fits ? halves_.resize(size) : floats_.resize(size);
        for (std::size_t y = 0; y < rows; ++y) {
            for (std::size_t x = 0; x < columns; ++x) {
                const Color& c = colors[x + y * columns];
                const std::size_t i = index(static_cast<int>(x), static_cast<int>(y));
                if (fits) {
                    halves_[i] = FourHalves{half_bits(c.x), half_bits(c.y), half_bits(c.z), 0};
                } else {
                    floats_[i] = c;
                }
            }
        }
    }

    /// The last component means nothing.
    FourFloats operator()(int x, int y) const {
        const std::size_t i = index(x, y);
        if (halves_.empty()) return FourFloats{floats_[i].x, floats_[i].y, floats_[i].z, 0};
        return decoded(__builtin_convertvector(halves_[i], FourInts));
    }

private:
    static constexpr std::size_t side = 4;  ///< of a tile

    using FourHalves = std::uint16_t __attribute__((vector_size(8)));
    /// The exponent of a float with the same number is larger by 112.
    static constexpr std::uint32_t exponents = 112u << 10;
    static constexpr float least_normal = 0x1p-14f;
    static constexpr float denormal_step = 0x1p-24f;

    /// Denormal halves are read as what they are beyond the least normal one, since threads that
    /// render take denormal floats as zero.
    static FourFloats decoded(FourInts half) {
        const FourInts bits = (half << 13) + (static_cast<std::int32_t>(exponents) << 13);
        const FourFloats beyond = reinterpret_cast<FourFloats>(bits + (1 << 23)) - least_normal;
        return half < (1 << 10) ? beyond : reinterpret_cast<FourFloats>(bits);
    }
    static std::uint16_t half_bits(float x) {
        if (x < least_normal) return static_cast<std::uint16_t>(x / denormal_step);
        return static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(x) >> 13) - exponents);
    }
    static bool is_half(float x) {
        if (x < least_normal) return std::floor(x / denormal_step) == x / denormal_step;
        return x <= 65504 && (std::bit_cast<std::uint32_t>(x) & 0x1fff) == 0;
    }
    std::size_t index(int x, int y) const {
        const auto column = static_cast<std::size_t>(x), row = static_cast<std::size_t>(y);
        const std::size_t tile = column / side + row / side * tiles_per_row_;
        return tile * side * side + row % side * side + column % side;
    }

    std::size_t tiles_per_row_ = 0;
    std::vector<FourHalves, HugePages<FourHalves>> halves_;
    std::vector<Color, HugePages<Color>> floats_;  ///< if halves are not enough
};

}  // namespace lucerna
