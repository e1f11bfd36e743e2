// SPDX-License-Identifier: Apache-2.0
/// How far a job is: from the files that its parts write, and from Slurm's queue if it knows more.
#pragma once

#include "core/base/json.h"
#include "plugins/commands/jobs/job_folder.h"
#include "plugins/commands/jobs/slurm.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lucerna {

/// How far a part is, or the merge.
enum class PartState : std::uint8_t {
    waiting,  ///< not started, or stopped to be run again
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
    PartStatus merge{};
    std::optional<double> seconds_left{};

    int count(PartState state) const;
    /// A part or the merge needs somebody to look at it.
    bool broken() const;
};

/// `now` in seconds since 1970.
JobStatus job_status(const JobFolder& job, std::int64_t now, const QueueStates& queue);

std::string status_text(const JobFolder& job, const JobStatus& status);

Json to_json(const JobFolder& job, const JobStatus& status);

}  // namespace lucerna
