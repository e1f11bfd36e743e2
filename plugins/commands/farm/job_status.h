// SPDX-License-Identifier: Apache-2.0
/// How far a job is: from the files that its parts write, and from Slurm's queue if it knows more.
#pragma once

#include "core/base/json.h"
#include "core/interfaces/command.h"
#include "plugins/commands/farm/job_folder.h"

#include <map>
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
inline bool is_temporary(int code) { return code == exit_code::try_again || code >= 128; }

struct JobStatus {
    std::vector<PartStatus> parts;  ///< part n at n - 1
    std::optional<double> seconds_left{};

    int count(PartState state) const {
        int count = 0;
        for (const PartStatus& part : parts) count += part.state == state ? 1 : 0;
        return count;
    }
};

inline PartStatus part_status(const JobFolder& job, int part, std::int64_t now,
                              const std::map<int, std::string>& queue) {
    PartStatus status;
    bool open = false;
    const std::vector<Attempt> attempts = job.attempts(part);
    for (const Attempt& attempt : attempts) {
        status.host = attempt.host;
        open = !attempt.end;
        if (attempt.end) {
            status.code = attempt.code;
            status.seconds += static_cast<double>(*attempt.end - attempt.start);
        }
    }
    const auto queued = queue.find(part);
    if (job.is_done(part)) {
        status.state = PartState::done;
    } else if (queued != queue.end() && queued->second != "RUNNING") {
        status.state = PartState::waiting;
    } else if (open) {
        const bool lost = job.slurm_job() && queued == queue.end();
        status.state = lost ? PartState::lost : PartState::running;
        if (!lost) status.seconds += static_cast<double>(now - attempts.back().start);
    } else if (status.code != 0 && !is_temporary(status.code)) {
        status.state = PartState::failed;
    }
    return status;
}

/// `now` in seconds since 1970; `queue` tells Slurm's states.
inline JobStatus job_status(const JobFolder& job, std::int64_t now,
                            const std::map<int, std::string>& queue) {
    JobStatus status;
    double done_seconds = 0, left = 0;
    for (int part = 1; part <= job.part_count(); ++part) {
        status.parts.push_back(part_status(job, part, now, queue));
        if (status.parts.back().state == PartState::done) {
            done_seconds += status.parts.back().seconds;
        }
    }
    const int done = status.count(PartState::done), running = status.count(PartState::running);
    if (done == 0 || running == 0) return status;
    // The others take as long as those that are done; as many as now run at the same time.
    const double mean = done_seconds / done;
    for (const PartStatus& part : status.parts) {
        const bool expected = part.state == PartState::waiting || part.state == PartState::running;
        if (expected) left += std::max(mean - part.seconds, 0.0);
    }
    status.seconds_left = left / running;
    return status;
}

inline std::string status_text(const JobFolder& job, const JobStatus& status) {
    std::string text =
        fmt::format("{}: {} of {} parts done, {} running, {} waiting", job.name(),
                    status.count(PartState::done), job.part_count(),
                    status.count(PartState::running), status.count(PartState::waiting));
    const int failed = status.count(PartState::failed), lost = status.count(PartState::lost);
    if (failed > 0) text += fmt::format(", {} failed", failed);
    if (lost > 0) text += fmt::format(", {} lost", lost);
    text += '\n';
    for (int part = 1; part <= job.part_count(); ++part) {
        const PartStatus& s = status.parts[static_cast<std::size_t>(part - 1)];
        if (s.state == PartState::failed) {
            text += fmt::format("part {} failed on {} with exit code {}; see {}\n", part, s.host,
                                s.code, job.log(part).string());
        } else if (s.state == PartState::lost) {
            text += fmt::format("part {} was lost on {}; --submit runs it again\n", part, s.host);
        }
    }
    if (status.seconds_left) {
        text += fmt::format("about {:.0f} s are left\n", *status.seconds_left);
    }
    return text;
}

inline Json to_json(const JobFolder& job, const JobStatus& status) {
    Json json = Json::object();
    json.set("schema", 1).set("name", job.name()).set("parts", job.part_count());
    json.set("done", status.count(PartState::done));
    json.set("running", status.count(PartState::running));
    json.set("waiting", status.count(PartState::waiting));
    json.set("failed", status.count(PartState::failed));
    json.set("lost", status.count(PartState::lost));
    json.set("seconds_left", status.seconds_left);
    return json;
}

}  // namespace lucerna
