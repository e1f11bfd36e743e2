// SPDX-License-Identifier: Apache-2.0
/// What a preview is fed with, and that the render waits for none.
#include "core/render/preview_feed.h"
#include "core/base/error.h"
#include "tests/core/render/films.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace lucerna {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// Keeps what it is shown.
class Recorder final : public Preview {
public:
    void open(const std::string&, const PreviewSubject&) override {}
    bool watched() const override { return is_watched; }
    void show_status(const RenderStatus& status) override {
        if (complains) throw Error("nobody is there");
        seconds = status.seconds;
        ++statuses;
    }
    void show_picture(const PreviewPicture& picture) override {
        last = picture;
        ++pictures;
        while (blocks && !cancelled) std::this_thread::sleep_for(milliseconds(1));
    }
    void finish(const PreviewPicture& picture, const RenderFigures& figures) override {
        last = picture;
        samples = figures.samples;
    }
    void cancel() override { cancelled = true; }

    std::atomic<bool> is_watched{true}, blocks{false}, complains{false}, cancelled{false};
    std::atomic<int> statuses{0}, pictures{0};
    std::atomic<double> seconds{0};
    std::uint64_t samples = 0;
    PreviewPicture last;
};

RenderFigures figures_of(std::uint64_t samples) {
    RenderFigures figures;
    figures.samples = samples;
    return figures;
}

RenderStatus at(double seconds) { return {.seconds = seconds}; }

template <typename Condition>
testing::AssertionResult soon(const Condition& condition) {
    for (int i = 0; i < 2000; ++i) {
        if (condition()) return testing::AssertionSuccess();
        std::this_thread::sleep_for(milliseconds(5));
    }
    return testing::AssertionFailure() << "not within ten seconds";
}

/// A film with one sample in each pixel, of its own.
FilmState film_with_samples(int width, int height) {
    const EmptyScene scene(film_of_size(width, height));
    return scene.render(noisy_estimate, {.budget = {.samples = 1}});
}

std::vector<float> rgb_of(const FilmState& film) {
    std::vector<float> values;
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) values.push_back(static_cast<float>(film.mean(i, c)));
    }
    return values;
}

TEST(PreviewFeed, FinishesWithTheWholePicture) {
    const FilmState film = film_with_samples(40, 30);
    Recorder recorder;
    PreviewFeed feed(recorder, 2);
    feed.finish(film, figures_of(7));
    EXPECT_EQ(recorder.samples, 7u);
    EXPECT_EQ(recorder.last.image.width, 40);
    EXPECT_EQ(recorder.last.full_size, Vector2i(40, 30));
    EXPECT_EQ(recorder.last.image.pixels, rgb_of(film));
    EXPECT_FALSE(feed.take_warning());
}

TEST(PreviewFeed, PicturesAreRare) {
    const FilmState film = film_with_samples(40, 30);
    Recorder recorder;
    PreviewFeed feed(recorder, 1);
    ASSERT_TRUE(soon([&] { return recorder.statuses > 0; }));
    feed.after_pass(at(0.1), film);
    feed.after_pass(at(0.4), film);
    EXPECT_EQ(recorder.pictures, 0);
    // Until the thread has nothing else to do.
    ASSERT_TRUE(soon([&] {
        feed.after_pass(at(60), film);
        return recorder.pictures == 1;
    }));
    for (int i = 0; i < 100; ++i) feed.after_pass(at(60.004 * (1 + 1e-6 * i)), film);
    feed.finish(film, {});
    EXPECT_EQ(recorder.pictures, 1);
}

TEST(PreviewFeed, NothingIsCopiedForNobody) {
    const FilmState film = film_with_samples(8, 8);
    Recorder recorder;
    recorder.is_watched = false;
    PreviewFeed feed(recorder, 1);
    ASSERT_TRUE(soon([&] { return recorder.statuses > 0; }));
    for (int i = 1; i < 10; ++i) feed.after_pass(at(100 * i), film);
    feed.finish(film, figures_of(7));
    EXPECT_EQ(recorder.pictures, 0);
    EXPECT_EQ(recorder.samples, 0u);
}

TEST(PreviewFeed, AViewerThatBlocksIsNotWaitedFor) {
    const FilmState film = film_with_samples(8, 8);
    Recorder recorder;
    recorder.blocks = true;
    const Clock::time_point start = Clock::now();
    {
        PreviewFeed feed(recorder, 1);
        double later = 0;
        ASSERT_TRUE(soon([&] {
            feed.after_pass(at(later += 100), film);
            return recorder.pictures == 1;
        }));
        for (int i = 0; i < 1000; ++i) feed.after_pass(at(later += 100), film);
        EXPECT_EQ(recorder.pictures, 1);
        feed.finish(film, figures_of(7));
        EXPECT_EQ(feed.take_warning(), "the preview did not take the last picture in time");
    }
    EXPECT_LT(Clock::now() - start, std::chrono::seconds(20));
    EXPECT_EQ(recorder.samples, 0u);
}

TEST(PreviewFeed, ComplaintsAreToldOnce) {
    Recorder recorder;
    recorder.complains = true;
    PreviewFeed feed(recorder, 1);
    std::optional<std::string> warning;
    ASSERT_TRUE(soon([&] { return (warning = feed.take_warning()).has_value(); }));
    EXPECT_EQ(warning, "nobody is there");
    std::this_thread::sleep_for(milliseconds(1200));  // it complains twice a second
    EXPECT_FALSE(feed.take_warning());
}

TEST(PreviewFeed, ARenderOnManyThreadsKeepsItsBits) {
    const EmptyScene scene(film_of_size(64, 48));
    const RenderBudget budget = {.samples = 64};
    const FilmState alone = scene.render(noisy_estimate, {.budget = budget, .threads = 4});
    Recorder recorder;
    PreviewFeed feed(recorder, 4);
    double later = 0;  // as if passes took long
    RenderOptions options = {.budget = budget, .threads = 4};
    options.progress = [&](const RenderStatus& status) { feed.update(status); };
    options.after_pass = [&](const RenderStatus&, const FilmState& film) {
        ASSERT_TRUE(soon([&] {
            feed.after_pass(at(later += 1000), film);
            return recorder.pictures > 0;
        }));
    };
    const FilmState seen = scene.render(noisy_estimate, options);
    feed.finish(seen, figures_of(64));
    EXPECT_TRUE(same_bits(seen, alone));
    EXPECT_GE(recorder.pictures, 1);
    EXPECT_EQ(recorder.last.image.pixels, rgb_of(alone));
}

TEST(PreviewFeed, UnknownPreviewsAreRefused) {
    Registry registry;
    try {
        open_preview(registry, "webb", {});
        FAIL();
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("there is no preview \"webb\"; did you mean \"web\"?"),
                  std::string::npos)
            << e.what();
    }
}

}  // namespace
}  // namespace lucerna
