// SPDX-License-Identifier: Apache-2.0
/// Statistical tests for samplers and densities: each tells how likely a correct program is to be
/// off by as much.
#pragma once

#include "core/math/sequences.h"

#include <functional>
#include <optional>
#include <span>
#include <string>
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

/// The outcome of one test.
struct Judgement {
    double p = 1;         ///< probability that something correct deviates at least so much
    std::string figures;  ///< what was found, in words and numbers
};

/// The mean is `reference`, or within `tolerance` of it (Student's test, two-sided).
Judgement mean_is(const RunningStatistics& x, double reference, double tolerance = 0);
/// Two means are the same, or within `tolerance` of each other; for hundreds of values or more.
Judgement means_agree(const RunningStatistics& x, const RunningStatistics& y, double tolerance = 0);

/// χ² of counts against expected counts. Cells that expect fewer than 5 are pooled; a count where
/// nothing is expected has p = 0. `constraints` are the relations that fix counts (1: their sum).
Judgement chi_square(std::span<const double> observed, std::span<const double> expected,
                     double constraints = 1);

struct SphereGrid {
    int theta_cells = 32, phi_cells = 64;
    int samples = 1000000;
    std::uint64_t seed = 1;
};

/// Directions in cells of equal angles, drawn and as their density [1/sr] foretells. What it
/// integrates to less than one is the probability that `sample` fails (empty).
class SphereCounts {
public:
    SphereCounts(const std::function<std::optional<Vector3>(Vector2)>& sample,
                 const std::function<double(Vector3)>& pdf, const SphereGrid& grid = {});

    /// The density integrates to the share of draws that give a direction, and to no more than 1.
    Judgement normalization() const;
    /// Directions follow the density.
    Judgement agreement() const;

private:
    std::vector<double> observed_, expected_;  ///< the last: failures
    double samples_, integral_ = 0;
    std::string fault_;
};

/// ∫∫ f(x, y) over a rectangle, adaptively, to about `tolerance`. Peaks that are narrower than a
/// thirtieth of the rectangle may be missed: cut it first.
double integrate_2d(const std::function<double(double, double)>& f, double x0, double x1, double y0,
                    double y1, double tolerance);

/// ∫ f(w) dw over the sphere.
double integrate_sphere(const std::function<double(Vector3)>& f, double tolerance = 1e-6);

}  // namespace lucerna
