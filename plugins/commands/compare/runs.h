// SPDX-License-Identifier: Apache-2.0
/// Rendering the variants, turn by turn.
///
/// Every run builds the scene anew, so that nothing that a variant has learnt or allocated serves
/// another one. Repeats are interleaved, and each begins with another variant: what disturbs the
/// machine for a while disturbs all. A short run of each variant comes first and is thrown away: it
/// warms caches, and shows at once whether all of them can be rendered.
#pragma once

#include "core/render/session.h"
#include "plugins/commands/compare/comparison.h"
#include "plugins/commands/compare/round.h"

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lucerna {

/// The values of `--vary PATH=A,B,…`. They are separated by semicolons if there is one, so that
/// they may hold commas.
std::vector<std::string> varied_values(const std::string& list);

/// All combinations of `--vary PATH=A,B,…`, the first option varying slowest.
std::vector<Variant> combinations(const std::vector<std::pair<std::string, std::string>>& varied);

/// The scene as the variant changes it.
SessionSettings settings_for(SessionSettings settings, const Variant& variant);

/// What all rounds of a comparison have in common.
struct RoundSettings {
    SessionSettings session;
    std::vector<Variant> variants;
    RenderBudget budget;
    std::uint64_t seed = 0;
    int repeats = 0;
};

/// Pictures of different sizes cannot be compared: throws Error.
void check_size(const Variant& variant, Vector2i size, Vector2i reference);

/// Renders a sample of each variant. `check` is called with the scene of each, before. False if it
/// was interrupted.
bool warm_up(const RoundSettings& settings,
             const std::function<void(const Variant& variant, const Session& session)>& check);

/// Renders one round, and calls `finished` after each run. Empty if it was interrupted.
using RunFinished = std::function<void(std::size_t variant, RunRecord run)>;
std::optional<Machine> render_round(const RoundSettings& settings, int repeat,
                                    const RunFinished& finished);

/// Measures a run of a variant against the reference of the result, and adds it.
void add_run(ComparisonResult& result, std::size_t variant, int repeat, RunRecord run);

/// Renders all rounds. False if it was interrupted; rounds that are complete stay.
bool render_rounds(const RoundSettings& settings, ComparisonResult& result, bool quiet);

}  // namespace lucerna
