// SPDX-License-Identifier: Apache-2.0
/// Statistical tests as gtest results, with the figures, for EXPECT_TRUE.
///
/// All draws come from fixed seeds, so that a test never flips by chance. Tests of a family share
/// its error level by Šidák's correction.
#pragma once

#include "plugins/commands/contracts/finding.h"

#include <gtest/gtest.h>

namespace lucerna {

/// E(δ): the 99.9 % interval of the mean lies inside reference·(1 ± delta). A test that is too weak
/// fails, other than one for a difference.
testing::AssertionResult equivalent(const RunningStatistics& x, double reference, double delta);

/// T: the mean does not differ from `reference`, two-sided, at `significance`.
testing::AssertionResult mean_matches(const RunningStatistics& x, double reference,
                                      double significance = 1e-3);

/// χ² of counts against expected counts. Cells that expect fewer than 5 are pooled; a count where
/// nothing is expected fails. `constraints` are the relations that fix counts (1: their sum).
testing::AssertionResult counts_match(std::span<const double> observed,
                                      std::span<const double> expected, double significance = 1e-3,
                                      double constraints = 1);

/// A contract is kept; its statistical tests share `significance`.
testing::AssertionResult holds(const Evidence& evidence, double significance = 1e-3);

/// What a χ² test over the sphere needs to know.
struct SphereTest {
    SphereGrid grid = {};
    /// Level of the family, and number of tests in it.
    double significance = 0.01;
    double tests = 1;
};

/// C and P: directions drawn by `sample` follow `pdf` [1/sr]; what it integrates to less than one
/// is the probability that sampling fails (empty).
testing::AssertionResult sampling_matches_pdf(
    const std::function<std::optional<Vector3>(Vector2)>& sample,
    const std::function<double(Vector3)>& pdf, const SphereTest& test = {});

/// Z: pixels of a render against a reference, both as means with the variance of the mean. At least
/// `fraction` of the values must pass at Šidák's level for the image (Mitsuba's recipe, but the
/// reference's noise counts, and no variance is raised to a floor).
testing::AssertionResult image_matches(std::span<const double> mean,
                                       std::span<const double> variance,
                                       std::span<const double> reference,
                                       std::span<const double> reference_variance,
                                       double significance = 0.01, double fraction = 0.9975);

}  // namespace lucerna
