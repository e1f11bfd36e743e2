// SPDX-License-Identifier: Apache-2.0
/// A comparison as JSON (complete), as CSV (a line for each run), and as a table for people.
#pragma once

#include "core/base/json.h"
#include "plugins/commands/compare/comparison.h"

#include <string>
#include <vector>

namespace lucerna {

Json to_json(const Interval& interval);

/// The mistakes that could be made in reading the figures; a sentence each.
std::vector<std::string> warnings(const ComparisonResult& result, const Summary& summary);

Json to_json(const ComparisonResult& result, const Summary& summary);

std::string to_csv(const ComparisonResult& result, const Summary& summary);

std::string table(const ComparisonResult& result, const Summary& summary);

/// The machine of each round.
std::string machine_table(const ComparisonResult& result);

}  // namespace lucerna
