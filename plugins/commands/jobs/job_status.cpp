// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/jobs/job_status.h"

#include "core/interfaces/command.h"

#include <fmt/format.h>

#include <algorithm>

namespace lucerna {

bool is_temporary(int code) { return code == exit_code::try_again || code >= 128; }

int JobStatus::count(PartState state) const {
    int count = 0;
    for (const PartStatus& part : parts) count += part.state == state ? 1 : 0;
    return count;
}

bool JobStatus::broken() const {
    const auto broken = [](PartState s) { return s == PartState::failed || s == PartState::lost; };
    return broken(merge.state) ||
           std::ranges::any_of(parts, [&](const PartStatus& part) { return broken(part.state); });
}

namespace {

/// `queued` is the state in Slurm's queue, empty if it is not there.
PartStatus status_of(const std::vector<Attempt>& attempts, bool done, bool in_slurm,
                     const std::string& queued, std::int64_t now) {
    PartStatus status;
    bool open = false;
    for (const Attempt& attempt : attempts) {
        status.host = attempt.host;
        open = !attempt.end;
        if (attempt.end) {
            status.code = attempt.code;
            status.seconds += static_cast<double>(*attempt.end - attempt.start);
        }
    }
    if (done) {
        status.state = PartState::done;
    } else if (!queued.empty() && queued != "RUNNING") {
        status.state = PartState::waiting;
    } else if (open) {
        const bool lost = in_slurm && queued.empty();
        status.state = lost ? PartState::lost : PartState::running;
        if (!lost) status.seconds += static_cast<double>(now - attempts.back().start);
    } else if (status.code != 0 && !is_temporary(status.code)) {
        status.state = PartState::failed;
    }
    return status;
}

PartStatus part_status(const JobFolder& job, int part, std::int64_t now, const QueueStates& queue) {
    const auto queued = queue.parts.find(part);
    return status_of(job.attempts(part), job.is_done(part), queue.submitted,
                     queued == queue.parts.end() ? "" : queued->second, now);
}

/// The merge of the parts that are there: an earlier one does not count.
PartStatus merge_status(const JobFolder& job, std::int64_t now, const QueueStates& queue) {
    const std::vector<Attempt> attempts = job.merge_attempts();
    const bool done = !attempts.empty() && attempts.back().end && attempts.back().code == 0;
    return status_of(attempts, done, queue.submitted, queue.merge, now);
}

std::string merge_text(const JobFolder& job, const PartStatus& merge) {
    switch (merge.state) {
        case PartState::waiting:
            return "";
        case PartState::running:
            return fmt::format("the merge runs on {}\n", merge.host);
        case PartState::failed:
            return fmt::format("the merge failed on {} with exit code {}; see {}\n", merge.host,
                               merge.code, job.merge_log().string());
        case PartState::lost:
            return fmt::format("the merge was lost on {}; --submit runs it again\n", merge.host);
        case PartState::done:
            return "merged\n";
    }
    return "";
}

const char* name(PartState state) {
    switch (state) {
        case PartState::waiting:
            return "waiting";
        case PartState::running:
            return "running";
        case PartState::failed:
            return "failed";
        case PartState::lost:
            return "lost";
        case PartState::done:
            return "done";
    }
    return "";
}

}  // namespace

JobStatus job_status(const JobFolder& job, std::int64_t now, const QueueStates& queue) {
    JobStatus status;
    double done_seconds = 0, left = 0;
    for (int part = 1; part <= job.part_count(); ++part) {
        status.parts.push_back(part_status(job, part, now, queue));
        if (status.parts.back().state == PartState::done) {
            done_seconds += status.parts.back().seconds;
        }
    }
    const int done = status.count(PartState::done), running = status.count(PartState::running);
    if (done == job.part_count()) status.merge = merge_status(job, now, queue);
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

std::string status_text(const JobFolder& job, const JobStatus& status) {
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
    return text + merge_text(job, status.merge);
}

Json to_json(const JobFolder& job, const JobStatus& status) {
    Json json = Json::object();
    json.set("schema", 1).set("name", job.name()).set("parts", job.part_count());
    json.set("done", status.count(PartState::done));
    json.set("running", status.count(PartState::running));
    json.set("waiting", status.count(PartState::waiting));
    json.set("failed", status.count(PartState::failed));
    json.set("lost", status.count(PartState::lost));
    json.set("merge", name(status.merge.state));
    json.set("seconds_left", status.seconds_left);
    return json;
}

}  // namespace lucerna
