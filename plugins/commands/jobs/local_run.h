// SPDX-License-Identifier: Apache-2.0
/// The scripts of a job run on this machine, several at a time, with the variables that Slurm
/// would set.
#pragma once

#include "plugins/commands/jobs/job_folder.h"

namespace lucerna {

/// Runs the parts that are not done, `processes` at a time, then merges. SIGINT and SIGTERM let the
/// parts write checkpoints and end. Returns an exit code. Throws FileError if a log cannot be
/// written.
int run_locally(const JobFolder& job, int processes, bool quiet);

}  // namespace lucerna
