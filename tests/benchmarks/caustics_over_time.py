#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How the error in a caustic falls with time: path tracing, photon maps of three sizes, and sppm.

    tests/benchmarks/caustics_over_time.py [-o docs/images] [--seconds 60] [--lucerna PROGRAM]

Full pictures of scenes/spheres and scenes/caustics are rendered with 1, 2, 4, … samples, and their
relative MSE is taken in the caustic alone, against a long run of ptracer. Time is what the
processors have worked, loading and building included, so that other programs disturb it little.
Writes caustics_over_time.csv and .svg, and prints the errors at equal time.
"""
import argparse
import csv
import json
import math
import os
import subprocess
import tempfile

SCENES = {  # where the caustic is, and how large the maps of caustics are
    "spheres": {"crop": "296,467,110,20", "photons": (25000, 250000, 2500000)},
    "caustics": {"crop": "480,150,150,90", "photons": (2500, 25000, 250000)},
}
METHODS = ("path", "photonmap, few", "photonmap, more", "photonmap, most", "sppm")
COLOURS = ("#888888", "#f4b860", "#e07b39", "#a63d1f", "#2f6f9f")


def options(scene, method):
    if method in ("path", "sppm"):
        return ["-D", f"integrator={method}"]
    photons = scene["photons"][METHODS.index(method) - 1]
    return ["--set", f"integrator.caustic_photons={photons}"]


def processor_seconds(command):
    before = os.times()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = os.times()
    return (after.children_user + after.children_system
            - before.children_user - before.children_system)


def measure(lucerna, name, scene, seconds, folder):
    """Rows of scene, method, samples, processor seconds, relMSE."""
    path = f"scenes/{name}/scene.xml"
    crop = scene["crop"]
    reference = os.path.join(folder, f"{name}_reference.exr")
    subprocess.run([lucerna, "render", path, "-q", "-D", "integrator=ptracer", "--seed", "99",
                    "--crop", crop, "--time", str(3 * seconds), "-o", reference], check=True)
    for method in METHODS:
        samples, spent = 1, 0.0
        while spent < seconds:
            picture = os.path.join(folder, "picture.exr")
            spent = processor_seconds([lucerna, "render", path, "-q", *options(scene, method),
                                       "--spp", str(samples), "-o", picture])
            report = subprocess.run([lucerna, "diff", picture, reference, "--crop", crop, "--json"],
                                    check=True, capture_output=True, text=True).stdout
            error = json.loads(report)["finite_pixels"]["relative_mse"]
            print(f"{name:10} {method:16} {samples:6} samples {spent:8.2f} s  relMSE {error:.4g}",
                  flush=True)
            yield name, method, samples, spent, error
            samples *= 2


def at_time(rows, seconds):
    """The error at a time, along a line between logarithms; the last one from then on."""
    points = [(math.log(t), math.log(e)) for _, _, _, t, e in rows]
    x = math.log(seconds)
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if x0 <= x <= x1:
            return math.exp(y0 + (y1 - y0) * (x - x0) / (x1 - x0))
    return math.exp(points[-1][1]) if x > points[-1][0] else math.nan


class Chart:
    """One diagram of two logarithmic axes, as a part of an SVG."""

    width, height, left, top = 330, 260, 56, 30

    def __init__(self, title, rows, x):
        times, errors = [r[3] for r in rows], [r[4] for r in rows]
        self.x0, self.x1 = math.log10(min(times)) - 0.05, math.log10(max(times)) + 0.05
        self.y0, self.y1 = math.floor(math.log10(min(errors))), math.ceil(math.log10(max(errors)))
        self.title, self.rows, self.offset = title, rows, x

    def place(self, seconds, error):
        return (self.left + self.width * (math.log10(seconds) - self.x0) / (self.x1 - self.x0),
                self.top + self.height * (self.y1 - math.log10(error)) / (self.y1 - self.y0))

    def svg(self):
        parts = [f'<g transform="translate({self.offset},0)">',
                 f'<text class="title" x="{self.left}" y="20">{self.title}</text>',
                 f'<rect x="{self.left}" y="{self.top}" width="{self.width}" '
                 f'height="{self.height}" class="frame"/>']
        for power in range(self.y0, self.y1 + 1):
            y = self.place(1, 10.0 ** power)[1]
            parts.append(f'<path class="grid" d="M{self.left} {y:.1f}h{self.width}"/>'
                         f'<text class="y" x="{self.left - 6}" y="{y + 4:.1f}">'
                         f'10<tspan dy="-4" font-size="8">{power}</tspan></text>')
        for seconds in (1, 2, 5, 10, 20, 50, 100, 200):
            if self.x0 <= math.log10(seconds) <= self.x1:
                x = self.place(seconds, 1)[0]
                parts.append(f'<path class="grid" d="M{x:.1f} {self.top}v{self.height}"/><text '
                             f'class="x" x="{x:.1f}" y="{self.top + self.height + 16}">{seconds}'
                             '</text>')
        for method, colour in zip(METHODS, COLOURS):
            points = [self.place(r[3], r[4]) for r in self.rows if r[1] == method]
            line = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
            parts.append(f'<polyline points="{line}" stroke="{colour}"/>')
            parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.6" fill="{colour}"/>'
                      for x, y in points]
        return "\n".join(parts + ["</g>"])


def write_svg(path, rows):
    charts = [Chart(name, [r for r in rows if r[0] == name], 410 * i)
              for i, name in enumerate(dict.fromkeys(r[0] for r in rows))]
    keys = "".join(f'<circle cx="{70 + 150 * i}" cy="346" r="4" fill="{colour}"/>'
                   f'<text x="{80 + 150 * i}" y="350">{method}</text>'
                   for i, (method, colour) in enumerate(zip(METHODS, COLOURS)))
    with open(path, "w", encoding="utf-8") as out:
        out.write('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 820 362" '
                  'font-family="sans-serif" font-size="12">\n<style>\n'
                  'polyline{fill:none;stroke-width:1.8}.grid{stroke:#ddd}.x{text-anchor:middle}\n'
                  '.frame{fill:none;stroke:#999}.y{text-anchor:end}.title{font-weight:bold}\n'
                  '</style>\n<rect width="820" height="362" fill="white"/>\n'
                  + "\n".join(chart.svg() for chart in charts)
                  + '\n<text x="410" y="326" text-anchor="middle">processor seconds, full picture;'
                  ' upwards: relative MSE in the caustic</text>\n' + keys + "\n</svg>\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("-o", "--output", default="docs/images")
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--lucerna", default="./lucerna")
    arguments = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name, scene in SCENES.items():
            rows += measure(arguments.lucerna, name, scene, arguments.seconds, folder)
    os.makedirs(arguments.output, exist_ok=True)
    base = os.path.join(arguments.output, "caustics_over_time")
    with open(base + ".csv", "w", newline="", encoding="utf-8") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["scene", "method", "samples", "processor_seconds", "relmse"])
        writer.writerows([*row[:3], f"{row[3]:.2f}", f"{row[4]:.4g}"] for row in rows)
    write_svg(base + ".svg", rows)
    for name in SCENES:
        lines = {m: [r for r in rows if r[:2] == (name, m)] for m in METHODS}
        path = at_time(lines["path"], arguments.seconds)
        print(f"{name}: error of path over that of the others after {arguments.seconds:.0f} s:",
              ", ".join(f"{m} {path / at_time(rows_of, arguments.seconds):.0f}"
                        for m, rows_of in lines.items() if m != "path"))


if __name__ == "__main__":
    main()
