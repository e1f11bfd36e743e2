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

#include <string>
#include <utility>
#include <vector>

namespace lucerna {

/// All combinations of `--vary PATH=A,B,…`, the first option varying slowest. Values are separated
/// by semicolons if there is one, so that they may hold commas.
std::vector<Variant> combinations(const std::vector<std::pair<std::string, std::string>>& varied);

/// The scene as the variant changes it.
SessionSettings settings_for(SessionSettings settings, const Variant& variant);

/// Renders all variants of `result` `repeats` times. False if it was interrupted; rounds that are
/// complete stay.
bool render_rounds(const SessionSettings& settings, ComparisonResult& result, int repeats,
                   bool quiet);

}  // namespace lucerna
