// SPDX-License-Identifier: Apache-2.0
/// What the check of a contract finds: a promise that all plugins of a kind make, kept or broken.
#pragma once

#include "plugins/commands/contracts/statistics.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lucerna {

/// How hard contracts are tried. The same numbers find the same things.
struct Effort {
    int samples = 200000;  ///< to a statistical test; exact ones take a part of it
    std::uint64_t seed = 1;

    /// samples / divisor, but not less than `least`.
    int part(int divisor, int least = 100) const { return std::max(samples / divisor, least); }
};

enum class Keeping : std::uint8_t {
    kept,
    broken,
    unusual,        ///< allowed, but the author should know
    not_applicable  ///< there was nothing to try
};

struct Finding {
    std::string contract;  ///< "directions follow their density"
    Keeping keeping = Keeping::kept;
    std::optional<double> p;  ///< of the statistical tests in it, all together
    std::string figures;      ///< of what is worst
};

/// Gathers what the trials of one contract show.
class Evidence {
public:
    explicit Evidence(std::string contract) : contract_(std::move(contract)) {}

    /// One of several statistical tests.
    void test(const Judgement& judgement, const std::string& where = "");
    /// One trial of something that must hold exactly; `describe()` tells how it does not.
    template <typename Describe>
    bool require(bool holds, const Describe& describe) {
        ++trials_;
        if (!holds && violations_++ == 0) first_violation_ = describe();
        return holds;
    }
    /// Adds to the name of the contract where it was tried.
    Evidence in(const std::string& where) &&;
    /// A violation is allowed, but told.
    void only_unusual() { only_unusual_ = true; }

    /// Statistical tests are joined by Šidák's correction; they fail below `level`.
    Finding finding(double level) const;

private:
    std::string contract_, first_violation_, worst_figures_;
    double trials_ = 0, violations_ = 0, tests_ = 0, worst_p_ = 1;
    bool only_unusual_ = false;
};

/// The contracts of one plugin. Statistical tests share `level`, the probability that a correct
/// plugin is blamed.
std::vector<Finding> judge(const std::vector<Evidence>& contracts, double level);

}  // namespace lucerna
