#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Are the errors that a render prints the true ones?

    tests/benchmarks/error_coverage.py [--seeds 40] [--spp 32] [--lucerna PROGRAM] [SCENE …]

Renders small pictures with many seeds, takes their relMSE against a long render, and compares it
with what each render said of itself: the ratio estimate : truth (median, and the middle 80 %), and
how many of the 95 % intervals hold the truth. Prints a table; with --error, renders end by
themselves at that error, and the table also tells how many of them were right about it.
"""
import argparse
import json
import os
import random
import statistics
import subprocess
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BVH = ["--set", "integrator.light_sampler=bvh"]
ENDS = {"near": "within × 1.5 of what was asked", "warned": "not, and warned", "better": "better",
        "worse": "worse, and not warned"}
SCENES = {  # options, samples of the reference
    "cornell-box": ("cornell-box", ["--resolution", "64x64"], 1024),
    "first": ("first", ["--resolution", "64x40"], 1024),
    "city, cache": ("city", ["--resolution", "64x36"], 1024),
    "city, bvh": ("city", ["--resolution", "64x36", *BVH], 1024),
    "city, cache, 160 × 90": ("city", ["--resolution", "160x90"], 512),
    "city, bvh, 160 × 90": ("city", ["--resolution", "160x90", *BVH], 512),
    "city, street": ("city", ["--resolution", "64x36", "-D", "view=street"], 1024),
    "bar": ("bar", ["--resolution", "64x36"], 512),
    "veach-mis": ("veach-mis", ["--resolution", "72x48"], 1024),
    "caustics by path": ("caustics", ["--resolution", "64x40", "-D", "integrator=path"], 1024),
    "small lamps, cache": ("lamps", [], 1024),
    "small lamps, bvh": ("lamps", BVH, 1024),
    "hot pixel": ("hot", [], 1024),
    "small lamps, box": ("lamps", ["--set", "sensor.film.rfilter=box"], 1024),
}


def lamps_scene():
    """Blocks on a plane at night, and 150 visible lamps smaller than a pixel."""
    rng = random.Random(3)
    text = """<scene version="3.0.0">
    <integrator type="path"><integer name="max_depth" value="4"/></integrator>
    <sensor type="perspective"><float name="fov" value="45"/>
        <transform name="to_world">
            <lookat origin="0, 8, 30" target="0, 2, 0" up="0, 1, 0"/>
        </transform>
        <sampler type="sobol"/>
        <film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="36"/>
        </film>
    </sensor>
    <emitter type="constant"><rgb name="radiance" value="0.02, 0.03, 0.05"/></emitter>
    <shape type="rectangle">
        <transform name="to_world"><scale value="60"/><rotate x="1" angle="-90"/></transform>
    </shape>
"""
    for _ in range(60):
        x, z, h = rng.uniform(-20, 20), rng.uniform(-40, 15), rng.uniform(0.5, 3)
        text += f"""<shape type="cube"><transform name="to_world">
        <scale x="0.8" y="{h:.3f}" z="0.8"/><translate x="{x:.3f}" y="{h:.3f}" z="{z:.3f}"/>
        </transform></shape>\n"""
    for _ in range(150):
        x, y, z = rng.uniform(-20, 20), rng.uniform(0.5, 7), rng.uniform(-40, 20)
        text += f"""<shape type="sphere"><point name="center" x="{x:.3f}" y="{y:.3f}" z="{z:.3f}"/>
        <float name="radius" value="0.04"/>
        <emitter type="area"><rgb name="radiance" value="400, 300, 200"/></emitter></shape>\n"""
    return text + "</scene>\n"


def hot_pixel_scene(picture):
    """A sphere in a uniform environment of which one pixel is 3,000 times as bright."""
    dark, bright = bytes([128, 128, 128, 129]), bytes([188, 188, 188, 140])  # RGBE: 1 and 3008
    with open(picture, "wb") as file:
        file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 128\n")
        file.write(dark * (20 * 128 + 30) + bright + dark * (44 * 128 - 31))
    return f"""<scene version="3.0.0">
    <integrator type="path"/>
    <sensor type="perspective"><float name="fov" value="60"/>
        <transform name="to_world">
            <lookat origin="0, 1, 5" target="0, 0, 0" up="0, 1, 0"/>
        </transform>
        <film type="hdrfilm"><integer name="width" value="48"/><integer name="height" value="48"/>
        </film>
    </sensor>
    <emitter type="envmap"><string name="filename" value="{picture}"/></emitter>
    <shape type="sphere"/>
    <shape type="rectangle">
        <transform name="to_world"><scale value="4"/><rotate x="1" angle="-90"/>
        <translate y="-1"/></transform>
    </shape>
