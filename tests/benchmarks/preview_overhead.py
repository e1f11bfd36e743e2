#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What previews cost: time of a render with each kind of viewer over time without, for the same
samples.

    tests/benchmarks/preview_overhead.py --lucerna build/release/bin/lucerna

Renders take turns in random order, so that other work on the machine hits all of them alike.
Printed are medians over the rounds of the ratios of wall time and of processor time, with their
quartiles; the latter depends less on what else runs. An absent tev costs nothing but attempts to
reach it: its ratio tells how much is noise.
"""
import argparse
import contextlib
import json
import pathlib
import random
import re
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parents[2]


@contextlib.contextmanager
def tev(reads):
    """The place of a server that takes all that it is sent, or nothing."""
    server = socket.create_server(("127.0.0.1", 0))
    ended = threading.Event()

    def serve():
        with contextlib.suppress(OSError):
            connection = server.accept()[0]
            while reads and connection.recv(1 << 20):
                pass
            ended.wait()
            connection.close()

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    yield f"127.0.0.1:{server.getsockname()[1]}"
    ended.set()
    server.close()


def watch(errors, ended):
    """Asks what the page asks, as often."""
    seen = 0
    while not ended.is_set():
        url = re.search(r"preview: (\S+)\n", errors.read_text())
        if url:
            with contextlib.suppress(OSError, ValueError):
                status = json.load(urllib.request.urlopen(url[1] + "status"))
                if status["picture"] != seen:
                    seen = status["picture"]
                    urllib.request.urlopen(url[1] + "picture").read()
        time.sleep(0.5)


def render(arguments, viewer):
    """Seconds of the clock and of processors that a render takes."""
    with tempfile.TemporaryDirectory() as scratch, contextlib.ExitStack() as stack:
        folder = pathlib.Path(scratch)
        errors = folder / "errors.txt"
        words = [arguments.lucerna, "render", arguments.scene, "--resolution", arguments.resolution,
                 "--spp", str(arguments.spp), "--json", "-o", folder / "picture"]
        if viewer in ("tev", "tev that takes nothing"):
            words += ["--preview", stack.enter_context(tev(viewer == "tev"))]
        elif viewer == "absent tev":
            words += ["--preview", "127.0.0.1:1"]
        elif viewer != "none":
            words += ["--preview", "web"]
        ended = threading.Event()
        watcher = threading.Thread(target=watch, args=(errors, ended))
        with errors.open("w") as stream:
            process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=stream)
            if viewer == "web":
                watcher.start()
            output = process.communicate()[0]
        ended.set()
        if viewer == "web":
            watcher.join()
        figures = json.loads(output)["figures"]
        return figures["render_seconds"], figures["cpu_seconds"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--lucerna", default=ROOT / "build/release/bin/lucerna")
    parser.add_argument("--scene", default=ROOT / "scenes/cornell-box/scene.xml")
    parser.add_argument("--resolution", default="1280x720")
    parser.add_argument("--spp", type=int, default=8)
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.parse_args()
    random.seed(0)
    viewers = ["none", "tev", "tev that takes nothing", "absent tev", "web", "web without a page"]
    rounds = []
    for _ in range(arguments.rounds):
        order = random.sample(viewers, len(viewers))
        rounds.append({viewer: render(arguments, viewer) for viewer in order})
        print(f"round {len(rounds)}: {rounds[-1]}", file=sys.stderr)
    seconds = statistics.median(times["none"][0] for times in rounds)
    print(f"{arguments.resolution}, {arguments.spp} spp, {seconds:.1f} s without a preview")
    print(f"{'viewer':24}{'wall time':>24}{'processor time':>24}")
    for viewer in viewers[1:]:
        line = f"{viewer:24}"
        for kind in (0, 1):
            ratios = [times[viewer][kind] / times["none"][kind] for times in rounds]
            low, middle, high = statistics.quantiles(ratios, n=4, method="inclusive")
            line += f"{middle:9.4f} ({low:.3f} to {high:.3f})".rjust(24)
        print(line)


main()
