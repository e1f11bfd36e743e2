// SPDX-License-Identifier: Apache-2.0
/// Places in a list, by keys of 64 bits: a hash table with open addressing.
#pragma once

#include "core/math/sequences.h"

#include <bit>
#include <vector>

namespace lucerna {

class KeyTable {
public:
    static constexpr std::uint32_t none = 0xffffffff;

    KeyTable() = default;
    /// The keys must differ from each other.
    explicit KeyTable(std::vector<std::uint64_t> keys)
        : keys_(std::move(keys)), slots_(std::bit_ceil(2 * keys_.size() + 1), none) {
        for (std::uint32_t i = 0; i < keys_.size(); ++i) slots_[slot_of(keys_[i])] = i;
    }

    /// The place of the key in the list, or `none`.
    std::uint32_t find(std::uint64_t key) const {
        return slots_.empty() ? none : slots_[slot_of(key)];
    }
    std::size_t bytes() const {
        return keys_.capacity() * sizeof(std::uint64_t) + slots_.capacity() * sizeof(std::uint32_t);
    }

private:
    /// Where the key is, or the empty slot where it would be.
    std::size_t slot_of(std::uint64_t key) const {
        std::size_t slot = mix64(key) & (slots_.size() - 1);
        while (slots_[slot] != none && keys_[slots_[slot]] != key) {
            slot = (slot + 1) & (slots_.size() - 1);
        }
        return slot;
    }

    std::vector<std::uint64_t> keys_;
    std::vector<std::uint32_t> slots_;  ///< places in the list, or `none`
};

}  // namespace lucerna
