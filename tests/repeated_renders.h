// SPDX-License-Identifier: Apache-2.0
/// Renders of one scene with several seeds, for statistics of single pixels.
#pragma once

#include "tests/render_scene.h"

#include <gtest/gtest.h>

#include <vector>

namespace lucerna {

/// Green means of all pixels, and the variances of these means.
struct RepeatedRenders {
    std::vector<double> mean, variance;

    RepeatedRenders(const TestScene& scene, std::uint64_t samples, std::uint64_t first_seed,
                    int count) {
        std::vector<RunningStatistics> pixels;
        for (int i = 0; i < count; ++i) {
            const FilmState film = scene.render(
                {.per_pixel = samples, .seed = first_seed + static_cast<std::uint64_t>(i)});
            EXPECT_EQ(film.dropped_samples(), 0u);
            pixels.resize(film.pixel_count());
            for (std::size_t p = 0; p < pixels.size(); ++p) pixels[p].add(film.mean(p, 1));
        }
        for (const RunningStatistics& p : pixels) {
            mean.push_back(p.mean());
            variance.push_back(sqr(p.standard_error()));
        }
    }
};

}  // namespace lucerna
