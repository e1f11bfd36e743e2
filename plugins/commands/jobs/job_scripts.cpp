// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/jobs/job_scripts.h"

#include "core/base/atomic_file.h"
#include "plugins/commands/jobs/file_store.h"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>
#include <utility>

namespace lucerna {

namespace {

constexpr std::string_view part_script = R"script(#!/usr/bin/env bash
# One part of a job of @PARTS@ parts. Slurm runs this script once for each part, as does
# `lucerna farm FOLDER --local N`. It is run in its folder, and may be changed.
#SBATCH --job-name=@NAME@
#SBATCH --array=1-@PARTS@
#SBATCH --output=logs/%a.txt
#SBATCH --open-mode=append
# A node to itself. For a part of a node, write --cpus-per-task=8 and --mem=16G, for example.
#SBATCH --exclusive
#SBATCH --mem=0
# Parts whose node fails, or that are preempted, go back to the queue.
#SBATCH --requeue
# Time to write a checkpoint before the limit of --time is reached.
#SBATCH --signal=B:USR1@60
@OPTIONS@lucerna=${LUCERNA:-@PROGRAM@}
part=$SLURM_ARRAY_TASK_ID
threads=${SLURM_CPUS_PER_TASK:-${SLURM_CPUS_ON_NODE:-0}} # 0: one for each processor
command=("$lucerna" @COMMAND@)
goes_on=@GOES_ON@ # 1: after a stop, from its checkpoint; 0: a stop loses what was done
@OTHER@
note() { printf '%s %s %s\n' "$1" "$(date +%s)" "$2" >> "records/$part.txt"; }

# Slurm sends SIGUSR1 to this shell, before the time limit, and SIGTERM to all processes of the
# part, when it is preempted or cancelled. After either, the command writes a checkpoint and ends.
reason= stopping=
trap 'reason=${reason:-limit} stopping=1; kill -TERM "$running"' USR1
trap 'reason=${reason:-asked} stopping=1' TERM
note start "${SLURMD_NODENAME:-$(hostname)}"
"${command[@]}" &
running=$!
wait "$running"
code=$?
while [[ -n $stopping ]]; do # a signal ends `wait` before the command ends
    stopping=
    wait "$running"
    code=$?
done
if [[ $reason == limit ]] && ((code != 0 && !goes_on)); then
    echo "part $part takes longer than Slurm's time limit, and cannot go on later: raise the limit"
    code=1
fi
note end "$code"

# Exit codes 75 and from 128 on (a signal) say: again. What was asked to stop, Slurm requeues
# itself or was told to forget. Whatever else comes back 20 times does not come from bad luck. The
# number of the last part's job is that of the whole array, so that parts are named by both numbers.
if [[ -n ${SLURM_JOB_ID-} && $reason != asked ]] && ((code == 75 || code >= 128)); then
    if [[ $reason == limit ]] || ((${SLURM_RESTART_COUNT:-0} < 20)); then
        scontrol requeue "${SLURM_ARRAY_JOB_ID}_$part"
    fi
fi
exit "$code"
)script";

constexpr std::string_view merge_script = R"script(#!/usr/bin/env bash
# What is left to do when all parts of the job are done. It is run in its folder.
#SBATCH --job-name=@NAME@-merge
#SBATCH --output=logs/merge.txt
#SBATCH --open-mode=append
#SBATCH --requeue
@OPTIONS@lucerna=${LUCERNA:-@PROGRAM@}
note() { printf '%s %s %s\n' "$1" "$(date +%s)" "$2" >> records/merge.txt; }

asked=
trap 'asked=1' TERM # preempted or cancelled: Slurm requeues it itself, or was told to forget it
note start "${SLURMD_NODENAME:-$(hostname)}"
"$lucerna" @COMMAND@
code=$?
note end "$code"
# Exit codes 75 and from 128 on (a signal) say: again, as for parts.
if [[ -n ${SLURM_JOB_ID-} && -z $asked ]] && ((code == 75 || code >= 128)); then
    ((${SLURM_RESTART_COUNT:-0} < 20)) && scontrol requeue "$SLURM_JOB_ID"
fi
exit "$code"
)script";

/// Every "@NAME@" of the text replaced.
std::string filled_in(std::string_view text,
                      const std::vector<std::pair<std::string, std::string>>& values) {
    std::string result(text);
    for (const auto& [name, value] : values) {
        const std::string mark = "@" + name + "@";
        for (std::size_t at = result.find(mark); at != std::string::npos;
             at = result.find(mark, at + value.size())) {
            result.replace(at, mark.size(), value);
        }
    }
    return result;
}

}  // namespace

void write_job(const JobFolder& job, const JobCommands& commands) {
    namespace fs = std::filesystem;
    std::string options;
    for (const std::string& option : commands.slurm_options) options += "#SBATCH " + option + "\n";
    std::string other;
    if (!commands.other.empty()) {
        other = fmt::format(
            "if ((part > {})); then\n    command=(\"$lucerna\" {})\n    goes_on=1\nfi\n",
            commands.other_after, commands.other);
    }
    const auto write = [&](const fs::path& path, std::string_view text,
                           const std::string& command) {
        write_file_atomically(path, filled_in(text, {{"NAME", job.name()},
                                                     {"PARTS", std::to_string(job.part_count())},
                                                     {"OPTIONS", options},
                                                     {"PROGRAM", commands.program},
                                                     {"GOES_ON", commands.goes_on ? "1" : "0"},
                                                     {"OTHER", other},
                                                     {"COMMAND", command}}));
        fs::permissions(path, fs::perms::owner_exec | fs::perms::group_exec, fs::perm_options::add);
    };
    for (const char* folder : {"parts", "logs", "records"}) make_folder(job.path() / folder);
    write(job.part_script(), part_script, commands.part);
    write(job.merge_script(), merge_script, commands.merge);
    job.write();
}

}  // namespace lucerna
