// SPDX-License-Identifier: Apache-2.0
/// `--oracle`: the light samplers of all variants, judged at the same points (light_oracle.h).
#pragma once

#include "core/base/json.h"
#include "core/render/session.h"
#include "plugins/commands/compare/comparison.h"
#include "plugins/commands/compare/light_oracle.h"

#include <string>
#include <vector>

namespace lucerna {

/// One kind of points, and what each variant's sampler does there.
struct OracleSection {
    std::string name;
    std::size_t points = 0;
    std::uint32_t dark = 0;
    OracleFigures bound{}, unoccluded{};
    std::vector<OracleFigures> variants{};
};

struct OracleReport {
    OracleOptions options;
    std::size_t lights = 0;
    std::vector<OracleSection> sections{};
};

/// What is wrong with asking about these variants, or empty.
std::string oracle_contradiction(const std::vector<Variant>& variants);

/// Points and lights are those of the scene as it stands; only samplers differ.
OracleReport ask_oracle(const SessionSettings& settings,
                        const std::vector<SessionSettings>& variants, std::uint32_t points,
                        std::uint64_t seed);

Json to_json(const OracleFigures& figures);

Json to_json(const OracleReport& report, const ComparisonResult& result);

std::string oracle_table(const OracleReport& report, const ComparisonResult& result);

}  // namespace lucerna
