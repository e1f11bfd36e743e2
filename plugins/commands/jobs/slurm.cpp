// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/jobs/slurm.h"

#include "core/base/error.h"
#include "plugins/commands/jobs/child_process.h"

#include <fmt/format.h>

#include <optional>
#include <sstream>
#include <vector>

namespace lucerna {

namespace {

/// "1,3-5" for 1, 3, 4, 5.
std::string ranges_text(const std::vector<int>& sorted) {
    std::string text;
    for (std::size_t i = 0; i < sorted.size();) {
        std::size_t last = i;
        while (last + 1 < sorted.size() && sorted[last + 1] == sorted[last] + 1) ++last;
        text += (text.empty() ? "" : ",") + std::to_string(sorted[i]);
        if (last > i) text += "-" + std::to_string(sorted[last]);
        i = last + 1;
    }
    return text;
}

/// Runs sbatch and returns the number of the job.
std::string sbatch(const JobFolder& job, std::vector<std::string> words) {
    words.insert(words.begin(), {"sbatch", "--parsable"});
    const ChildOutput said = run_child({words, job.path()});
    if (said.code == cannot_execute && said.text.empty()) {
        throw Error(
            "sbatch cannot be run: is Slurm installed on this machine? Without it, --local N runs "
            "the parts here");
    }
    if (said.code != 0) {
        throw Error(
            fmt::format("sbatch refused the job with exit code {}: {}", said.code, said.text));
    }
    return said.text.substr(0, said.text.find_first_of(";\n"));
}

/// What squeue says of a job, a line each part; nothing if it has forgotten it, or is not there.
std::string squeue(const JobFolder& job, const std::string& number, const std::string& format) {
    const ChildOutput queue =
        run_child({{"squeue", "--noheader", "--array", "--jobs=" + number, "--format=" + format},
                   job.path()});
    return queue.code == 0 ? queue.text : "";
}

}  // namespace

QueueStates slurm_states(const JobFolder& job) {
    QueueStates states;
    const std::optional<SlurmJobs> jobs = job.slurm_jobs();
    if (!jobs) return states;
    states.submitted = true;
    std::istringstream part_lines(squeue(job, jobs->parts, "%K %T"));
    std::string state;
    for (int part = 0; part_lines >> part >> state;) states.parts[part] = state;
    std::istringstream(squeue(job, jobs->merge, "%T")) >> states.merge;
    return states;
}

void submit(const JobFolder& job) {
    const QueueStates queue = slurm_states(job);
    if (!queue.empty()) {
        const SlurmJobs jobs = *job.slurm_jobs();
        const std::string& number = queue.parts.empty() ? jobs.merge : jobs.parts;
        throw Error(
            fmt::format("job {} of {} is still in Slurm's queue; cancel it with `scancel "
                        "{}` to submit the rest anew",
                        number, job.path().string(), number));
    }
    const std::vector<int> missing = job.missing_parts();
    std::vector<std::string> merge = {"merge.sh"};
    std::string parts = "-";
    if (!missing.empty()) {
        parts = sbatch(job, {"--array=" + ranges_text(missing), "part.sh"});
        merge.insert(merge.begin(), "--dependency=afterok:" + parts);
    }
    job.add_slurm_jobs({.parts = parts, .merge = sbatch(job, merge)});
}

}  // namespace lucerna
