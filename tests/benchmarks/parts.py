#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What it costs to render in parts, and whether kills lose anything.

    tests/benchmarks/parts.py overhead build/release/bin/lucerna [--parts 64] [--spp 4096]
    tests/benchmarks/parts.py kills build/release/bin/lucerna [--kills 1000]

overhead: processor seconds of one render and of the same render in parts, from the start of each
program to its end, with all files that it writes. What a program takes to load and build is taken
off: that of a render of one sample of one pixel, of which one runs before each part. The render as
a whole runs three times between its parts, and the ratio is that within a round: other work on the
machine hits both alike.

kills: two tasks at a time render the parts of a picture; each is killed (SIGKILL or SIGTERM) at a
random moment and started again, as a scheduler does that goes by exit codes, until there were so
many kills. Then all parts are finished and merged, and the pixels compared with those of a single
render. Fails if one bit differs, or if an exit code is none that a scheduler should see.
"""
import argparse
import json
import os
import random
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SCENE = Path(__file__).parents[2] / "scenes/cornell-box/scene.xml"


def command(options, *words):
    return [options.lucerna, *map(str, words)]


def render(options, spp, *words):
    return command(options, "render", SCENE, "--resolution", options.resolution, "--spp", spp,
                   "--set", "sensor.film.component_format=float32", *words)


def run(words):
    done = subprocess.run(words, check=True, capture_output=True, text=True)
    return json.loads(done.stdout) if "--json" in words else done.stdout


def processor_seconds(words):
    """Of a program and all its threads."""
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"exit code {process.returncode}: {words}")
    return usage.ru_utime + usage.ru_stime


def preparation(options, folder):
    """Processor seconds of a program that does no more than load and build."""
    file = folder / "nothing.exr"
    file.unlink(missing_ok=True)
    return processor_seconds(render(options, 1, "-q", "--crop", "0,0,1,1", "--part", "1/1",
                                    "-o", file))


def overhead(options, folder):
    files = [folder / f"{k}.exr" for k in range(1, options.parts + 1)]
    without, with_merging = [], []
    for _ in range(options.repetitions):
        preparations, parts, wholes = [], [], []
        for k, file in enumerate(files, 1):
            file.unlink(missing_ok=True)
            preparations.append(preparation(options, folder))
            parts.append(processor_seconds(render(options, options.spp, "-q", "--part",
                                                  f"{k}/{options.parts}", "-o", file)))
            if k * 4 % options.parts < 4 and k < options.parts:
                wholes.append(processor_seconds(render(options, options.spp, "-q", "-o",
                                                       folder / "whole")))
        merging = processor_seconds(command(options, "merge", *files, "-q", "-o",
                                            folder / "merged"))
        prepared = statistics.median(preparations)
        in_parts = sum(parts) - options.parts * prepared
        whole = statistics.mean(wholes) - prepared
        without.append(in_parts / whole)
        with_merging.append((in_parts + merging) / whole)
        print(f"whole {whole:.2f} s, {options.parts} parts {in_parts:.2f} s without {prepared:.3f} "
              f"s each to load and build, merging {merging:.2f} s: overhead "
              f"{percent(without[-1])}, with merging {percent(with_merging[-1])}", flush=True)
    print(f"median overhead {percent(statistics.median(without))}, with merging "
          f"{percent(statistics.median(with_merging))}")
    return same(options, folder)


def percent(ratio):
    return f"{100 * (ratio - 1):+.1f} %"


def same(options, folder):
    """The pictures' pixels are equal: `lucerna diff` finds no error at all."""
    told = run(command(options, "diff", "--json", folder / "whole.exr", folder / "merged.exr"))
    equal = told["all_pixels"]["mse"] == 0
    print("bits are", "identical" if equal else "DIFFERENT")
    return equal and (folder / "whole.png").read_bytes() == (folder / "merged.png").read_bytes()


class Task:
    """One part, started again until it is finished."""

    def __init__(self, options, folder, part):
        self.words = render(options, options.spp, "-q", "--part", f"{part}/{options.parts}",
                            "--checkpoint-every", "0.02", "-o", folder / f"{part}.exr")
        self.process = None

    def start(self):
        self.process = subprocess.Popen(self.words, stderr=subprocess.PIPE, text=True)

    def kill(self):
        """Returns whether the part is finished."""
        self.process.send_signal(random.choice([signal.SIGKILL, signal.SIGTERM]))
        errors = self.process.communicate()[1]
        code = self.process.returncode
        if code not in (0, 130, -signal.SIGKILL, -signal.SIGTERM):
            sys.exit(f"exit code {code}: {errors}")
        return code == 0

    def finish(self):
        subprocess.run(self.words, check=True)


def kills(options, folder):
    random.seed(options.seed)
    run(render(options, options.spp, "-q", "-o", folder / "whole"))
    tasks = [Task(options, folder, k) for k in range(1, options.parts + 1)]
    finished, killed, rounds = set(), 0, 0
    while killed < options.kills:
        if len(finished) == len(tasks):  # all are there: begin again
            for file in folder.glob("[0-9]*.exr*"):
                file.unlink()
            finished.clear()
            rounds += 1
        waiting = [t for t in tasks if t not in finished]
        pair = [random.choice(waiting), random.choice(waiting)]
        if pair[0] is pair[1]:  # two tasks render one part
            pair[1] = Task(options, folder, tasks.index(pair[0]) + 1)
        for task in pair:
            task.start()
        for task in pair:
            time.sleep(random.uniform(0, options.longest))
            if task.kill():
                finished.add(pair[0] if task not in tasks else task)
            else:
                killed += 1
    for task in tasks:
        task.finish()
    files = [folder / f"{k}.exr" for k in range(1, options.parts + 1)]
    run(command(options, "merge", *files, "-q", "-o", folder / "merged"))
    print(f"{killed} kills; all parts were finished {rounds + 1} times")
    return same(options, folder)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("what", choices=["overhead", "kills"])
    parser.add_argument("lucerna")
    parser.add_argument("--parts", type=int)
    parser.add_argument("--spp", type=int)
    parser.add_argument("--resolution")
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--kills", type=int, default=1000)
    parser.add_argument("--longest", type=float, default=0.3, help="seconds until a kill, at most")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    defaults = {"overhead": (64, 4096, "128x128"), "kills": (4, 1200, "64x64")}[options.what]
    for name, value in zip(("parts", "spp", "resolution"), defaults):
        if getattr(options, name) is None:
            setattr(options, name, value)
    with tempfile.TemporaryDirectory() as folder:
        right = {"overhead": overhead, "kills": kills}[options.what](options, Path(folder))
    sys.exit(0 if right else 1)


if __name__ == "__main__":
    main()
