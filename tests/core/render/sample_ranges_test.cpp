// SPDX-License-Identifier: Apache-2.0
/// Which samples belong to which part, and which are missing.
#include "core/render/sample_ranges.h"

#include <gtest/gtest.h>

#include <limits>

namespace lucerna {
namespace {

SampleRanges set(const char* text) {
    const std::optional<SampleRanges> ranges = SampleRanges::parse(text);
    EXPECT_TRUE(ranges) << text;
    return ranges.value_or(SampleRanges());
}

TEST(SampleRanges, PartsAreAllSamplesOnce) {
    for (const std::uint64_t samples : {1u, 7u, 64u, 1000u, 4096u, 1u << 30}) {
        for (const std::uint64_t count : {1u, 2u, 3u, 7u, 64u, 1000u}) {
            if (count > samples) continue;
            std::uint64_t next = 0;
            for (std::uint64_t part = 1; part <= count; ++part) {
                const SampleRange range = samples_of_part(samples, part, count);
                EXPECT_EQ(range.begin, next);
                EXPECT_GE(range.size(), samples / count);
                EXPECT_LE(range.size(), (samples + count - 1) / count);
                next = range.end;
            }
            EXPECT_EQ(next, samples);
        }
    }
}

TEST(SampleRanges, JoinWhateverTheOrder) {
    SampleRanges ranges;
    ranges.add({.begin = 10, .end = 20});
    ranges.add({.begin = 0, .end = 5});
    EXPECT_EQ(ranges.text(), "0-4,10-19");
    ranges.add({.begin = 5, .end = 10});
    EXPECT_EQ(ranges.text(), "0-19");
    ranges.add({.begin = 30, .end = 30});
    EXPECT_EQ(ranges.text(), "0-19");
    ranges.add(set("22-23,25-25"));
    EXPECT_EQ(ranges.text(), "0-19,22-23,25-25");
    EXPECT_EQ(ranges.size(), 23u);
    EXPECT_EQ(SampleRanges().text(), "");
}

TEST(SampleRanges, FindWhatIsThereTwiceAndWhatIsMissing) {
    const SampleRanges ranges = set("0-9,20-29");
    EXPECT_FALSE(ranges.overlap(set("10-19,30-99")));
    EXPECT_EQ(SampleRanges(*ranges.overlap(set("15-22"))).text(), "20-22");
    EXPECT_EQ(set("0-39").without(ranges).text(), "10-19,30-39");
    EXPECT_EQ(set("5-24").without(ranges).text(), "10-19");
    EXPECT_TRUE(ranges.without(set("0-99")).empty());
    EXPECT_EQ(ranges.without(SampleRanges()), ranges);
}

TEST(SampleRanges, AreReadAsTheyAreWritten) {
    for (const char* text : {"", "0-0", "0-63,128-191", "7-18446744073709551614"}) {
        EXPECT_EQ(set(text).text(), text);
    }
    for (const char* text : {"5", "5-", "-5", "7-3", "0-3,", ",0-3", "0-3,4-5", "8-9,0-3", "0-3 ",
                             "0-18446744073709551615", "a-b", "0-99999999999999999999"}) {
        EXPECT_FALSE(SampleRanges::parse(text)) << text;
    }
}

}  // namespace
}  // namespace lucerna
