// SPDX-License-Identifier: Apache-2.0
/// The random numbers that decide the paths of photons.
#pragma once

#include "core/math/sequences.h"

#include <array>

namespace lucerna {

/// Sobol' points in eight dimensions, with the direction numbers of Joe and Kuo 2008
/// ("Constructing Sobol Sequences with Better Two-Dimensional Projections", file new-joe-kuo-6).
/// All coordinates are read together, from a table of four bits of the index at a time.
class SobolTable {
public:
    /// Four pairs of coordinates: 32-bit fractions, the first in the upper half of a word.
    using Point = std::array<std::uint64_t, 4>;

    /// A point is the sum of what all indices of a block of 16 have in common and of what only the
    /// last four bits decide.
    static constexpr std::uint32_t block_size = 16;
    static Point block(std::uint32_t index) {
        Point sum{};
        for (std::size_t part = 1; part < parts.size(); ++part) {
            sum = sum_of(sum, parts[part][(index >> (4 * part)) & 15]);
        }
        return sum;
    }
    static const Point& within_block(std::uint32_t index) { return parts[0][index % block_size]; }

    /// Addition without carry.
    static Point sum_of(const Point& a, const Point& b) {
        return {a[0] ^ b[0], a[1] ^ b[1], a[2] ^ b[2], a[3] ^ b[3]};
    }

private:
    static constexpr std::size_t dimensions = 8;
    using Parts = std::array<std::array<Point, 16>, 8>;

    /// A primitive polynomial over GF(2), its inner coefficients as bits, and the first numbers.
    struct Polynomial {
        int degree;
        std::uint32_t coefficients;
        std::array<std::uint32_t, 5> first;
    };
    /// For the dimensions after the first, whose numbers are the powers of ½ alone.
    static constexpr std::array<Polynomial, dimensions - 1> polynomials = {{
        {1, 0, {1}},
        {2, 1, {1, 3}},
        {3, 1, {1, 3, 1}},
        {3, 2, {1, 1, 1}},
        {4, 1, {1, 1, 3, 3}},
        {4, 4, {1, 3, 5, 13}},
        {5, 2, {1, 1, 5, 5, 17}},
    }};

    static constexpr std::array<std::uint32_t, 32> directions(std::size_t dimension) {
        std::array<std::uint32_t, 32> v{};
        for (std::size_t k = 0; k < 32; ++k) v[k] = std::uint32_t{1} << (31 - k);
        if (dimension == 0) return v;
        const auto& [degree, coefficients, first] = polynomials[dimension - 1];
        const auto s = static_cast<std::size_t>(degree);
        for (std::size_t k = 0; k < 32; ++k) {
            if (k < s) {
                v[k] *= first[k];
                continue;
            }
            v[k] = v[k - s] ^ (v[k - s] >> s);
            for (std::size_t j = 1; j < s; ++j) {
                if (coefficients >> (s - 1 - j) & 1) v[k] ^= v[k - j];
            }
        }
        return v;
    }

    static constexpr Parts make_parts() {
        Parts result{};
        for (std::size_t d = 0; d < dimensions; ++d) {
            const std::array<std::uint32_t, 32> v = directions(d);
            for (std::size_t bit = 0; bit < 32; ++bit) {
                for (std::size_t i = 0; i < 16; ++i) {
                    const std::uint64_t placed = std::uint64_t{v[bit]} << (d % 2 == 0 ? 32 : 0);
                    if (i >> (bit % 4) & 1) result[bit / 4][i][d / 2] ^= placed;
                }
            }
        }
        return result;
    }

    static const Parts parts;
};

inline constexpr SobolTable::Parts SobolTable::parts = SobolTable::make_parts();

/// The numbers of one photon.
///
/// A randomly shifted Sobol' point decides where it leaves the light and how it is first scattered
/// (digital shift: Cranley and Patterson 1976 carried to base 2). From then on numbers are
/// independent (SplitMix64: Steele et al. 2014, "Fast Splittable Pseudorandom Number Generators"):
/// by then roulette and geometry have parted neighbours.
class PhotonNumbers {
public:
    PhotonNumbers() = default;
    PhotonNumbers(const SobolTable::Point& point, std::uint64_t state)
        : point_(point), state_(state) {}

    /// The first two dimensions, which are distributed best: a (0, 2)-sequence.
    Vector2 direction() const { return halves(point_[0]); }
    Vector2 position() const { return halves(point_[1]); }

    struct Scattering {
        float lobe, survival;
        Vector2 direction;
    };
    /// For the surface that it meets as the first, second … one. Without a branch: which of them
    /// it is, is random.
    Scattering scattering(bool first) {
        const std::uint64_t more = state_ + step, most = more + step;
        const std::uint64_t independent[] = {mix64(more), mix64(most)};
        state_ = first ? state_ : most;
        const Vector2 u = halves(first ? point_[3] : independent[0]);
        return {u.x, u.y, halves(first ? point_[2] : independent[1])};
    }

    /// For a generator of its own.
    std::uint64_t seed() { return mix64(state_ += step); }

    static constexpr std::uint64_t step = 0x9e3779b97f4a7c15u;  // 2⁶⁴ / golden ratio

private:
    static Vector2 halves(std::uint64_t bits) {
        return {uint_to_float(static_cast<std::uint32_t>(bits >> 32)),
                uint_to_float(static_cast<std::uint32_t>(bits))};
    }

    SobolTable::Point point_{};
    std::uint64_t state_ = 0;
};

/// The photons of one light in one pass, `key` being a hash of both; fastest if their indices grow
/// one by one.
class PhotonSequence {
public:
    explicit PhotonSequence(std::uint64_t key) : key_(key) {}

    PhotonNumbers photon(std::uint64_t index) {
        if (index / SobolTable::block_size != block_) set_block(index);
        const auto& rest = SobolTable::within_block(static_cast<std::uint32_t>(index));
        return {SobolTable::sum_of(common_, rest), hash_combine(key_, index)};
    }

private:
    void set_block(std::uint64_t index) {
        block_ = index / SobolTable::block_size;
        const std::uint64_t shift = mix64(key_ + (index >> 32));
        common_ = SobolTable::block(static_cast<std::uint32_t>(index));
        for (std::size_t i = 0; i < common_.size(); ++i) {
            common_[i] ^= mix64(shift + i * PhotonNumbers::step);
        }
    }

    std::uint64_t key_;
    std::uint64_t block_ = ~std::uint64_t{0};
    SobolTable::Point common_{};  ///< of the block, shifted
};

}  // namespace lucerna
