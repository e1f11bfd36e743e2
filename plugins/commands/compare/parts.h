// SPDX-License-Identifier: Apache-2.0
/// `--parts`: a comparison on many machines.
///
/// It becomes a job (plugins/commands/jobs). Its first parts are rounds: one machine renders all
/// variants of a round, so that what is compared was timed on one machine. The others are parts of
/// the reference. The last script collects them into the report of a comparison.
#pragma once

#include "plugins/commands/compare/comparison.h"
#include "plugins/commands/compare/request.h"
#include "plugins/commands/compare/runs.h"
#include "plugins/commands/jobs/job_folder.h"

#include <vector>

namespace lucerna {

/// Packs the comparison into the folder of --output. Throws SceneError for variants that cannot be
/// built, FileError.
JobFolder pack_comparison(const Request& request, const std::vector<Variant>& variants);

/// `--round`: renders one round into the file of --output. Returns an exit code.
int render_round_file(const Request& request, const RoundSettings& settings);

/// `--collect`: reads the rounds and the reference of the job. Throws Error for parts that are
/// missing or of another comparison; FileError.
void collect_parts(const Request& request, const RoundSettings& settings, ComparisonResult& result);

}  // namespace lucerna
