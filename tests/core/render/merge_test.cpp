// SPDX-License-Identifier: Apache-2.0
/// States of some samples become the state of all, bit for bit.
#include "core/render/merge.h"

#include "core/math/sequences.h"
#include "tests/core/render/films.h"
#include "tests/paths.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace lucerna {
namespace {

const RenderIdentity identity = {.scene_hash = 1, .seed = 2};

class MergeStates : public testing::Test {
protected:
    /// The state of some samples of a scene of noise.
    std::filesystem::path part(const std::string& name, SampleRange range,
                               std::uint64_t rounding = 1) const {
        RenderOptions options;
        options.budget.samples = range.size();
        FilmState film(film_layout(*scene), range.begin);
        film = scene.render(noisy_estimate, options, std::move(film));
        PartRecord record = {.planned = SampleRanges(range), .all_samples = 100, .parts = 1};
        record.begin = static_cast<double>(1000 + range.begin);
        record.end = static_cast<double>(range.end);
        record.roundings = {rounding};
        write_state(folder / name, film, identity, 1.5, record);
        return folder / name;
    }
    std::string refusal(const std::vector<std::filesystem::path>& paths) const {
        try {
            merge_states(paths);
            return "";
        } catch (const Error& e) {
            std::string text = e.what();
            const std::string prefix = folder.path().string() + "/";
            for (std::size_t at; (at = text.find(prefix)) != std::string::npos;) {
                text.erase(at, prefix.size());
            }
            return text;
        }
    }

    EmptyScene scene{film_of_size(40, 35)};
    TemporaryFolder folder;
};

TEST_F(MergeStates, InAnyOrderIsOneRender) {
    RenderOptions options;
    options.budget.samples = 100;
    const FilmState whole = scene.render(noisy_estimate, options);
    const auto a = part("a", {0, 7}), b = part("b", {7, 60}), c = part("c", {60, 61});
    const auto d = part("d", {61, 100});
    for (const auto& paths : {std::vector{a, b, c, d}, std::vector{d, b, c, a}}) {
        const RenderState merged = merge_states(paths);
        EXPECT_TRUE(same_bits(merged.film, whole));
        EXPECT_EQ(merged.film.first_sample(), 0u);
        EXPECT_EQ(merged.part.samples.text(), "0-99");
        EXPECT_EQ(merged.seconds, 6);
        EXPECT_EQ(merged.part.parts, 4);
        EXPECT_EQ(merged.part.begin, 1000);
        EXPECT_EQ(merged.part.end, 100);
        EXPECT_TRUE(absent_samples(merged.part).empty());
    }
}

TEST_F(MergeStates, InStepsIsOneRender) {
    const auto a = part("a", {0, 7}), b = part("b", {7, 60}), c = part("c", {60, 100});
    const RenderState some = merge_states({a, c});
    EXPECT_EQ(some.part.samples.text(), "0-6,60-99");
    EXPECT_EQ(absent_samples(some.part).text(), "7-59");
    write_state(folder / "some", some.film, some.identity, some.seconds, some.part);
    EXPECT_TRUE(same_bits(merge_states({b, folder / "some"}).film, merge_states({a, b, c}).film));
}

TEST_F(MergeStates, TellsOfProcessorsThatRoundDifferently) {
    const auto a = part("a", {0, 7}, 1), b = part("b", {7, 60}, 1), c = part("c", {60, 61}, 2);
    EXPECT_EQ(rounding_warning(merge_states({a, b}).part), "");
    const RenderState all = merge_states({a, b, c});
    EXPECT_EQ(all.part.roundings, (std::set<std::uint64_t>{1, 2}));
    EXPECT_EQ(rounding_warning(all.part),
              "warning: the samples come from 2 kinds of processors, which do not round alike: the "
              "picture is right, but its bits are those of none of them\n");
}

TEST_F(MergeStates, RefusesPixelsWithDifferentSamples) {
    FilmState film(square_layout(4));
    add_sample(film, 0, grey_sample(1));
    write_state(folder / "cut", film, identity, 0);
    EXPECT_EQ(refusal({folder / "cut"}),
              "cut was interrupted in the middle of a pass: not all of its pixels have the same "
              "samples; finish it by running its `lucerna render` once more");
}

TEST_F(MergeStates, RefusesDamagedBands) {
    const auto a = part("a", {0, 50}), b = part("b", {50, 100});
    std::fstream file(b, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(b) * 3 / 4));
    file.put('x');
    file.close();
    EXPECT_EQ(refusal({a, b}),
              "b is damaged: its checksum does not match; get it again, or render it again");
}

}  // namespace
}  // namespace lucerna
