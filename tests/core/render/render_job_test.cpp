// SPDX-License-Identifier: Apache-2.0
/// The image is a function of scene, seed and samples: not of threads, passes or interruptions.
#include "core/render/render_job.h"

#include "core/base/error.h"
#include "tests/core/render/films.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <thread>

namespace lucerna {
namespace {

RenderOptions with_samples(std::uint64_t samples, int threads = 2) {
    return {.budget = {.samples = samples}, .threads = threads};
}

TEST(RenderJob, N8_threads_change_no_bit) {
    for (const char* filter : {"box", "lanczos"}) {
        const EmptyScene scene(film_of_size(50, 37) + "<rfilter type=\"" + filter + "\"/>",
                               "sobol");
        const FilmState one = scene.render(noisy_estimate, with_samples(9, 1));
        EXPECT_EQ(one.complete_samples(), 9u);
        EXPECT_EQ(one.most_samples(), 9u);
        for (const int threads : {2, 3, 8, 64}) {
            EXPECT_TRUE(same_bits(one, scene.render(noisy_estimate, with_samples(9, threads))))
                << threads << " threads, filter " << filter;
        }
    }
}

TEST(RenderJob, N10_resuming_changes_no_bit) {
    const EmptyScene scene(film_of_size(20, 20));
    const FilmState whole = scene.render(noisy_estimate, with_samples(64));
    const FilmState part = scene.render(noisy_estimate, with_samples(15));
    EXPECT_TRUE(same_bits(whole, scene.render(noisy_estimate, with_samples(64), part)));
    EXPECT_FALSE(same_bits(whole, part));
}

TEST(RenderJob, N10_merging_shards_changes_no_bit) {
    const EmptyScene scene(film_of_size(20, 20));
    const FilmState whole = scene.render(noisy_estimate, with_samples(64));
    FilmState merged = scene.render(noisy_estimate, with_samples(13));
    for (const auto& [first, count] : {std::pair{13, 30}, std::pair{43, 21}}) {
        merged.merge(scene.render(noisy_estimate, with_samples(static_cast<unsigned>(count)),
                                  FilmState(film_layout(*scene), static_cast<unsigned>(first))));
    }
    EXPECT_TRUE(same_bits(whole, merged));
}

TEST(RenderJob, N10_interruption_inside_a_pass_changes_no_bit) {
    const EmptyScene scene(film_of_size(64, 64));
    const FilmState whole = scene.render(noisy_estimate, with_samples(32));
    std::atomic<int> left = 37000;
    RenderOptions options = with_samples(32);
    options.interrupted = [&] { return left < 0; };
    FilmState cut = scene.render(
        [&](const Ray& ray, SampleStream& stream, PixelSample& result) {
            --left;
            noisy_estimate(ray, stream, result);
        },
        options);
    EXPECT_LT(cut.complete_samples(), cut.most_samples());
    EXPECT_TRUE(cut.error());
    EXPECT_TRUE(same_bits(whole, scene.render(noisy_estimate, with_samples(32), cut)));
}

TEST(RenderJob, H9_crop_is_cut_out_of_the_whole_image) {
    const EmptyScene whole(film_of_size(40, 30));
    const EmptyScene part(film_of_size(40, 30) +
                          "<integer name=\"crop_offset_x\" value=\"7\"/>"
                          "<integer name=\"crop_offset_y\" value=\"11\"/>"
                          "<integer name=\"crop_width\" value=\"20\"/>"
                          "<integer name=\"crop_height\" value=\"9\"/>");
    const FilmState all = whole.render(noisy_estimate, with_samples(5));
    const FilmState cut = part.render(noisy_estimate, with_samples(5));
    ASSERT_EQ(cut.pixel_count(), 180u);
    for (std::size_t y = 0; y < 9; ++y) {
        for (std::size_t x = 0; x < 20; ++x) {
            for (std::size_t c = 0; c < 4; ++c) {
                EXPECT_EQ(cut.mean(x + 20 * y, c), all.mean(x + 7 + 40 * (y + 11), c));
            }
        }
    }
}

TEST(RenderJob, seeds_and_pixels_differ) {
    const EmptyScene scene(film_of_size(8, 8));
    RenderOptions options = with_samples(2);
    const FilmState a = scene.render(noisy_estimate, options);
    options.seed = 1;
    EXPECT_FALSE(same_bits(a, scene.render(noisy_estimate, options)));
    EXPECT_NE(a.mean(0, 3), a.mean(1, 3));
    // The two halves of a pixel, too.
    EXPECT_NE(a.half_mean(0, 0, 3), a.half_mean(0, 1, 3));
}

TEST(RenderJob, halves_are_independent_of_each_other) {
    const EmptyScene scene(film_of_size(64, 64), "sobol");
    const FilmState film =
        scene.render([](const Ray&, SampleStream& stream,
                        PixelSample& result) { result.radiance = Color(stream.next_1d()); },
                     with_samples(2));
    double covariance = 0;
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        covariance += (film.half_mean(i, 0, 0) - 0.5) * (film.half_mean(i, 1, 0) - 0.5);
    }
    // Standard deviation of the mean of 4096 products: 1/12 / 64.
    EXPECT_LT(std::abs(covariance / 4096), 4.0 / 12 / 64);
}

TEST(RenderJob, samples_that_are_not_finite_are_reported_with_their_pixel) {
    const EmptyScene scene(film_of_size(16, 16));
    const FilmState film = scene.render(
        [](const Ray& ray, SampleStream& stream, PixelSample& result) {
            noisy_estimate(ray, stream, result);
            if (ray.d.x > 0.1f && stream.next_1d() < 0.5f) result.radiance.x = infinity;
        },
        with_samples(4));
    EXPECT_GT(film.dropped_samples(), 0u);
    EXPECT_EQ(film.complete_samples(), 4u);
    EXPECT_TRUE(film.first_dropped_pixel());
}

TEST(RenderJob, error_target_is_met_after_the_same_samples_for_any_threads) {
    const EmptyScene scene(film_of_size(32, 32) + "<rfilter type=\"box\"/>");
    const auto uniform = [](const Ray&, SampleStream& stream, PixelSample& result) {
        result.radiance = Color(stream.next_1d());
    };
    RenderOptions options = {.budget = {.samples = 100000, .error = 2e-3}, .threads = 1};
    const FilmState one = scene.render(uniform, options);
    options.threads = 2;
    EXPECT_TRUE(same_bits(one, scene.render(uniform, options)));
    EXPECT_LE(one.error()->relative_mse, 2e-3);
    // 1/12 / (1/4 + 0.01/4) / n = 2e-3 at n = 165.
    EXPECT_GT(one.complete_samples(), 150u);
    EXPECT_LT(one.complete_samples(), 200u);
}

/// All halves agree as long as nothing has been found: that is no reason to stop.
TEST(RenderJob, error_target_is_not_met_by_a_few_black_samples) {
    const EmptyScene scene(film_of_size(8, 8));
    const FilmState film = scene.render([](const Ray&, SampleStream&, PixelSample&) {},
                                        {.budget = {.samples = 64, .error = 0.1}, .threads = 1});
    EXPECT_GE(film.complete_samples(), 16u);
}

TEST(RenderJob, N14_time_limit_ends_it) {
    const EmptyScene scene(film_of_size(16, 16));
    const auto start = std::chrono::steady_clock::now();
    const FilmState film = scene.render(noisy_estimate, {.budget = {.seconds = 0.3}});
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    EXPECT_GT(film.complete_samples(), 1u);
    EXPECT_LT(seconds.count(), 3);
}

TEST(RenderJob, N1_interruption_is_obeyed_within_a_sample) {
    const EmptyScene scene(film_of_size(64, 64));
    std::atomic<bool> stop = false;
    std::atomic<int> after = 0;
    RenderOptions options = with_samples(1000000);
    options.interrupted = [&] { return stop.load(); };
    scene.render(
        [&](const Ray& ray, SampleStream& stream, PixelSample& result) {
            if (stop) ++after;
            noisy_estimate(ray, stream, result);
            if (stream.next_1d() < 1e-4f) stop = true;
        },
        options);
    EXPECT_LT(after, 1000);
}

TEST(RenderJob, passes_can_be_driven_by_the_integrator) {
    const EmptyScene scene(film_of_size(8, 8));
    RenderJob job(*scene, with_samples(10), scene.film());
    std::uint64_t expected = 0;
    job.run_passes([&](SampleRange range) {
        EXPECT_EQ(range.begin, expected);
        expected = range.end;
        job.sample_pixels(range, noisy_estimate);
    });
    EXPECT_EQ(expected, 10u);
    EXPECT_TRUE(same_bits(job.state(), scene.render(noisy_estimate, with_samples(10))));
}

TEST(RenderJob, reports_progress) {
    const EmptyScene scene(film_of_size(8, 8));
    RenderOptions options = {.budget = {.seconds = 0.5}, .threads = 2};
    double last = 0;
    int reports = 0, passes = 0;
    options.progress = [&](const RenderStatus& status) {
        EXPECT_GE(status.fraction, last);
        EXPECT_LE(status.fraction, 1);
        last = status.fraction;
        ++reports;
    };
    options.after_pass = [&](const RenderStatus&, const FilmState&) { ++passes; };
    scene.render(noisy_estimate, options);
    EXPECT_GE(reports, 2);
    EXPECT_GE(passes, 3);
}

TEST(RenderJob, layers_are_zero_when_the_estimator_is_called) {
    const EmptyScene scene(film_of_size(8, 8));
    FilmLayout layout = film_layout(*scene);
    layout.layers = {"a", "b"};
    const FilmState film = scene.render(
        [](const Ray&, SampleStream& stream, PixelSample& result) {
            EXPECT_EQ(result.layers.size(), 2u);
            for (float& x : result.layers) {
                EXPECT_EQ(x, 0);
                x = 1 + stream.next_1d();
            }
        },
        with_samples(4), FilmState(layout));
    EXPECT_GT(film.mean(0, 5), 1);
}

TEST(RenderJob, needs_a_limit) {
    const EmptyScene scene(film_of_size(8, 8));
    EXPECT_THROW(RenderJob(*scene, {}, scene.film()), Error);
}

TEST(RenderJob, errors_of_estimators_reach_the_caller) {
    const EmptyScene scene(film_of_size(8, 8));
    EXPECT_THROW(scene.render([](const Ray&, SampleStream&, PixelSample&) { throw Error("no"); },
                              with_samples(1)),
                 Error);
}

}  // namespace
}  // namespace lucerna
