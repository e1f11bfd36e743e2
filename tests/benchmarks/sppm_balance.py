#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Squared bias and variance of sppm in caustics after equal time: its defaults should balance them.

    tests/benchmarks/sppm_balance.py [--seconds 10,20,60] [--seeds 4] [--scene NAME]…
                                     [--radius 0.5,1,2] [--alpha 0.6,0.75] [--lookup 0,16]
                                     [--others] [--keep FOLDER] [--lucerna PROGRAM]

Without --radius, --alpha and --lookup the program takes its own defaults, so that --lucerna can
name an older program, to be compared with today's. --radius is in default first radii.

The passes per processor second are measured on full pictures, for each setting, so that what else
runs on the machine matters little; then the part with caustics alone is rendered with as many
passes as two processors would do in these times, with several seeds, and compared with two long
runs of ptracer, which --keep keeps. --others adds photonmap at its defaults, and ptracer, whose
variance follows from that of the references.

All is relative to the square of the reference, smoothed over 5 × 5 pixels: where it is dark, its
own noise would be in the weight. With A, B the means of half of the seeds each, and R, S the
references, the mean of (A − R)(B − S) over the pixels is the squared bias, without the noise of
either. numpy and OpenEXR are from PyPI.
"""
import argparse
import itertools
import json
import os
import subprocess
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BALLS = """<scene version="3.0.0">
    <default name="integrator" value="sppm"/>
    <integrator type="$integrator"><integer name="max_depth" value="12"/></integrator>
    <sensor type="perspective"><float name="fov" value="40"/>
        <transform name="to_world">
            <lookat origin="0, 3.2, 6" target="0, 0.5, 0" up="0, 1, 0"/>
        </transform>
        <film type="hdrfilm"><integer name="width" value="400"/>
            <integer name="height" value="300"/></film>
    </sensor>
    <shape type="rectangle" id="lamp">
        <transform name="to_world"><scale value="0.15"/>
            <lookat origin="1, 4, -4" target="0, 0, 0" up="0, 1, 0"/></transform>
        <emitter type="area"><rgb name="radiance" value="400"/></emitter>
    </shape>
    <shape type="rectangle" id="floor">
        <transform name="to_world"><scale value="6"/><rotate x="1" angle="-90"/></transform>
    </shape>
    <shape type="sphere" id="glass">
        <point name="center" value="-1.1, 1, 0"/>
        <bsdf type="dielectric"><float name="int_ior" value="1.5"/>
            <float name="ext_ior" value="1"/></bsdf>
    </shape>
    <shape type="sphere" id="chrome">
        <point name="center" value="1.1, 1, 0"/>
        <bsdf type="conductor"><string name="material" value="Cr"/></bsdf>
    </shape>