</scene>
"""


class Runs:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.lamps = os.path.join(folder, "lamps.xml")
        with open(self.lamps, "w", encoding="utf-8") as file:
            file.write(lamps_scene())
        self.hot = os.path.join(folder, "hot.xml")
        with open(self.hot, "w", encoding="utf-8") as file:
            file.write(hot_pixel_scene(os.path.join(folder, "hot.hdr")))

    def call(self, *arguments):
        result = subprocess.run([self.program, *arguments, "--json"], check=True, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        return json.loads(result.stdout)

    def render(self, scene, name, *arguments):
        """The figures of a render, and its picture."""
        folder, options, _ = SCENES[scene]
        made = {"lamps": self.lamps, "hot": self.hot}
        path = made.get(folder, f"{ROOT}/scenes/{folder}/scene.xml")
        output = os.path.join(self.folder, name)
        figures = self.call("render", path, "-q", "-o", output, *options, *arguments, "--set",
                            "sensor.film.component_format=float32")["figures"]
        return figures, output + ".exr"

    def truth(self, picture, reference):
        return self.call("diff", picture, reference)["finite_pixels"]["relative_mse"]


def percentile(values, p):
    return sorted(values)[min(int(p * len(values)), len(values) - 1)]


def row(runs, scene, seeds, asked, limit):
    """Truth, estimate and coverage of a scene; `limit` are the options that end a render, which
    may be that the error is the one asked for."""
    _, reference = runs.render(scene, "reference", "--seed", "1000000", "--spp",
                               str(SCENES[scene][2]))
    truths, ratios, held, widths, ends = [], [], 0, [], []
    for seed in range(1, seeds + 1):
        figures, picture = runs.render(scene, "picture", "--seed", str(seed), *limit)
        error, truth = figures["error"], runs.truth(picture, reference)
        low, high = error["relative_mse_low"], error["relative_mse_high"]
        truths.append(truth)
        ratios.append(error["relative_mse"] / truth)
        widths.append(high / low)
        held += low <= truth <= high
        if asked:
            ends.append("near" if asked / 1.5 <= truth <= 1.5 * asked else
                        "warned" if high > 1.5 * asked else "better" if truth < asked else "worse")
    cells = [scene, f"{statistics.median(truths):.3g}",
             f"{statistics.median(ratios):.2f} ({percentile(ratios, 0.1):.2f} to "
             f"{percentile(ratios, 0.9):.2f})",
             f"{held} of {seeds}", f"{statistics.median(widths):.3g}"]
    if asked:
        cells += [str(ends.count(end)) for end in ENDS]
    return f"| {' | '.join(cells)} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="some of: " + "; ".join(SCENES))
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--spp", type=int, default=32)
    parser.add_argument("--error", type=float, help="renders end at this error instead")
    parser.add_argument("--lucerna", default=f"{ROOT}/build/release/bin/lucerna")
    arguments = parser.parse_args()
    limit = ["--spp", str(arguments.spp)]
    if arguments.error:
        limit = ["--error", str(arguments.error), "--spp", "65536"]
    titles = ["scene", "true relMSE", "estimate : truth (80 %)", "intervals that hold it",
              "high : low"]
    if arguments.error:
        titles += ENDS.values()
    print(f"| {' | '.join(titles)} |")
    print("|" + " --- |" * len(titles))
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(arguments.lucerna, folder)
        for scene in arguments.scenes or SCENES:
            print(row(runs, scene, arguments.seeds, arguments.error, limit), flush=True)


if __name__ == "__main__":
    main()
