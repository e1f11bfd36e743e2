// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/contracts/finding.h"

#include <fmt/format.h>

namespace lucerna {

void Evidence::test(const Judgement& judgement, const std::string& where) {
    ++trials_;
    ++tests_;
    if (tests_ > 1 && judgement.p >= worst_p_) return;
    worst_p_ = judgement.p;
    worst_figures_ = judgement.figures + (where.empty() ? "" : " " + where);
}

Evidence Evidence::in(const std::string& where) && {
    contract_ += ", " + where;
    return std::move(*this);
}

Finding Evidence::finding(double level) const {
    Finding result{.contract = contract_, .p = {}, .figures = worst_figures_};
    if (trials_ == 0) {
        result.keeping = Keeping::not_applicable;
        return result;
    }
    if (tests_ > 0) {
        result.p = -std::expm1(tests_ * std::log1p(-std::min(worst_p_, 1.0)));
        if (!(*result.p > level)) result.keeping = Keeping::broken;
    }
    if (violations_ > 0) {
        result.keeping = only_unusual_ ? Keeping::unusual : Keeping::broken;
        const double share = 100 * violations_ / trials_;
        result.figures = fmt::format("{} ({:.2g} % of {})", first_violation_, share, trials_);
    } else if (result.figures.empty()) {
        result.figures = fmt::format("{} trials", trials_);
    }
    return result;
}

std::vector<Finding> judge(const std::vector<Evidence>& contracts, double level) {
    // Which of them are statistical is known by their p.
    double tests = 0;
    for (const Evidence& evidence : contracts) tests += evidence.finding(0).p ? 1 : 0;
    std::vector<Finding> findings;
    for (const Evidence& evidence : contracts) {
        findings.push_back(evidence.finding(sidak(level, std::max(tests, 1.0))));
    }
    return findings;
}

}  // namespace lucerna
