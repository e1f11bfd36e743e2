// SPDX-License-Identifier: Apache-2.0
/// What the command line of `lucerna compare` says.
#pragma once

#include "core/render/budget.h"
#include "plugins/commands/compare/comparison.h"
#include "plugins/commands/scene_options.h"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lucerna {

struct Request : SceneOptions {
    std::string output, reference = "auto";
    std::vector<std::pair<std::string, std::string>> varied;
    RenderBudget budget;
    std::optional<std::uint64_t> reference_samples;
    int repeats = 5, oracle_points = 200, round = 0;
    std::uint64_t seed = 0;
    bool oracle = false, quiet = false, json = false;
    bool parts = false, submit = false, collect = false;
    std::vector<std::string> slurm_options;
};

void declare_comparison(Arguments& arguments, Request& request);
void declare_parts(Arguments& arguments, Request& request);
void declare_runs(Arguments& arguments, Request& request);

/// What the reference is to have.
RenderBudget reference_budget(const Request& request);
std::uint64_t reference_seed(const Request& request);

/// What is wrong with the arguments taken together, or empty.
std::string contradiction(const Request& request, const std::vector<Variant>& variants);

/// Variants that would be called the same, as in a comparison of something with itself.
void number_equal_names(std::vector<Variant>& variants);

}  // namespace lucerna
