#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# `lucerna farm` with a real Slurm: two virtual nodes on this host, without munge, on loopback.
# Renders eight parts, stops one part by SIGUSR1 as at a time limit, preempts one by a job that is
# more urgent, kills a node's daemon with all that runs on it, and compares the merged picture with
# a single render, bit by bit. Exit code 77:
# Slurm is not installed, or this is not root.
#
#   tests/commands/slurm.sh PATH-OF-LUCERNA
set -euo pipefail
root=$(dirname -- "$(dirname -- "$(dirname -- "$(readlink -f -- "$0")")")")
lucerna=$(readlink -f -- "$1")
PATH=$PATH:/usr/sbin:/sbin
for program in slurmctld slurmd sbatch squeue scontrol python3; do
    command -v "$program" > /dev/null && continue
    echo "skipped: $program is not installed (package slurm-wlm)"
    exit 77
done
((EUID == 0)) || { echo "skipped: Slurm's daemons need root" && exit 77; }

scratch=$(mktemp -d)
daemons=()
# Ends a process and all that it has started.
kill_tree() {
    local child
    for child in $(pgrep -P "$1" || true); do kill_tree "$child"; done
    kill -KILL "$1" 2> /dev/null || true
}
# kill_steps [PATTERN]: of this Slurm, those whose title matches. They are no children of the
# daemons that started them, but know their configuration.
kill_steps() {
    local process
    for process in $(pgrep slurmstepd || true); do
        grep -qzx "SLURM_CONF=$SLURM_CONF" "/proc/$process/environ" 2> /dev/null || continue
        [[ -z ${1-} ]] || grep -qz "$1" "/proc/$process/cmdline" || continue
        kill_tree "$process"
    done
}
finish() {
    local code=$?
    ((code == 0)) || tail -n 20 "$scratch"/*.log "$scratch"/job/logs/* 2> /dev/null || true
    for daemon in "${daemons[@]}"; do kill_tree "$daemon"; done
    kill_steps
    wait 2> /dev/null || true
    rm -rf "$scratch"
    exit "$code"
}
trap finish EXIT
fail() { echo "FAILED: $*" >&2 && exit 1; }
# wait_for SECONDS WHAT COMMAND…: until the command succeeds.
wait_for() {
    local end=$((SECONDS + $1)) what=$2
    shift 2
    until "$@"; do
        ((SECONDS < end)) || fail "$what"
        sleep 0.3
    done
}

host=$(hostname -s)
export SLURM_CONF=$scratch/slurm.conf
# Three ports that nobody uses.
read -r controller one two < <(python3 -c '
import socket
sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(3)]
print(*(s.getsockname()[1] for s in sockets))')
sed -e "s|@HOST@|$host|; s|@FOLDER@|$scratch|; s|@CONTROLLER@|$controller|" \
    -e "s|@ONE@|$one|; s|@TWO@|$two|" "$root/tests/commands/slurm.conf.in" > "$SLURM_CONF"
mkdir "$scratch/state"
slurmctld -D > "$scratch/controller.log" 2>&1 &
daemons+=($!)
disown
for node in one two; do
    slurmd -D -N "$node" > "$scratch/$node.log" 2>&1 &
    daemons+=($!)
    disown
done
all_idle() { [[ $(sinfo --noheader --format=%t:%D 2> /dev/null) == idle:2 ]]; }
wait_for 30 "the nodes do not get ready" all_idle

cd -- "$scratch"
scene=$root/scenes/cornell-box/scene.xml
"$lucerna" render "$scene" --resolution 160x160 --spp 256 --quiet -o single
"$lucerna" farm "$scene" --resolution 160x160 --parts 8 --spp 256 -o job --quiet --submit
job=$(cut -d ' ' -f 1 job/slurm_jobs.txt)

running() { [[ $(squeue --noheader --array --jobs="$job" --states=R | wc -l) -ge $1 ]]; }
done_parts() { [[ $(find job/parts -name '*.exr' | wc -l) -ge $1 ]]; }
wait_for 60 "no parts run" running 2

# As before a time limit: a part writes a checkpoint and asks for another turn. Slurm refuses
# signals for parts that are just starting, and scancel tries for long to signal one that has gone
# back to the queue meanwhile.
stopped() {
    grep -qE '^end .* (130|143)$' job/records/*.txt && return
    local part
    part=$(squeue --noheader --array --jobs="$job" --states=R --format=%K | head -n 1)
    [[ -z $part ]] || timeout 3 scancel --batch --signal=USR1 "${job}_$part" 2> /dev/null || true
    return 1
}
wait_for 60 "SIGUSR1 stops no part" stopped

# A job that is more urgent takes the node: the part writes a checkpoint and ends, and Slurm puts it
# back into the queue.
on_one() { squeue --noheader --array --jobs="$job" --states=R --nodelist=one --format=%K; }
node_one_works() { preempted=$(on_one | head -n 1) && [[ -n $preempted ]]; }
wait_for 60 "node one has nothing to do" node_one_works
sbatch --parsable --partition=urgent --nodelist=one --exclusive --output=/dev/null \
    --wrap 'sleep 1' > /dev/null
# Unless it was done just before.
made_way() {
    [[ -e job/parts/$preempted.exr ]] || grep -q '^end .* 130$' "job/records/$preempted.txt"
}
wait_for 60 "part $preempted is not preempted" made_way

wait_for 120 "no part is done" done_parts 1
on_two() { squeue --noheader --array --nodelist=two --states=R --format='%K %A' | head -n 1; }
node_two_works() { read -r lost job_of_lost < <(on_two); }
wait_for 60 "node two has nothing to do" node_two_works
echo "killing node two with part $lost"
kill -KILL "${daemons[2]}"
kill_steps "\[$job_of_lost\."
was_done=$([[ -e job/parts/$lost.exr ]] && echo yes || true)
"$lucerna" farm job --status || true

# What was requeued waits for two minutes by default; a person may say: now.
hurry() {
    local part
    for part in $(squeue --noheader --array --jobs="$job" --states=PD --format=%F_%K); do
        scontrol update "JobId=$part" StartTime=now 2> /dev/null || true
    done
}
merged() { hurry && [[ -e job/scene.exr && -e job/scene.png ]]; }
wait_for 240 "the parts are never merged: $(squeue)" merged

"$lucerna" diff job/scene.exr single.exr --json > diff.json || fail "the pictures differ"
[[ $(grep -c '"mse": 0.0' diff.json) == 2 ]] || { cat diff.json && fail "the bits differ"; }
cmp job/scene.png single.png || fail "the PNGs differ"
"$lucerna" farm job --status | tee status.txt
grep -q '8 of 8 parts done' status.txt || fail "the status is wrong"
told_of_merge() { [[ $("$lucerna" farm job --status) == *merged ]]; }
wait_for 60 "the status does not tell of the merge" told_of_merge
[[ -n $was_done || $(grep -c '^start' "job/records/$lost.txt") -ge 2 ]] ||
    fail "part $lost was not started again"
echo "eight parts, one lost node, one requeued and one preempted part: the same bits"

# A comparison: two rounds and the reference, and each round says which node it was timed on.
"$lucerna" compare "$scene" --resolution 32x32 --vary integrator.light_sampler=uniform,power \
    --spp 2 --repeats 2 --parts -o comparison --quiet --submit
job=$(cut -d ' ' -f 1 comparison/slurm_jobs.txt)
collected() { hurry && [[ -e comparison/index.html ]]; }
wait_for 120 "the comparison is never collected: $(squeue; cat comparison/logs/*)" collected
[[ $(grep -cE '"node": "(one|two)"' comparison/report.json) == 3 ]] ||
    fail "the report does not name the nodes"
echo "a comparison by two nodes"
