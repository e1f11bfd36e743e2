// SPDX-License-Identifier: Apache-2.0
/// The commands of Slurm: sbatch, which takes jobs, and squeue, which tells how far they are.
#pragma once

#include "plugins/commands/jobs/job_folder.h"

#include <map>
#include <string>

namespace lucerna {

/// States of the parts in Slurm's queue, by number, in Slurm's words ("RUNNING", "PENDING"). Empty
/// if nothing of the job is in the queue, or if there is no Slurm here.
std::map<int, std::string> slurm_states(const JobFolder& job);

/// Submits the parts that are not done, and what is to be done when they are.
void submit(const JobFolder& job);

}  // namespace lucerna
