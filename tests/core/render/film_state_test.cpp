// SPDX-License-Identifier: Apache-2.0
/// What films promise: exact sums, constants that stay constant, nothing hidden, nothing twice.
#include "core/render/film_state.h"

#include "core/base/error.h"
#include "core/math/sequences.h"
#include "tests/core/render/films.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace lucerna {
namespace {

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

/// Samples of all pixels that take some; value(position) at a position on the film.
template <typename Value>
FilmState filtered_film(int side, const RFilter& rfilter, int samples, const Value& value) {
    const ReconstructionFilter filter(rfilter);
    FilmLayout layout = square_layout(side);
    layout.reach = filter.reach();
    layout.negative_weight = filter.negative_weight();
    FilmState film(layout);
    Rng rng(1);
    for (int i = 0; i < side * side; ++i) {
        for (int k = 0; k < samples; ++k) {
            const Vector2 offset = filter.place(rng.next_float2());
            add_sample(film, static_cast<std::size_t>(i),
                       grey_sample(value(Vector2(i % side, i / side) + offset)), filter, offset);
        }
    }
    return film;
}

TEST(FilmState, H1_constant_stays_constant_under_negative_lobes) {
    for (const int samples : {1, 2, 3, 4, 8, 64}) {
        const FilmState film =
            filtered_film(16, lanczos_filter(), samples, [](Vector2) { return 0.3f; });
        for (std::size_t pixel = 0; pixel < film.pixel_count(); ++pixel) {
            EXPECT_EQ(static_cast<float>(film.mean(pixel, 0)), 0.3f) << samples << " samples";
        }
    }
}

/// (x − 32)² has at a pixel's centre, filtered, its own value and the second moment of the filter.
TEST(FilmState, H1_pixels_are_the_convolution_with_the_filter) {
    constexpr int side = 64, margin = 4;
    const auto expect_moment = [&](const auto& filter) {
        const FilmState film =
            filtered_film(side, filter, 64, [](Vector2 p) { return sqr(p.x - 32); });
        double sum = 0, squares = 0, moment = 0, whole = 0;
        for (int y = margin; y < side - margin; ++y) {
            for (int x = margin; x < side - margin; ++x) {
                const double excess = film.mean(static_cast<std::size_t>(x + side * y), 0) -
                                      sqr(static_cast<double>(x) + 0.5 - 32);
                sum += excess;
                squares += sqr(excess);
            }
        }
        for (int i = 0; i < 60000; ++i) {
            const float x = filter.radius() * (2 * (static_cast<float>(i) + 0.5f) / 60000 - 1);
            moment += static_cast<double>(filter.evaluate(x) * x * x);
            whole += static_cast<double>(filter.evaluate(x));
        }
        // Neighbours share samples: the pixels that count are fewer, at least by this.
        const double n = sqr(side - 2 * margin), independent = n / sqr(2 * filter.radius());
        const double error = std::sqrt((squares / n - sqr(sum / n)) / independent);
        EXPECT_NEAR(sum / n, moment / whole, 4 * error);
        EXPECT_LT(error, 0.3);
    };
    expect_moment(lanczos_filter());
    expect_moment(FormulaFilter(1, [](float x) { return 1 - std::abs(x); }));
    expect_moment(box_filter());
    expect_moment(FormulaFilter(0.25f, [](float) { return 1.0f; }));
}

/// Noise is that of a box times ∫f² / (∫f)², and the estimate from the halves says so.
TEST(FilmState, a_wide_filter_averages_the_samples_of_neighbours) {
    constexpr int side = 96, samples = 16;
    const FormulaFilter tent(1, [](float x) { return 1 - std::abs(x); });
    Rng rng(9);
    const auto noise = [&](Vector2) { return rng.next_float(); };
    const double box = filtered_film(side, box_filter(), samples, noise).error()->mse;
    const FilmState film = filtered_film(side, tent, samples, noise);
    EXPECT_NEAR(box / (1.0 / 12 / samples), 1, 0.05);
    // 4/9, and a little less: weights divide by what they add up to.
    EXPECT_NEAR(film.error()->mse / box, 4.0 / 9, 0.03);
}

TEST(FilmState, H2_pixel_without_samples_is_black_and_counted) {
    FilmState film(square_layout(2));
    add_sample(film, 0, grey_sample(1));
    add_sample(film, 1, grey_sample(not_a_number));
    EXPECT_EQ(film.mean(3, 0), 0);
    EXPECT_EQ(film.empty_pixels(), 3u);
    const ImageFile image = film.resolve();
    for (const Plane& plane : image.planes) {
        const auto* values = std::get_if<std::vector<float>>(&plane.samples);
        if (!values) continue;
        for (const float x : *values) EXPECT_FALSE(std::isnan(x)) << plane.name;
    }
}

TEST(FilmState, H4_long_sums_keep_their_precision) {
    FilmState film(square_layout(1));
    constexpr int count = 4000000;
    for (int i = 0; i < count; ++i) add_sample(film, 0, grey_sample(0.1f));
    EXPECT_EQ(film.mean(0, 0), static_cast<double>(0.1f));
}

TEST(FilmState, H5_H6_variance_of_small_noise_on_a_large_value) {
    FilmState film(square_layout(64));
    Rng rng(3);
    constexpr int samples = 64;
    for (std::size_t pixel = 0; pixel < film.pixel_count(); ++pixel) {
        for (int i = 0; i < samples; ++i) {
            // Uniform with a width of 64 steps of a float: variance 64²/12.
            add_sample(film, pixel, grey_sample(0x1p24f + std::floor(64 * rng.next_float()) * 2));
        }
    }
    const double variance = 4 * (64.0 * 64 - 1) / 12 / samples;
    EXPECT_NEAR(film.error()->mse / variance, 1, 0.1);
}

TEST(ExactSum, H7_order_of_terms_changes_no_bit) {
    std::vector<float> terms;
    Rng rng(4);
    for (int i = 0; i < 20000; ++i) {
        const float sign = rng.next_float() < 0.5f ? -1.0f : 1.0f;
        terms.push_back(sign * std::exp2(40 * rng.next_float() - 20) * rng.next_float());
    }
    ExactSum forwards, backwards, halves[2];
    for (const float x : terms) forwards.add(static_cast<double>(x));
    for (std::size_t i = 0; i < terms.size(); ++i) {
        halves[i % 3 == 0].add(static_cast<double>(terms[i]));
    }
    std::reverse(terms.begin(), terms.end());
    for (const float x : terms) backwards.add(static_cast<double>(x));
    halves[0].add(halves[1]);
    EXPECT_EQ(forwards.high, backwards.high);
    EXPECT_EQ(forwards.low, backwards.low);
    EXPECT_EQ(forwards.high, halves[0].high);
    EXPECT_EQ(forwards.low, halves[0].low);
}

TEST(FilmState, H10_relative_errors_do_not_depend_on_the_scale) {
    const auto estimate = [](float scale) {
        FilmState film(square_layout(16));
        Rng rng(5);
        for (std::size_t pixel = 0; pixel < film.pixel_count(); ++pixel) {
            for (int i = 0; i < 8; ++i)
                add_sample(film, pixel, grey_sample(scale * rng.next_float()));
        }
        return *film.error();
    };
    const ErrorEstimate one = estimate(1), eight = estimate(8);
    EXPECT_DOUBLE_EQ(one.relative_mse, eight.relative_mse);
    EXPECT_DOUBLE_EQ(one.low, eight.low);
    EXPECT_DOUBLE_EQ(one.relative_variance(), eight.relative_variance());
    EXPECT_DOUBLE_EQ(64 * one.mse, eight.mse);
    // Uniform in [0, 1): variance 1/12, 8 samples, mean 1/2.
    EXPECT_NEAR(one.relative_variance(), 4.0 / 12 / 8, 0.01);
}

TEST(FilmState, drops_and_counts_samples_that_are_not_finite) {
    FilmState film({.full_size = {8, 8}, .crop = {{2, 3}, {4, 4}}, .layers = {"depth.Z"}});
    std::array<float, 1> layer = {1};
    PixelSample good = grey_sample(2);
    good.layers = layer;
    PixelSample infinite = good;
    infinite.radiance.y = infinity;
    PixelSample no_alpha = good;
    no_alpha.alpha = not_a_number;
    std::array<float, 1> bad_layer = {not_a_number};
    PixelSample no_layer = good;
    no_layer.layers = bad_layer;
    for (const PixelSample& sample : {good, infinite, no_alpha, no_layer, good}) {
        add_sample(film, 6, sample);
    }
    EXPECT_EQ(film.dropped_samples(), 3u);
    EXPECT_EQ(film.samples(6), 5u);
    EXPECT_EQ(film.mean(6, 0), 2);
    EXPECT_EQ(film.mean(6, 4), 1);
    EXPECT_EQ(*film.first_dropped_pixel(), Vector2i(4, 4));
    EXPECT_NE(film.resolve().plane("samples.dropped"), nullptr);
}

TEST(FilmState, merges_only_what_follows) {
    FilmState first(square_layout(1)), second(square_layout(1), 3), late(square_layout(1), 4);
    for (int i = 0; i < 3; ++i) add_sample(first, 0, grey_sample(1));
    for (int i = 0; i < 2; ++i) add_sample(second, 0, grey_sample(4));
    EXPECT_THROW(first.merge(late), Error);
    EXPECT_THROW(first.merge(first), Error);
    EXPECT_THROW(first.merge(FilmState(square_layout(2), 3)), Error);
    first.merge(second);
    EXPECT_EQ(first.samples(0), 5u);
    EXPECT_DOUBLE_EQ(first.mean(0, 0), 11.0 / 5);
    // Samples 0, 2 and 4 are one half: 1, 1, 4.
    EXPECT_DOUBLE_EQ(first.half_mean(0, 0, 0), 2);
}

TEST(FilmState, has_no_error_estimate_from_one_half) {
    FilmState film(square_layout(1));
    EXPECT_FALSE(film.error());
    add_sample(film, 0, grey_sample(1));
    EXPECT_FALSE(film.error());
    add_sample(film, 0, grey_sample(1));
    ASSERT_TRUE(film.error());
    EXPECT_EQ(film.error()->relative_mse, 0);
}

/// What an estimate and its interval say, and what is so.
struct Calibration {
    double estimate = 0, error = 0;  ///< means over the films
    int covered = 0;                 ///< films whose interval holds the error
};

/// A picture with an edge and a gradient, in light of which a part comes rarely: with probability p
/// a sample is bright, and more pixels have a small p than a large one.
Calibration calibrate(int samples, float rarest, std::size_t side = 16, int films = 200) {
    const auto mean = [&](std::size_t pixel) {
        const std::size_t x = pixel % side, y = pixel / side;
        return (x < 6 ? 0.2f : 1.0f) * (1 + 0.05f * static_cast<float>(y));
    };
    const auto probability = [&](std::size_t pixel) {
        return pixel % 3 == 0 ? rarest : pixel % 3 == 1 ? 0.1f : 0.5f;
    };
    double image_mean = 0;
    for (std::size_t i = 0; i < sqr(side); ++i) image_mean += double(mean(i));
    image_mean /= static_cast<double>(sqr(side));
    Calibration result;
    for (int f = 0; f < films; ++f) {
        FilmState film(square_layout(static_cast<int>(side)));
        Rng rng(6, static_cast<std::uint64_t>(f));
        double error = 0;
        for (std::size_t i = 0; i < film.pixel_count(); ++i) {
            const float p = probability(i);
            for (int k = 0; k < samples; ++k) {
                const float bright = rng.next_float() < p ? 1 / p : 0.0f;
                add_sample(film, i, grey_sample(mean(i) * (0.5f + 0.5f * bright)));
            }
            const double mu = double(mean(i));
            error += sqr(film.mean(i, 0) - mu) / (sqr(mu) + 0.01 * sqr(image_mean));
        }
        error /= static_cast<double>(film.pixel_count());
        const ErrorEstimate estimate = *film.error();
        result.estimate += estimate.relative_mse / films;
        result.error += error / films;
        result.covered += estimate.low <= error && error <= estimate.high;
    }
    return result;
}

TEST(FilmState, J8_error_interval_holds_the_error_of_the_image) {
    const Calibration clean = calibrate(512, 0.05f);
    EXPECT_LT(clean.error, 0.01);
    EXPECT_NEAR(clean.estimate / clean.error, 1, 0.02);
    EXPECT_GT(clean.covered, 0.93 * 200);
    EXPECT_LT(clean.covered, 0.99 * 200);

    const Calibration usual = calibrate(64, 0.01f);
    EXPECT_NEAR(usual.error, 0.15, 0.02);
    EXPECT_NEAR(usual.estimate / usual.error, 0.8, 0.05);  // known to be too low
    EXPECT_GT(usual.covered, 0.9 * 200);
}

/// An image that is mostly noise has an error above one, and says so.
TEST(FilmState, error_of_noise_is_not_limited) {
    const Calibration noise = calibrate(16, 0.002f, 64, 20);
    EXPECT_GT(noise.error, 2);
    EXPECT_GT(noise.estimate / noise.error, 0.5);
    EXPECT_LT(noise.estimate / noise.error, 1.5);
}

/// Probability that a sample meets the lamp of its pixel, in a dark picture: 6 % of the pixels hold
/// a lamp that is met with a probability between 1/50 and 1/5.
double dark_or_lamp(std::size_t pixel) {
    Rng rng(8, pixel);
    const float is_lamp = rng.next_float(), size = rng.next_float();
    return is_lamp < 0.06f ? 0.02 * std::pow(10.0, static_cast<double>(size)) : 0;
}

TEST(FilmState, J8_errors_of_small_lamps_are_known) {
    constexpr int side = 64, samples = 32, films = 40;
    constexpr float lamp = 100;
    std::vector<double> mean;
    for (std::size_t i = 0; i < sqr(side); ++i)
        mean.push_back(0.1 + double(lamp) * dark_or_lamp(i));
    const double image_mean = std::accumulate(mean.begin(), mean.end(), 0.0) / sqr(side);
    std::vector<double> ratios;
    int covered = 0;
    for (std::uint64_t f = 0; f < films; ++f) {
        FilmState film(square_layout(side));
        Rng rng(9, f);
        double error = 0;
        for (std::size_t i = 0; i < film.pixel_count(); ++i) {
            const double p = dark_or_lamp(i);
            for (int k = 0; k < samples; ++k) {
                const float dark = 0.2f * rng.next_float(), u = rng.next_float();
                add_sample(film, i, grey_sample(dark + (double(u) < p ? lamp : 0)));
            }
            error += sqr(film.mean(i, 0) - mean[i]) / (sqr(mean[i]) + 0.01 * sqr(image_mean));
        }
        error /= sqr(side);
        const ErrorEstimate estimate = *film.error();
        ratios.push_back(estimate.relative_mse / error);
        covered += estimate.low <= error && error <= estimate.high;
        EXPECT_GT(estimate.rare, 0.5);
    }
    std::sort(ratios.begin(), ratios.end());
    EXPECT_GT(ratios[films / 2], 0.67);
    EXPECT_LT(ratios[films / 2], 1.5);
    EXPECT_GE(covered, 34);
}

/// One sample in `rarity` is 300 times as bright as the rest: most pixels have none of them, some
/// have one. Nothing tells the rate, so that the interval must be wide, and must hold the error.
TEST(FilmState, J8_rare_bright_samples_make_the_interval_wide) {
    constexpr int side = 48, samples = 32, films = 40;
    for (const float rarity : {2000.0f, 20000.0f}) {
        const double mu = 1 + 300 / double(rarity);
        int covered = 0, vague = 0;
        for (std::uint64_t f = 0; f < films; ++f) {
            FilmState film(square_layout(side));
            Rng rng(10, f);
            double error = 0;
            for (std::size_t i = 0; i < film.pixel_count(); ++i) {
                for (int k = 0; k < samples; ++k) {
                    const float usual = 0.5f + rng.next_float(), u = rng.next_float();
                    add_sample(film, i, grey_sample(usual + (u * rarity < 1 ? 300.0f : 0.0f)));
                }
                error += sqr(film.mean(i, 0) - mu) / (1.01 * sqr(mu));
            }
            error /= sqr(side);
            const ErrorEstimate estimate = *film.error();
            covered += estimate.low <= error && error <= estimate.high;
            vague += estimate.vague();
        }
        EXPECT_GE(covered, 34) << rarity;
        EXPECT_GE(vague, 34) << rarity;
    }
}

/// In a tenth of the picture, one path in 50,000 meets a lamp by way of a mirror; most films have
/// none. Those that know of the lamp hold their error all the same.
TEST(FilmState, J8_light_that_no_sample_met_may_be_missing) {
    constexpr int side = 32, samples = 32, films = 40;
    constexpr float lamp = 10000, rarity = 50000;
    FilmLayout layout = square_layout(side);
    int knowing = 0, unknowing = 0;
    for (std::uint64_t f = 0; f < films; ++f) {
        FilmState film(layout);
        layout.chance_luminance = double(lamp);
        FilmState aware(layout);
        layout.chance_luminance = 0;
        Rng rng(11, f);
        double error = 0;
        for (std::size_t i = 0; i < film.pixel_count(); ++i) {
            const bool lit = i % 10 == 0;
            for (int k = 0; k < samples; ++k) {
                const float usual = 0.5f + rng.next_float(), u = rng.next_float();
                const PixelSample sample =
                    grey_sample(usual + (lit && u * rarity < 1 ? lamp : 0.0f));
                add_sample(film, i, sample);
                add_sample(aware, i, sample);
            }
            const double mu = 1 + (lit ? double(lamp / rarity) : 0);
            error += sqr(film.mean(i, 0) - mu) / (sqr(mu) + 0.01 * sqr(1.02)) / sqr(side);
        }
        const auto holds = [&](const ErrorEstimate& estimate) {
            return estimate.low <= error && error <= estimate.high;
        };
        knowing += holds(*aware.error());
        unknowing += holds(*film.error());
    }
    EXPECT_GE(knowing, 38);
    EXPECT_LE(unknowing, 20);
}

}  // namespace
}  // namespace lucerna
