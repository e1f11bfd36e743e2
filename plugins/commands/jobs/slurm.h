// SPDX-License-Identifier: Apache-2.0
/// The commands of Slurm: sbatch, which takes jobs, and squeue, which tells how far they are.
#pragma once

#include "plugins/commands/jobs/job_folder.h"

#include <map>
#include <string>

namespace lucerna {

/// States in Slurm's queue, in Slurm's words ("RUNNING", "PENDING"). What is not in the queue has
/// none; nothing has one where there is no Slurm.
struct QueueStates {
    bool submitted = false;            ///< the job was given to Slurm
    std::map<int, std::string> parts;  ///< by number
    std::string merge;

    bool empty() const { return parts.empty() && merge.empty(); }
};

QueueStates slurm_states(const JobFolder& job);

/// Submits the parts that are not done, and what is to be done when they are.
void submit(const JobFolder& job);

}  // namespace lucerna
