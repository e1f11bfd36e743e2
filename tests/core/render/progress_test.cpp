// SPDX-License-Identifier: Apache-2.0
/// What is said about a running render, and about a finished one.
#include "core/render/progress.h"
#include "core/render/statistics.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

const RenderStatus status = {.seconds = 30,
                             .fraction = 0.25,
                             .seconds_left = 90,
                             .samples = 16.7,
                             .rays_per_second = 3.456e6,
                             .error = ErrorEstimate{.relative_mse = 0.0123}};

TEST(Progress, tells_what_is_known) {
    EXPECT_EQ(progress_text(status), " 25 %  16 spp  3.46 Mrays/s  relMSE 0.012  1:30 left");
    EXPECT_EQ(progress_text({}), "  0 %  0 spp");
}

TEST(Progress, programs_get_all_of_it_in_one_line) {
    EXPECT_EQ(to_json(status).line(),
              R"({"seconds":30.0,"fraction":0.25,"seconds_left":90.0,"samples_per_pixel":16.0,)"
              R"("rays_per_second":3456000.0,"relative_mse":0.0123,"relative_mse_low":0.0,)"
              R"("relative_mse_high":0.0})"
              "\n");
    EXPECT_EQ(to_json(RenderStatus{}).line(),
              R"({"seconds":0.0,"fraction":0.0,"seconds_left":null,"samples_per_pixel":0.0,)"
              R"("rays_per_second":0.0,"relative_mse":null,"relative_mse_low":null,)"
              R"("relative_mse_high":null})"
              "\n");
}

TEST(Progress, bar_fits_the_terminal) {
    for (const int width : {0, 1, 10, 60, 80, 300}) {
        EXPECT_LE(progress_bar(status, width).size(), static_cast<std::size_t>(width));
    }
    EXPECT_EQ(progress_bar(status, 80).substr(0, 9), "[======> ");
}

TEST(Progress, durations) {
    EXPECT_EQ(duration_text(7.4), "0:07");
    EXPECT_EQ(duration_text(754), "12:34");
    EXPECT_EQ(duration_text(3723), "1:02:03");
    EXPECT_EQ(duration_text(-1), "?");
    EXPECT_EQ(duration_text(1e300), "?");
}

TEST(RenderFigures, one_line) {
    RenderFigures figures;
    figures.load_seconds = 0.1;
    figures.build_seconds = 0.2;
    figures.render_seconds = 4;
    figures.samples = 64;
    figures.rays.intersections = 5000000;
    figures.rays.occlusions = 3000000;
    figures.error = ErrorEstimate{.relative_mse = 0.01, .low = 0.009, .high = 0.011};
    EXPECT_EQ(figures_text(figures),
              "load 0.10 s, build 0.20 s, render 4.00 s; 64 spp; 2.00 Mrays/s; relMSE 0.01 (95 %: "
              "0.009 to 0.011)");
    EXPECT_EQ(figures_warnings(figures), "");
    figures.dropped_samples = 3;
    figures.first_dropped_pixel = "7, 8";
    EXPECT_NE(figures_warnings(figures).find("3 samples"), std::string::npos);
    EXPECT_NE(figures_warnings(figures).find("7, 8"), std::string::npos);
    EXPECT_NE(to_json(figures).text().find("\"dropped_samples\": 3"), std::string::npos);
}

TEST(RenderFigures, J8_a_wide_interval_says_why) {
    RenderFigures figures;
    figures.error = ErrorEstimate{.relative_mse = 0.1, .low = 0.02, .high = 0.9, .rare = 0.75};
    const std::string text = figures_text(figures);
    EXPECT_NE(text.find("0.02 to 0.9; not known better, since 75 % of it is in pixels that few "
                        "bright samples have reached)"),
              std::string::npos)
        << text;
}

TEST(RenderFigures, J8_light_that_may_be_missing_is_a_reason) {
    RenderFigures figures;
    figures.error =
        ErrorEstimate{.relative_mse = 0.1, .low = 0.02, .high = 0.9, .rare = 0.75, .unseen = 0.8};
    const std::string text = figures_text(figures);
    EXPECT_NE(text.find("0.02 to 0.9; not known better, since light by way of mirrors or glass is "
                        "met by chance, and may be missing)"),
              std::string::npos)
        << text;
}

/// A render that ends by its own error says so if the error may be another one.
TEST(RenderFigures, J8_an_error_that_was_asked_for_may_not_be_known) {
    RenderFigures figures;
    figures.error_asked = 0.1;
    figures.error = ErrorEstimate{.relative_mse = 0.09, .low = 0.07, .high = 0.14};
    EXPECT_EQ(figures_warnings(figures), "");
    figures.error->high = 0.16;
    EXPECT_EQ(figures_warnings(figures),
              "warning: the error seems to be below 0.1, as asked for, but cannot be known: with "
              "95 % it is between 0.07 and 0.16\n");
    figures.error->high = 3;
    figures.error->rare = 0.5;
    EXPECT_NE(figures_warnings(figures).find("0.07 and 3, since 50 % of it is in pixels"),
              std::string::npos);
    figures.error->relative_mse = 0.2;  // another limit ended it
    EXPECT_EQ(figures_warnings(figures), "");
}

}  // namespace
}  // namespace lucerna
