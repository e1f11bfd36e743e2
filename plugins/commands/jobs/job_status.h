// SPDX-License-Identifier: Apache-2.0
/// How far a job is: from the files that its parts write, and from Slurm's queue if it knows more.
#pragma once

#include "core/base/json.h"
#include "plugins/commands/jobs/job_folder.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lucerna {

enum class PartState : std::uint8_t {
    waiting,  ///< not started, or stopped with a checkpoint
    running,
    failed,  ///< ended with an exit code that says not to try again
    lost,    ///< started, and no longer in Slurm's queue
    done
};

struct PartStatus {
    PartState state = PartState::waiting;
    double seconds = 0;  ///< spent by all attempts so far
    int code = 0;        ///< of the last attempt that ended
    std::string host{};  ///< of the last attempt
};

/// Exit codes after which a part is run again: a failure that may pass, or a signal.
bool is_temporary(int code);

struct JobStatus {
    std::vector<PartStatus> parts;  ///< part n at n - 1
    std::optional<double> seconds_left{};

    int count(PartState state) const;
};

/// `now` in seconds since 1970; `queue` tells Slurm's states.
JobStatus job_status(const JobFolder& job, std::int64_t now,
                     const std::map<int, std::string>& queue);

std::string status_text(const JobFolder& job, const JobStatus& status);

Json to_json(const JobFolder& job, const JobStatus& status);

}  // namespace lucerna
