// SPDX-License-Identifier: Apache-2.0
/// One photon where it met a surface or was scattered by a medium, in 32 bytes.
#pragma once

#include "core/math/four_floats.h"

#include <tuple>

namespace lucerna {

/// Two unit vectors on the octahedron, each as two signed integers of so many bits (Cigolle et al.
/// 2014, "A Survey of Efficient Representations for Independent Unit Vectors"). The axes are exact;
/// the error is below 2^(3 − bits). Both at once, in the four lanes of a register.
inline std::pair<std::uint32_t, std::uint32_t> encode_directions(Vector3 a, int bits_a, Vector3 b,
                                                                 int bits_b) {
    const auto largest = [](int bits) { return static_cast<float>((1 << (bits - 1)) - 1); };
    const auto swapped = [](FourFloats v) { return __builtin_shufflevector(v, v, 1, 0, 3, 2); };
    const FourFloats xy{a.x, a.y, b.x, b.y}, z{a.z, a.z, b.z, b.z};
    const FourFloats norm = absolute(xy) + swapped(absolute(xy)) + absolute(z);
    const FourFloats upper = (1 / norm) * xy;
    const FourFloats lower = copysign(1 - swapped(absolute(upper)), upper);
    const FourInts below = reinterpret_cast<FourInts>(z) >> 31;
    const FourInts folded =
        (reinterpret_cast<FourInts>(lower) & below) | (reinterpret_cast<FourInts>(upper) & ~below);
    const FourFloats limits{largest(bits_a), largest(bits_a), largest(bits_b), largest(bits_b)};
    const FourFloats scaled = reinterpret_cast<FourFloats>(folded) * limits;
    const FourInts nearest =
        __builtin_convertvector(scaled + copysign(FourFloats{} + 0.5f, scaled), FourInts);
    const auto code = [&](int lane, int bits) {
        const std::uint32_t mask = (std::uint32_t{1} << bits) - 1;
        return (static_cast<std::uint32_t>(nearest[lane]) & mask) |
               ((static_cast<std::uint32_t>(nearest[lane + 1]) & mask) << bits);
    };
    return {code(0, bits_a), code(2, bits_b)};
}

inline std::uint32_t encode_direction(Vector3 w, int bits) {
    return encode_directions(w, bits, w, bits).first;
}

inline Vector3 decode_direction(std::uint32_t code, int bits) {
    const float limit = static_cast<float>((1 << (bits - 1)) - 1);
    const auto coordinate = [&](int shift) {  // moves the sign to the top, and back with it
        const auto raised = static_cast<std::int32_t>(code << (32 - bits - shift));
        return static_cast<float>(raised >> (32 - bits)) / limit;
    };
    Vector3 w(coordinate(0), coordinate(bits), 0);
    w.z = 1 - std::abs(w.x) - std::abs(w.y);
    const float fold = std::max(-w.z, 0.0f);
    w.x -= std::copysign(fold, w.x);
    w.y -= std::copysign(fold, w.y);
    return glm::normalize(w);
}

/// Power that arrives at a point of a surface from one direction, before the surface has taken any
/// of it; or that a point of a medium scatters, after the medium has absorbed its share.
class Photon {
public:
    Photon() = default;
    /// `w` leads back to where it came from; `n` is the geometric normal on that side, or any
    /// direction in a medium; `depth` is the number of edges of its path, 1 for a photon that comes
    /// from the light itself.
    Photon(Vector3 p, Color power, Vector3 w, Vector3 n, int depth) : p_(p), power_(power) {
        std::tie(direction_, normal_) = encode_directions(w, 16, n, 12);
        normal_ |= static_cast<std::uint32_t>(std::min(depth, 255)) << 24;
    }

    Vector3 p() const { return p_; }
    Color power() const { return power_; }  ///< [W], to be divided by the photons emitted
    Vector3 direction() const { return decode_direction(direction_, 16); }
    Vector3 normal() const { return decode_direction(normal_ & 0xffffff, 12); }
    int depth() const { return static_cast<int>(normal_ >> 24); }  ///< 255 stands for more, too

private:
    Vector3 p_{0};
    Color power_{0};
    std::uint32_t direction_ = 0;
    std::uint32_t normal_ = 0;  ///< and depth, in the upper 8 bits
};

static_assert(sizeof(Photon) == 32);

}  // namespace lucerna
