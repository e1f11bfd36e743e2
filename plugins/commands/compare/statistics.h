// SPDX-License-Identifier: Apache-2.0
/// Means, ratios and their intervals over a few independent repeats.
#pragma once

#include <cstddef>
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

/// How many of the smallest and of the largest of n independent values leave the median between
/// them with about 95 %, whatever the distribution: the largest k with P ≥ 92 %, which together
/// with Student's interval makes 95 % (H. A. David, "Order Statistics" (1981), 2.5). 1 if n < 5,
/// although P is less.
std::size_t median_rank(std::size_t n);

/// Geometric mean of positive values, such as errors of repeats, and a 95 % interval for their
/// median: Student's, of the logarithms, and as far as the values of rank median_rank. The former
/// is right for few repeats of usual noise, where mean and median of the logarithms are the same;
/// the latter is for heavy tails, of which a mean says nothing.
Interval geometric_mean(std::span<const double> values);

/// The same of the ratios of pairs: runs of one round, which one machine did one after the other.
Interval paired_ratio(std::span<const double> above, std::span<const double> below);

double median(std::vector<double> values);

}  // namespace lucerna
