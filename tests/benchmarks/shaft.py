#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The error in the volume caustic of scenes/shaft after equal time: volpath, photonmap and sppm.

    tests/benchmarks/shaft.py [--seconds 20] [--lucerna PROGRAM]

The pictures are of the shaft alone. The reference is a run of sppm with another seed and a smaller
initial radius, six times as long. Prints the mean squared error of each, and how many times that of
volpath is as large: the ratio of their efficiencies, since the time is the same.
"""
import argparse
import json
import os
import subprocess
import tempfile

SIZE = ["-D", "width=480", "-D", "height=300", "--crop", "245,165,75,60"]
PHOTONS = ["--set", "integrator.volume_photons=100000", "--set", "integrator.caustic_photons=20000",
           "--set", "integrator.global_photons=20000", "--set", "integrator.volume_lookup_size=10"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--lucerna", default="./lucerna")
    arguments = parser.parse_args()

    def render(integrator, seconds, output, options):
        subprocess.run([arguments.lucerna, "render", "scenes/shaft/scene.xml", "-q", *SIZE, "-D",
                        f"integrator={integrator}", "--time", str(seconds), "-o", output, *options],
                       check=True)

    with tempfile.TemporaryDirectory() as folder:
        reference = os.path.join(folder, "reference.exr")
        render("sppm", 6 * arguments.seconds, reference,
               ["--seed", "99", "--set", "integrator.initial_radius=0.015"])
        base = None
        for integrator, options in (("volpath", []), ("photonmap", PHOTONS), ("sppm", [])):
            picture = os.path.join(folder, "picture.exr")
            render(integrator, arguments.seconds, picture, options)
            report = subprocess.run([arguments.lucerna, "diff", picture, reference, "--json"],
                                    check=True, capture_output=True, text=True).stdout
            errors = json.loads(report)["finite_pixels"]
            base = base or errors["mse"]
            print(f"{integrator:10} MSE {errors['mse']:.4g}  relative MSE "
                  f"{errors['relative_mse']:.4g}  efficiency {base / errors['mse']:.1f}",
                  flush=True)


if __name__ == "__main__":
    main()
