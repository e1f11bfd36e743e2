#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Simulates a render that is dealt out to many nodes, for docs/many_machines.md.

    tests/benchmarks/farm_scaling.py [--nodes 1000] [--hours 1000] ...

Each node loads the scene over a shared file system, builds it, renders a part and writes its state;
nodes fail at random and their parts go on from the last checkpoint; one node merges. The defaults
are the measured figures of a city with a million lights.
"""

import argparse
import heapq
import random


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("--nodes", type=int, nargs="*", default=[1, 10, 64, 100, 1000])
    add("--hours", type=float, default=1000, help="one node's time for all samples [h]")
    add("--build", type=float, default=31, help="building the scene and the light sampler [s]")
    add("--map", type=float, default=0, help="building what all nodes build alike, as photons [s]")
    add("--scene", type=float, default=0.2, help="files that each node loads [GB]")
    add("--state", type=float, default=0.16, help="state file of a part [GB]")
    add("--bandwidth", type=float, default=2, help="of the shared file system, all nodes [GB/s]")
    add("--merge", type=float, default=0.15, help="reading and adding one state [s]")
    add("--starts", type=float, default=20, help="tasks that the scheduler starts per second")
    add("--mtbf", type=float, default=10000, help="time between failures of one node [h]")
    add("--requeue", type=float, default=180, help="until a lost part runs again [s]")
    add("--checkpoint", type=float, default=60, help="time between checkpoints [s]")
    add("--shared-map", type=float, default=0.5, help="size of a map that would be shared [GB]")
    add("--seed", type=int, default=1)
    return parser.parse_args()


def simulate(a, nodes, rng, map_seconds, loaded):
    """Seconds until the picture is there, and failures on the way."""
    prepare = a.build + map_seconds
    work = a.hours * 3600 / nodes
    load_each = loaded / a.bandwidth
    disk_free, failures, ends = 0.0, 0, []
    starts = [(n / a.starts, work) for n in range(nodes)]
    heapq.heapify(starts)
    while starts:
        begin, left = heapq.heappop(starts)
        disk_free = max(disk_free, begin) + load_each  # the file system serves one after another
        ready = disk_free + prepare
        failure = rng.expovariate(1 / (a.mtbf * 3600))
        if begin + failure < ready + left:
            failures += 1
            rendered = max(begin + failure - ready, 0)
            kept = rendered - rendered % a.checkpoint
            heapq.heappush(starts, (begin + failure + a.requeue, left - kept))
        else:
            ends.append(ready + left)
    # States are written as parts end, and merged in one go.
    disk_free = 0.0
    for end in sorted(ends):
        disk_free = max(disk_free, end) + a.state / a.bandwidth
    merging = nodes * max(a.merge, a.state / a.bandwidth) if nodes > 1 else 0
    return disk_free + merging, failures


def main():
    a = arguments()
    single = a.build + a.map + a.hours * 3600
    print("nodes   seconds   speed-up  efficiency  built again  merge read  failures"
          + ("  with one map for all" if a.map else ""))
    for nodes in a.nodes:
        seconds, failures = simulate(a, nodes, random.Random(a.seed), a.map, a.scene)
        share = nodes * (a.build + a.map) / (nodes * seconds)
        speed_up = single / seconds
        line = (f"{nodes:5d} {seconds:9.0f} {speed_up:10.1f} {speed_up / nodes:10.1%}"
                f" {share:11.1%} {nodes * a.state:8.1f} GB {failures:8d}")
        if a.map:
            other, _ = simulate(a, nodes, random.Random(a.seed), 0, a.scene + a.shared_map)
            line += f" {single / (other + a.map) / nodes:20.1%}"
        print(line)


if __name__ == "__main__":
    main()
