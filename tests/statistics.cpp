// SPDX-License-Identifier: Apache-2.0
#include "tests/statistics.h"

#include <fmt/format.h>

namespace lucerna {
namespace {

testing::AssertionResult verdict(bool passed, const std::string& figures) {
    return (passed ? testing::AssertionSuccess() : testing::AssertionFailure()) << figures;
}

testing::AssertionResult verdict(const Judgement& judgement, double significance) {
    return verdict(judgement.p > significance,
                   fmt::format("{}: p = {}", judgement.figures, judgement.p));
}

}  // namespace

testing::AssertionResult equivalent(const RunningStatistics& x, double reference, double delta) {
    const Interval ci = x.confidence(0.999);
    const double width = std::abs(reference) * delta;
    return verdict(ci.low >= reference - width && ci.high <= reference + width,
                   fmt::format("mean {} in [{}, {}], expected {} ± {}", x.mean(), ci.low, ci.high,
                               reference, width));
}

testing::AssertionResult mean_matches(const RunningStatistics& x, double reference,
                                      double significance) {
    return verdict(mean_is(x, reference), significance);
}

testing::AssertionResult counts_match(std::span<const double> observed,
                                      std::span<const double> expected, double significance,
                                      double constraints) {
    return verdict(chi_square(observed, expected, constraints), significance);
}

testing::AssertionResult holds(const Evidence& evidence, double significance) {
    const Finding finding = evidence.finding(significance);
    return verdict(
        finding.keeping != Keeping::broken,
        fmt::format("{}: {}, p = {}", finding.contract, finding.figures, finding.p.value_or(1)));
}

testing::AssertionResult sampling_matches_pdf(
    const std::function<std::optional<Vector3>(Vector2)>& sample,
    const std::function<double(Vector3)>& pdf, const SphereTest& test) {
    return verdict(SphereCounts(sample, pdf, test.grid).agreement(),
                   sidak(test.significance, test.tests));
}

testing::AssertionResult image_matches(std::span<const double> mean,
                                       std::span<const double> variance,
                                       std::span<const double> reference,
                                       std::span<const double> reference_variance,
                                       double significance, double fraction) {
    const double n = static_cast<double>(mean.size());
    const double limit = normal_quantile(1 - 0.5 * sidak(significance, n));
    double accepted = 0, worst = 0;
    for (std::size_t i = 0; i < mean.size(); ++i) {
        const double error = std::abs(mean[i] - reference[i]);
        const double sigma = std::sqrt(variance[i] + reference_variance[i]);
        const double z = error == 0 ? 0 : error / sigma;
        if (z <= limit) ++accepted;
        worst = std::max(worst, std::isnan(z) ? HUGE_VAL : z);
    }
    return verdict(
        accepted >= fraction * n,
        fmt::format("{} of {} values within {} sigma, worst {}", accepted, n, limit, worst));
}

}  // namespace lucerna
