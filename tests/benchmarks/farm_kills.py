#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Kills the parts of farm's jobs at random moments, and shows that nothing is lost.

    tests/benchmarks/farm_kills.py build/release/bin/lucerna [--kills 1000] [--slurm-kills 200]

A small picture is rendered by `lucerna farm --local` again and again, and by a real Slurm of two
virtual nodes on this host if it is installed and this is root. Meanwhile, at random moments (fixed
seed), the render of a part gets SIGKILL or SIGTERM, the script around it SIGKILL, `farm --local`
itself SIGTERM or SIGKILL; in Slurm, a part is requeued as if it was preempted, or the daemon of a
node is stopped with all that runs there, and started again later. Each finished job is merged and
compared with the picture of a single render. Fails if one bit differs, or if a part is given up.
"""
import argparse
import collections
import json
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCENE = ROOT / "scenes/cornell-box/scene.xml"


def run(*words, check=True, cwd=None):
    return subprocess.run([*map(str, words)], check=check, capture_output=True, text=True, cwd=cwd)


def processes(needle, folder):
    """Ids of the processes in this folder whose command line holds the words."""
    found = []
    for path in Path("/proc").glob("[0-9]*"):
        try:
            words = (path / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
            if needle in words and os.readlink(path / "cwd") == str(folder):
                found.append(int(path.name))
        except OSError:
            continue
    return found


def send(process, which):
    try:
        os.kill(process, which)
        return True
    except ProcessLookupError:
        return False


class Job:
    """A packed job that is rendered again and again."""

    def __init__(self, options, folder):
        self.options, self.folder, self.finished = options, folder, 0
        self.single = folder.parent / "single"
        size = ["--resolution", options.resolution, "--spp", options.spp,
                "--set", "sensor.film.component_format=float32",
                "--set", f"integrator={options.integrator}"]
        run(options.lucerna, "render", SCENE, *size, "-q", "-o", self.single)
        run(options.lucerna, "farm", SCENE, *size, "--parts", options.parts, "-o", folder, "-q")
        script = folder / "part.sh"  # checkpoints often enough to matter
        often = " --quiet --checkpoint-every 0.05 "
        script.write_text(script.read_text().replace(" --quiet ", often))

    def check(self):
        """Compares the merged picture, and takes it away."""
        told = json.loads(run(self.options.lucerna, "diff", "--json", self.folder / "scene.exr",
                              f"{self.single}.exr").stdout)
        png = (self.folder / "scene.png").read_bytes()
        if told["all_pixels"]["mse"] != 0 or png != Path(f"{self.single}.png").read_bytes():
            sys.exit("the bits DIFFER")
        self.finished += 1
        for name in ("parts", "records", "logs"):
            shutil.rmtree(self.folder / name)
            (self.folder / name).mkdir()
        for name in ("scene.exr", "scene.png"):
            (self.folder / name).unlink()

    def renders(self):
        return processes(" --part ", self.folder)


def tell(counts):
    """A line for each hundred kills."""
    total = sum(counts.values())
    if total and total % 100 == 0:
        print(f"{total} kills", file=sys.stderr, flush=True)


def kill_local(options, folder, counts):
    job = Job(options, folder)
    words = [options.lucerna, "farm", folder, "--local", str(options.processes), "-q"]
    while sum(counts.values()) < options.kills - options.slurm_kills:
        farm = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
        while farm.poll() is None:
            time.sleep(random.uniform(0, options.longest))
            kind = random.choices(["render SIGKILL", "render SIGTERM", "script SIGKILL",
                                   "farm SIGTERM", "farm SIGKILL"], [8, 8, 2, 1, 1])[0]
            what, name = kind.split()
            victims = {"farm": [farm.pid], "render": job.renders(),
                       "script": processes("bash part.sh", folder)}[what]
            if victims and send(random.choice(victims), getattr(signal, name)):
                counts[kind] += 1
                tell(counts)
        errors = farm.communicate()[1]
        if farm.returncode not in (0, 130, -signal.SIGKILL, -signal.SIGTERM, 1):
            sys.exit(f"farm ended with {farm.returncode}: {errors}")
        # A part is given up after 20 kills in a row; the next call goes on with it.
        gave_up = [line for line in errors.splitlines() if "failed with exit code" in line]
        if any("exit code 137" not in line and "exit code 130" not in line for line in gave_up):
            sys.exit(errors)
        if farm.returncode == 0:
            # Renders whose script was killed may still write: they write equal files.
            while job.renders():
                time.sleep(0.05)
            job.check()
    while subprocess.run(words).returncode != 0:
        pass
    job.check()
    return job.finished


class Cluster:
    """A Slurm of two nodes on this host, as tests/commands/slurm.sh starts it."""

    def __init__(self, folder):
        sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(3)]
        ports = [s.getsockname()[1] for s in sockets]
        for s in sockets:
            s.close()
        text = (ROOT / "tests/commands/slurm.conf.in").read_text()
        values = {"HOST": socket.gethostname().split(".")[0], "FOLDER": folder,
                  "CONTROLLER": ports[0], "ONE": ports[1], "TWO": ports[2]}
        for name, value in values.items():
            text = text.replace(f"@{name}@", str(value))
        (folder / "slurm.conf").write_text(text)
        (folder / "state").mkdir()
        os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
        self.folder, self.daemons = folder, {}
        self.start("controller", "slurmctld", "-D")
        for node in ("one", "two"):
            self.start_node(node)
        while run("sinfo", "--noheader", "--format=%t:%D", check=False).stdout != "idle:2\n":
            time.sleep(0.3)

    def start(self, name, *words):
        with open(self.folder / f"{name}.log", "a") as log:
            self.daemons[name] = subprocess.Popen(words, stdout=log, stderr=log)

    def start_node(self, node):
        self.start(node, "slurmd", "-D", "-N", node)

    def kill_steps(self, node=None):
        """Of this cluster, or of one of its nodes: with all that they have started."""
        jobs = None
        if node:
            jobs = run("squeue", "--noheader", f"--nodelist={node}", "--states=R", "--format=%A",
                       check=False).stdout.split()
        for path in Path("/proc").glob("[0-9]*"):
            try:
                words = (path / "cmdline").read_bytes()
                known = (path / "environ").read_bytes().split(b"\0")
            except OSError:
                continue
            if f"SLURM_CONF={self.folder}/slurm.conf".encode() not in known:
                continue
            ours = words.startswith(b"slurmstepd") or b"SLURM_ARRAY_TASK_ID" in b"".join(known)
            mine = jobs is None or any(
                f"[{job}.".encode() in words or f"SLURM_JOB_ID={job}".encode() in known
                for job in jobs)
            if ours and mine and int(path.name) != os.getpid():
                send(int(path.name), signal.SIGKILL)

    def stop_node(self, node):
        self.daemons[node].kill()
        self.daemons[node].wait()
        self.kill_steps(node)

    def close(self):
        for daemon in self.daemons.values():
            daemon.kill()
            daemon.wait()
        self.kill_steps()


def hurry(number):
    """What was requeued waits for two minutes by default."""
    waiting = run("squeue", "--noheader", "--array", f"--jobs={number}", "--states=PD",
                  "--format=%F_%K", check=False).stdout.split()
    for part in waiting:
        run("scontrol", "update", f"JobId={part}", "StartTime=now", check=False)


def kill_once(cluster, job, number, down, counts):
    """One kill of a random kind, if there is something to kill."""
    kind = random.choices(["Slurm SIGKILL", "Slurm SIGTERM", "Slurm requeue", "Slurm node stopped"],
                          [8, 8, 3, 1])[0]
    if kind == "Slurm node stopped":
        if down:
            return
        node = random.choice(["one", "two"])
        cluster.stop_node(node)
        down[node] = time.monotonic() + random.uniform(1, 15)
        counts[kind] += 1
    elif kind == "Slurm requeue":
        running = run("squeue", "--noheader", "--array", f"--jobs={number}", "--states=R",
                      "--format=%F_%K", check=False).stdout.split()
        if running:
            requeued = run("scontrol", "requeue", random.choice(running), check=False)
            counts[kind] += requeued.returncode == 0
    else:
        victims = job.renders()
        if victims and send(random.choice(victims), getattr(signal, kind.split()[1])):
            counts[kind] += 1


def given_up(options, folder, number):
    """Parts that were killed 20 times are requeued no more: the rest is to be submitted anew."""
    queued = run("squeue", "--noheader", f"--jobs={number}", check=False).stdout.strip()
    if queued or len(list((folder / "parts").glob("*.exr"))) == options.parts:
        return False
    run("scancel", (folder / "slurm_jobs.txt").read_text().split()[-1], check=False)
    return True


def kill_slurm(options, cluster, folder, counts):
    job = Job(options, folder)
    wanted = sum(counts.values()) + options.slurm_kills
    while sum(counts.values()) < wanted:
        run(options.lucerna, "farm", folder, "--submit", "-q")
        number = (folder / "slurm_jobs.txt").read_text().split("\n")[-2].split()[0]
        down, deadline = {}, time.monotonic() + 600
        while not (folder / "scene.png").exists():
            time.sleep(random.uniform(0, 2 * options.longest))
            for node in [n for n, when in down.items() if when < time.monotonic()]:
                del down[node]
                cluster.start_node(node)
            if sum(counts.values()) < wanted:
                kill_once(cluster, job, number, down, counts)
            hurry(number)
            if given_up(options, folder, number):
                break
            if time.monotonic() > deadline:
                sys.exit("lost: " + run(options.lucerna, "farm", folder, "--status",
                                        check=False).stdout)
        for node in down:
            cluster.start_node(node)
        if not (folder / "scene.png").exists():
            continue
        while run("squeue", "--noheader").stdout:
            time.sleep(0.2)
        job.check()
    return job.finished


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("lucerna", type=Path)
    parser.add_argument("--kills", type=int, default=1000, help="of all kinds")
    parser.add_argument("--slurm-kills", type=int, default=200, help="how many of them in Slurm")
    parser.add_argument("--parts", type=int, default=6)
    parser.add_argument("--processes", type=int, default=2, help="of farm --local")
    parser.add_argument("--spp", type=int, default=6000)
    parser.add_argument("--integrator", default="direct")
    parser.add_argument("--resolution", default="48x48")
    parser.add_argument("--longest", type=float, default=0.4, help="seconds between kills, at most")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    options.lucerna = options.lucerna.resolve()
    os.environ["PATH"] += ":/usr/sbin:/sbin"
    if shutil.which("slurmctld") is None or os.geteuid() != 0:
        print("without Slurm, which is not installed or needs root")
        options.slurm_kills = 0
    random.seed(options.seed)
    counts, begin = collections.Counter(), time.monotonic()
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch).resolve()
        (folder / "local").mkdir()
        jobs = kill_local(options, folder / "local/job", counts)
        if options.slurm_kills > 0:
            cluster = Cluster(folder)
            try:
                jobs += kill_slurm(options, cluster, folder / "job", counts)
            finally:
                cluster.close()
    for kind, count in sorted(counts.items()):
        print(f"{count:6} {kind}")
    print(f"{sum(counts.values())} kills, {jobs} jobs of {options.parts} parts, "
          f"{time.monotonic() - begin:.0f} s: no part was lost, all bits are identical")


if __name__ == "__main__":
    main()
