// SPDX-License-Identifier: Apache-2.0
/// Means, ratios and their intervals over a few independent repeats.
#pragma once

#include <span>
#include <vector>

namespace lucerna {

/// An estimate and the interval that covers the truth with the stated confidence.
struct Interval {
    double value = 0, low = 0, high = 0;
};

/// P(|T| < t) of Student's distribution with a whole number of degrees of freedom ≥ 1.
/// M. Abramowitz, I. Stegun, "Handbook of Mathematical Functions" (1964), 26.7.3 and 26.7.4.
double student_within(double t, int degrees);

/// The t with student_within(t, degrees) = confidence, in (0, 1). Degrees beyond a thousand hardly
/// differ, and are taken as a thousand.
double student_quantile(double confidence, double degrees);

/// Mean and the variance of that mean.
struct Mean {
    double value = 0;
    double variance = 0;  ///< infinite for a single value
    double degrees = 0;
};

Mean mean_of(std::span<const double> values);

/// Zero, the error of equal pictures, counts as the smallest number that a picture can show.
std::vector<double> logarithms(std::span<const double> values);

Interval from_logarithm(double center, double margin);

/// Geometric mean of positive values with its 95 % interval: Student's, of the logarithms.
Interval geometric_mean(std::span<const double> values);

/// Ratio of two geometric means with its 95 % interval: B. L. Welch, "The generalization of
/// 'Student's' problem", Biometrika 34 (1947), of the logarithms.
Interval ratio_of_means(std::span<const double> above, std::span<const double> below);

/// Geometric mean of the ratios of pairs, such as runs on one machine, with its 95 % interval:
/// Student's, of the logarithms.
Interval paired_ratio(std::span<const double> above, std::span<const double> below);

/// The interval of a mean square of which a few pixels hold the part `share`. By chance the next
/// repeat may lack them, or hold as much again: the ends go further apart by the factor
/// 1 / (1 − share) each, so that what few repeats did not meet is allowed for.
Interval widened_for_tail(Interval interval, double share);

double median(std::vector<double> values);

}  // namespace lucerna
