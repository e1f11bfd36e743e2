// SPDX-License-Identifier: Apache-2.0
/// Sets of sample numbers: which samples a part of a render has, and which are missing.
#pragma once

#include "core/render/budget.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lucerna {

/// The samples of part `part` of `count`, 1 … count, of a render with so many samples per pixel.
/// Parts differ by at most one sample.
SampleRange samples_of_part(std::uint64_t samples, std::uint64_t part, std::uint64_t count);

/// Disjoint ranges in ascending order; neighbours that touch are one.
class SampleRanges {
public:
    SampleRanges() = default;
    /// One range; none if it is empty.
    explicit SampleRanges(SampleRange range) { add(range); }

    void add(SampleRange range);
    void add(const SampleRanges& ranges);

    /// The first samples that both sets have.
    std::optional<SampleRange> overlap(const SampleRanges& other) const;
    /// What this set has and the other one lacks.
    SampleRanges without(const SampleRanges& other) const;

    std::uint64_t size() const;
    bool empty() const { return ranges_.empty(); }
    const std::vector<SampleRange>& ranges() const { return ranges_; }

    /// "0-63,128-191", both ends included; empty for no samples.
    std::string text() const;
    /// The set that has this text; nothing for any other text.
    static std::optional<SampleRanges> parse(const std::string& text);

    bool operator==(const SampleRanges& other) const;

private:
    std::vector<SampleRange> ranges_;
};

}  // namespace lucerna
