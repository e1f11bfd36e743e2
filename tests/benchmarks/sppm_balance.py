#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Squared bias and variance of sppm in caustics after equal time: its defaults should balance them.

    tests/benchmarks/sppm_balance.py [--seconds 10,20,60] [--seeds 4] [--rate PASSES]
                                     [--lucerna PROGRAM] [--scene NAME]… [-- OPTION…]

For each scene the passes per processor second are measured on full pictures; then the caustic alone
is rendered with as many passes as fit into these times, with several seeds, and compared with two
runs of ptracer, three times as long as the longest. All is relative to the square of the reference,
as in `lucerna diff`. With A, B the means of half of the seeds each, and R, S the references, the
mean of (A − R)(B − S) over the pixels is the squared bias, without the noise of either. OPTIONs go
to the renders of sppm. numpy and OpenEXR are from PyPI.
"""
import argparse
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
CAUSTICS = {  # scene, and where its caustic is
    "glass ball": ("balls", "8,228,50,36"),
    "around it": ("balls", "30,200,110,80"),
    "spheres": ("spheres", "296,467,110,20"),
    "glass of water": ("caustics", "480,150,150,90"),
    "ring": ("caustics", "172,230,40,18"),
}


def pixels(path):
    """The colours of a picture, in double precision."""
    import numpy
    import OpenEXR
    with OpenEXR.File(path) as file:
        channels = file.channels()
        return numpy.asarray(channels["RGBA" if "RGBA" in channels else "RGB"].pixels[..., :3],
                             dtype=float)


class Runs:
    def __init__(self, lucerna, folder, scene, crop, options):
        self.lucerna, self.folder, self.options = lucerna, folder, options
        self.scene, self.crop = f"{ROOT}/scenes/{scene}/scene.xml", crop
        if scene == "balls":
            self.scene = os.path.join(folder, "balls.xml")
            with open(self.scene, "w", encoding="utf-8") as file:
                file.write(BALLS)

    def render(self, integrator, *options):
        """Figures of a render."""
        command = [self.lucerna, "render", self.scene, "--json", "-D", f"integrator={integrator}",
                   *options, "-o", os.path.join(self.folder, "picture")]
        if integrator == "sppm":
            command += self.options
        said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        return json.loads(said)["figures"]

    def caustic(self, integrator, *options):
        self.render(integrator, "--crop", self.crop, "--set",
                    "sensor.film.component_format=float32", *options)
        return pixels(os.path.join(self.folder, "picture.exr"))

    def passes_per_second(self):
        """Of full pictures, on processors that do nothing else."""
        figures = self.render("sppm", "--time", "8")
        return figures["samples_per_pixel"] * figures["threads"] / figures["cpu_seconds"]


def balance(runs, passes, seeds, reference_seconds):
    """Rows of (squared bias, variance) for these numbers of passes."""
    import numpy
    references = [runs.caustic("ptracer", "--seed", str(1000 + i), "--time",
                               str(reference_seconds)) for i in range(2)]
    square = numpy.mean(references, axis=0)**2
    weight = 1 / (square + 0.01 * numpy.mean(references)**2)
    pictures = {count: [] for count in passes}
    for seed in range(seeds):
        state = os.path.join(runs.folder, "state.exr")
        if os.path.exists(state):
            os.remove(state)
        for count in passes:
            pictures[count].append(runs.caustic("sppm", "--seed", str(seed), "--spp", str(count),
                                                "--checkpoint", state, "--resume"))
    noise = numpy.mean(weight * (references[0] - references[1])**2) / 2
    rows = []
    for count in passes:
        all_seeds = numpy.array(pictures[count])
        half = len(all_seeds) // 2
        a, b = all_seeds[:half].mean(axis=0), all_seeds[half:].mean(axis=0)
        bias2 = numpy.mean(weight * (a - references[0]) * (b - references[1]))
        rows.append((bias2, numpy.mean(weight * all_seeds.var(axis=0, ddof=1))))
    return rows, noise


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seconds", default="10,20,60")
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--rate", type=float, help="passes per second, if not to be measured")
    parser.add_argument("--lucerna", default="./lucerna")
    parser.add_argument("--scene", action="append", choices=CAUSTICS)
    parser.add_argument("options", nargs="*", metavar="OPTION")
    arguments = parser.parse_args()
    times = sorted(float(text) for text in arguments.seconds.split(","))
    for name in arguments.scene or CAUSTICS:
        with tempfile.TemporaryDirectory() as folder:
            runs = Runs(arguments.lucerna, folder, *CAUSTICS[name], arguments.options)
            rate = arguments.rate or runs.passes_per_second()
            passes = [max(1, round(rate * seconds)) for seconds in times]
            rows, noise = balance(runs, passes, arguments.seeds, 3 * times[-1])
        print(f"{name}: {rate:.2f} passes per second, variance of a reference {noise:.2g}")
        for seconds, count, (bias2, variance) in zip(times, passes, rows):
            print(f"  {seconds:4.0f} s {count:5} passes  squared bias {bias2:.3g}  "
                  f"variance {variance:.3g}  ratio {bias2 / variance:.2f}", flush=True)


if __name__ == "__main__":
    main()
