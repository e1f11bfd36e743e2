// SPDX-License-Identifier: Apache-2.0
/// The two scripts of a job: one that Slurm runs once for each part, and one for the end.
#pragma once

#include "plugins/commands/jobs/job_folder.h"

#include <string>
#include <vector>

namespace lucerna {

/// What a job does, as words of a shell.
struct JobCommands {
    std::string program;  ///< path of lucerna
    std::string part;     ///< "render scene/scene.xml --part \"$part/64\" …"
    std::string merge;    ///< "merge parts/*.exr …"
    bool goes_on =
        true;  ///< a part that was stopped goes on from a checkpoint; else it begins anew
    /// What parts with a number above `other_after` do instead, if not empty; they go on.
    std::string other{};
    int other_after = 0;
    /// Options of sbatch for both scripts, as "--partition=long".
    std::vector<std::string> slurm_options{};
};

/// Writes both scripts, the folders that they use and, last of all, what makes the folder a job.
void write_job(const JobFolder& job, const JobCommands& commands);

}  // namespace lucerna
