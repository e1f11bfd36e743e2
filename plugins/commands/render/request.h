// SPDX-License-Identifier: Apache-2.0
/// What the command line of `lucerna render` says.
#pragma once

#include "core/render/budget.h"
#include "plugins/commands/scene_options.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lucerna {

/// Part `number` of `count`, 1 … count.
struct Part {
    std::uint64_t number = 0, count = 0;
};

struct Request : SceneOptions {
    std::string output, checkpoint, view, preview;
    RenderBudget budget;
    std::uint64_t seed = 0;
    std::string part_text;
    std::optional<Part> part;
    std::vector<int> crop;
    double checkpoint_seconds = 60, exposure = 0;
    bool resume = false, quiet = false, json = false, json_progress = false;
};

void declare_what(Arguments& arguments, Request& request);

void declare_how(Arguments& arguments, Request& request);

/// "3/64"; nothing for any other text.
std::optional<Part> parse_part(const std::string& text);

/// What is wrong with the arguments of a part, or empty.
std::string contradiction_of_part(const Request& request);

/// What is wrong with the arguments taken together, or empty.
std::string contradiction(const Request& request);

SessionSettings session_settings(const Request& request);

}  // namespace lucerna
