// SPDX-License-Identifier: Apache-2.0
/// Statistical tests for samplers, densities and renders.
///
/// All draws come from fixed seeds, so that a test never flips by chance. Tests of a family share
/// its error level by Šidák's correction; functions that end a test return a gtest result with
/// the figures, for EXPECT_TRUE.
#pragma once

#include "core/math/sequences.h"

#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace lucerna {

/// Φ(x) of the standard normal distribution, and its inverse.
double normal_cdf(double x);
double normal_quantile(double p);
/// P(χ² with `dof` degrees of freedom ≥ statistic).
double chi_square_p_value(double statistic, double dof);
/// P(|T with `dof` degrees of freedom| ≥ |t|), and the t for which it is p.
double student_p_value(double t, double dof);
double student_quantile(double two_sided_p, double dof);
/// Level of one test such that `tests` independent ones err together with probability `family`.
double sidak(double family, double tests);

struct Interval {
    double low, high;
};

/// Mean and variance of a stream (Welford 1962), and of two streams joined (Chan et al. 1979).
class RunningStatistics {
public:
    void add(double x);
    void add(const RunningStatistics& other);

    double count() const { return count_; }
    double mean() const { return mean_; }
    /// Unbiased; zero for fewer than two values.
    double variance() const { return count_ > 1 ? sum_squares_ / (count_ - 1) : 0; }
    double standard_error() const { return std::sqrt(variance() / count_); }
    /// Student's interval that holds the mean with probability `level`.
    Interval confidence(double level) const;

private:
    double count_ = 0, mean_ = 0, sum_squares_ = 0;
};

/// E(δ): the 99.9 % interval of the mean lies inside reference·(1 ± delta). A test that is too weak
/// fails, other than one for a difference.
testing::AssertionResult equivalent(const RunningStatistics& x, double reference, double delta);

/// T: the mean does not differ from `reference`, two-sided, at `significance`.
testing::AssertionResult mean_is(const RunningStatistics& x, double reference,
                                 double significance = 1e-3);

/// χ² of counts against expected counts. Cells that expect fewer than 5 are pooled; a count where
/// nothing is expected fails. `constraints` are the relations that fix counts (1: their sum).
testing::AssertionResult counts_match(std::span<const double> observed,
                                      std::span<const double> expected, double significance = 1e-3,
                                      double constraints = 1);

/// What a χ² test over the sphere needs to know.
struct SphereTest {
    int theta_cells = 32, phi_cells = 64;
    int samples = 1000000;
    std::uint64_t seed = 1;
    /// Level of the family, and number of tests in it.
    double significance = 0.01;
    double tests = 1;
};

/// C and P: directions drawn by `sample` follow `pdf` [1/sr]; what it integrates to less than one
/// is the probability that sampling fails (empty).
testing::AssertionResult sampling_matches_pdf(
    const std::function<std::optional<Vector3>(Vector2)>& sample,
    const std::function<double(Vector3)>& pdf, const SphereTest& test = {});

/// ∫∫ f(x, y) over a rectangle, adaptively, to about `tolerance`. Peaks that are narrower than a
/// thirtieth of the rectangle may be missed: cut it first.
double integrate_2d(const std::function<double(double, double)>& f, double x0, double x1, double y0,
                    double y1, double tolerance);

/// ∫ f(w) dw over the sphere.
double integrate_sphere(const std::function<double(Vector3)>& f, double tolerance = 1e-6);

/// Z: pixels of a render against a reference, both as means with the variance of the mean. At least
/// `fraction` of the values must pass at Šidák's level for the image (Mitsuba's recipe, but the
/// reference's noise counts, and no variance is raised to a floor).
testing::AssertionResult image_matches(std::span<const double> mean,
                                       std::span<const double> variance,
                                       std::span<const double> reference,
                                       std::span<const double> reference_variance,
                                       double significance = 0.01, double fraction = 0.9975);

}  // namespace lucerna
