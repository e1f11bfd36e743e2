// SPDX-License-Identifier: Apache-2.0
/// One photon where it met a surface, in 32 bytes.
#pragma once

#include "core/math/select.h"
#include "core/math/vector.h"

namespace lucerna {

/// A unit vector on the octahedron, as two signed integers of `bits` each (Cigolle et al. 2014,
/// "A Survey of Efficient Representations for Independent Unit Vectors"). The axes are exact; the
/// error is below 2^(3 − bits).
inline std::uint32_t encode_direction(Vector3 w, int bits) {
    const float limit = static_cast<float>((1 << (bits - 1)) - 1);
    const float norm = std::abs(w.x) + std::abs(w.y) + std::abs(w.z);
    const Vector2 upper = (1 / norm) * Vector2(w);
    const Vector2 lower(std::copysign(1 - std::abs(upper.y), upper.x),
                        std::copysign(1 - std::abs(upper.x), upper.y));
    const bool below = is_negative(w.z);
    const Vector2 p(select(below, lower.x, upper.x), select(below, lower.y, upper.y));
    const std::uint32_t mask = (std::uint32_t{1} << bits) - 1;
    const auto integer = [&](float x) {  // the nearest; std::lround is a slow call
        const float scaled = x * limit;
        const auto nearest = static_cast<std::int32_t>(scaled + std::copysign(0.5f, scaled));
        return static_cast<std::uint32_t>(nearest) & mask;
    };
    return integer(p.x) | (integer(p.y) << bits);
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

/// Power that arrives at a point from one direction, before the surface has taken any of it.
class Photon {
public:
    Photon() = default;
    /// `w` leads back to where it came from; `n` is the geometric normal on that side; `depth` is
    /// the number of edges of its path, 1 for a photon that comes from the light itself.
    Photon(Vector3 p, Color power, Vector3 w, Vector3 n, int depth)
        : p_(p),
          power_(power),
          direction_(encode_direction(w, 16)),
          normal_(encode_direction(n, 12) |
                  (static_cast<std::uint32_t>(std::min(depth, 255)) << 24)) {}

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
