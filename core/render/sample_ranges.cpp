// SPDX-License-Identifier: Apache-2.0
#include "core/render/sample_ranges.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>

namespace lucerna {

SampleRange samples_of_part(std::uint64_t samples, std::uint64_t part, std::uint64_t count) {
    // ⌊samples · i / count⌋ without overflow.
    const auto boundary = [&](std::uint64_t i) {
        return samples / count * i + samples % count * i / count;
    };
    return {.begin = boundary(part - 1), .end = boundary(part)};
}

void SampleRanges::add(SampleRange range) {
    if (range.begin >= range.end) return;
    const auto touches = [&](const SampleRange& r) {
        return r.begin <= range.end && range.begin <= r.end;
    };
    for (const SampleRange& r : ranges_) {
        if (!touches(r)) continue;
        range = {.begin = std::min(range.begin, r.begin), .end = std::max(range.end, r.end)};
    }
    std::erase_if(ranges_, touches);
    const auto after = [&](const SampleRange& r) { return r.begin > range.begin; };
    ranges_.insert(std::find_if(ranges_.begin(), ranges_.end(), after), range);
}

void SampleRanges::add(const SampleRanges& ranges) {
    for (const SampleRange& range : ranges.ranges_) add(range);
}

std::optional<SampleRange> SampleRanges::overlap(const SampleRanges& other) const {
    for (const SampleRange& a : ranges_) {
        for (const SampleRange& b : other.ranges_) {
            const SampleRange both = {.begin = std::max(a.begin, b.begin),
                                      .end = std::min(a.end, b.end)};
            if (both.begin < both.end) return both;
        }
    }
    return {};
}

SampleRanges SampleRanges::without(const SampleRanges& other) const {
    SampleRanges result;
    for (const SampleRange& a : ranges_) {
        std::uint64_t begin = a.begin;
        for (const SampleRange& b : other.ranges_) {
            result.add({.begin = begin, .end = std::min(b.begin, a.end)});
            begin = std::max(begin, b.end);
        }
        result.add({.begin = begin, .end = a.end});
    }
    return result;
}

std::uint64_t SampleRanges::size() const {
    std::uint64_t result = 0;
    for (const SampleRange& range : ranges_) result += range.size();
    return result;
}

std::string SampleRanges::text() const {
    std::string text;
    for (const SampleRange& range : ranges_) {
        text += fmt::format("{}{}-{}", text.empty() ? "" : ",", range.begin, range.end - 1);
    }
    return text;
}

std::optional<SampleRanges> SampleRanges::parse(const std::string& text) {
    SampleRanges result;
    const char* at = text.data();
    const char* const end = at + text.size();
    const auto number = [&](std::uint64_t& value) {
        const auto [stop, error] = std::from_chars(at, end, value);
        at = stop;
        return error == std::errc();
    };
    const auto character = [&](char c) { return at != end && *at++ == c; };
    while (at != end) {
        SampleRange range;
        const bool read = (at == text.data() || character(',')) && number(range.begin) &&
                          character('-') && number(range.end);
        if (!read || range.end == std::numeric_limits<std::uint64_t>::max()) return {};
        ++range.end;
        result.add(range);
    }
    if (result.text() != text) return {};
    return result;
}

bool SampleRanges::operator==(const SampleRanges& other) const {
    const auto equal = [](const SampleRange& a, const SampleRange& b) {
        return a.begin == b.begin && a.end == b.end;
    };
    return std::equal(ranges_.begin(), ranges_.end(), other.ranges_.begin(), other.ranges_.end(),
                      equal);
}

}  // namespace lucerna