</scene>
"""
SCENES = {  # default first radius, passes of each reference, and parts: diffuse surfaces only
    "balls": (0.06068, 500, {"focus": (8, 228, 50, 36), "around it": (30, 200, 110, 80)}),
    "spheres": (0.03039, 300, {"below the glass": (296, 467, 110, 20),
                               "floor": (205, 440, 55, 45)}),
    "caustics": (0.03265, 400, {"behind the glass": (480, 150, 150, 90),
                                "in the ring": (172, 230, 40, 18)}),
}


def pixels(path):
    """The colours of a picture, in double precision."""
    import numpy
    import OpenEXR
    with OpenEXR.File(path) as file:
        channels = file.channels()
        return numpy.asarray(channels["RGBA" if "RGBA" in channels else "RGB"].pixels[..., :3],
                             dtype=float)


def smoothed(picture, reach=2):
    """The mean over a square around each pixel."""
    import numpy
    padded = numpy.pad(picture, ((reach, reach), (reach, reach), (0, 0)), mode="edge")
    windows = numpy.lib.stride_tricks.sliding_window_view(padded, (2 * reach + 1,) * 2, (0, 1))
    return windows.mean(axis=(-2, -1))


class Runs:
    def __init__(self, lucerna, folder, scene):
        self.lucerna, self.folder, self.name = lucerna, folder, scene
        self.scene = f"{ROOT}/scenes/{scene}/scene.xml"
        self.radius, self.reference_passes, self.parts = SCENES[scene]
        if scene == "balls":
            self.scene = os.path.join(folder, "balls.xml")
            with open(self.scene, "w", encoding="utf-8") as file:
                file.write(BALLS)

    def render(self, integrator, output, *options):
        """Figures of a render."""
        command = [self.lucerna, "render", self.scene, "--json", "-D", f"integrator={integrator}",
                   "--set", "sensor.film.component_format=float32", *options, "-o", output]
        said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        return json.loads(said)["figures"]

    def references(self):
        """Two full pictures, rendered unless they are there."""
        paths = [os.path.join(self.folder, f"{self.name}-{seed}.exr") for seed in (2000, 2001)]
        for path, seed in zip(paths, (2000, 2001)):
            if not os.path.exists(path):
                self.render("ptracer", path, "--spp", str(self.reference_passes), "--seed",
                            str(seed))
        return [pixels(path) for path in paths]

    def passes_in(self, integrator, seconds, *options):
        """Passes of full pictures that two processors do in these times."""
        few, many = {"sppm": (1, 40), "photonmap": (1, 9), "ptracer": (1, 33)}[integrator]
        output = os.path.join(self.folder, "rate.exr")
        first, all_of_them = (self.render(integrator, output, "--spp", str(count), *options)
                              ["cpu_seconds"] for count in (few, many))
        each = (all_of_them - first) / (many - few)
        return [max(1, round((2 * time - first) / each) + few) for time in seconds]

    def pictures(self, integrator, passes, seeds, *options):
        """The parts of the picture with caustics, as one picture; pictures[passes][seed]."""
        left, top, width, height = self.crop()
        result = {count: [] for count in passes}
        for seed in range(seeds):
            state = os.path.join(self.folder, "state.exr")
            if os.path.exists(state):
                os.remove(state)
            for count in passes:
                self.render(integrator, os.path.join(self.folder, "picture.exr"), "--crop",
                            f"{left},{top},{width},{height}", "--seed", str(seed), "--spp",
                            str(count), "--checkpoint", state, "--resume", *options)
                result[count].append(pixels(os.path.join(self.folder, "picture.exr")))
        return result

    def crop(self):
        left, top = (min(part[i] for part in self.parts.values()) for i in (0, 1))
        right, bottom = (max(part[i] + part[i + 2] for part in self.parts.values()) for i in (0, 1))
        return left, top, right - left, bottom - top

    def part(self, picture, name, offset=(0, 0)):
        left, top, width, height = self.parts[name]
        left, top = left - offset[0], top - offset[1]
        return picture[top:top + height, left:left + width]


def balance(pictures, references, weight):
    """Squared bias, and variance, of a part of the picture."""
    import numpy
    half = len(pictures) // 2
    a, b = (numpy.mean(some, axis=0) for some in (pictures[:half], pictures[half:]))
    bias2 = numpy.mean(weight * (a - references[0]) * (b - references[1]))
    return bias2, numpy.mean(weight * numpy.var(pictures, axis=0, ddof=1))


def numbers(text):
    return [float(number) for number in text.split(",")]


def main():
    import numpy
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seconds", type=numbers, default=[10, 20, 60])
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--scene", action="append", choices=SCENES)
    parser.add_argument("--radius", type=numbers, default=[None])
    parser.add_argument("--alpha", type=numbers, default=[None])
    parser.add_argument("--lookup", type=numbers, default=[None])
    parser.add_argument("--others", action="store_true")
    parser.add_argument("--keep", metavar="FOLDER")
    parser.add_argument("--lucerna", default="./lucerna")
    arguments = parser.parse_args()
    times = sorted(arguments.seconds)
    for name in arguments.scene or SCENES:
        with tempfile.TemporaryDirectory() as folder:
            runs = Runs(arguments.lucerna, arguments.keep or folder, name)
            references = runs.references()
            square = smoothed(numpy.mean(references, axis=0))**2

            def say(how, count, seconds, values):
                for part, (bias2, variance) in values.items():
                    print(f"{name}, {part}: {how}, {seconds:g} s, {count} passes: squared bias "
                          f"{bias2:.3g}, variance {variance:.3g}, sum {bias2 + variance:.3g}",
                          flush=True)

            def weight(part):
                mean = numpy.mean([runs.part(picture, part) for picture in references])
                return 1 / (runs.part(square, part) + 0.01 * mean**2)

            def measure(integrator, how, *options):
                passes = runs.passes_in(integrator, times, *options)
                pictures = runs.pictures(integrator, passes, arguments.seeds, *options)
                for seconds, count in zip(times, passes):
                    say(how, count, seconds, {part: balance(
                        [runs.part(picture, part, runs.crop()) for picture in pictures[count]],
                        [runs.part(picture, part) for picture in references], weight(part))
                        for part in runs.parts})

            if arguments.others:
                noise = {part: numpy.mean(weight(part) * numpy.square(
                    runs.part(references[0], part) - runs.part(references[1], part))) / 2
                    for part in runs.parts}
                for seconds, count in zip(times, runs.passes_in("ptracer", times)):
                    say("ptracer", count, seconds, {
                        part: (0, noise[part] * runs.reference_passes / count)
                        for part in runs.parts})
                measure("photonmap", "photonmap")
            for radius, alpha, lookup in itertools.product(arguments.radius, arguments.alpha,
                                                           arguments.lookup):
                given = {"initial_radius": radius and radius * runs.radius, "alpha": alpha,
                         "lookup_size": None if lookup is None else int(lookup)}
                given = {name: value for name, value in given.items() if value is not None}
                options = [word for name, value in given.items()
                           for word in ("--set", f"integrator.{name}={value}")]
                measure("sppm", ", ".join(f"{name} {value:.4g}" for name, value in given.items())
                        or "defaults", *options)


if __name__ == "__main__":
    main()
