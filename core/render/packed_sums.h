// SPDX-License-Identifier: Apache-2.0
/// Exact sums in few bytes, for files.
///
/// Sums stand in groups. Those of a group are integers times one power of two, so that each takes
/// as many bits as the largest of them needs: half of what two doubles take, in as little time as
/// copying them. A group with sums that span too many bits is kept as doubles.
#pragma once

#include "core/render/exact_sum.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace lucerna {

/// Sums that lie `stride` apart: a channel of the pixels of a film.
template <typename Sum>
struct SumsOf {
    Sum* first;
    std::size_t count;
    std::size_t stride = 1;

    Sum& operator[](std::size_t i) const { return first[i * stride]; }
    SumsOf part(std::size_t begin, std::size_t most) const {
        return {first + begin * stride, begin + most < count ? most : count - begin, stride};
    }
};

/// Appends the sums to `bytes`.
void pack_sums(SumsOf<const ExactSum> sums, std::string& bytes);

/// Adds terms, one to each sum.
void add_sums(const ExactSum* terms, SumsOf<ExactSum> sums);

/// Takes sums from the front of packed bytes.
class PackedSums {
public:
    explicit PackedSums(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

    /// Adds as many sums as there are in `sums`, one to each. Added to zeros, they have the bits
    /// that they were packed with. Returns false if the bytes are no packed sums.
    [[nodiscard]] bool add_to(SumsOf<ExactSum> sums);
    /// The next `count` sums, which were packed by one call, as packed sums of their own; nothing
    /// if the bytes are no such sums.
    std::optional<PackedSums> take(std::size_t count);
    /// A byte that was appended between sums; nothing at the end.
    std::optional<std::uint8_t> take_byte();
    bool at_end() const { return rest_.empty(); }

private:
    bool add_group(SumsOf<ExactSum> sums);
    std::span<const std::uint8_t> rest_;
};

}  // namespace lucerna
