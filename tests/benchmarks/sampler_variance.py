#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Variance per sample of Lucerna's samplers over that of Mitsuba's samplers of the same names.

Both renderers trace paths of the same depth into the same film with a box filter. Mitsuba rounds
sample counts up to what its sampler needs (`ldsampler`: powers of four, `orthogonal`: squares of
primes); Lucerna then takes as many, given as the sampler's `sample_count`. `sobol`, which Mitsuba
lacks, is compared with each of the others at the counts of `ldsampler`.

    variance    mean over pixels and channels of variance / (mean² + 0.01 (mean of the image)²),
                times the samples per pixel; the variance is that over seeds
    ratio       Lucerna's over Mitsuba's, with a 95 % interval: jackknife over seeds, of logarithms
    trimmed     the same without the 2 % of pixels with the largest sum of both: edges of lights,
                most often, whose few pixels decide about the ratio of the others
"""
import argparse
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml

NAMES = ("independent", "stratified", "multijitter", "orthogonal", "ldsampler")
# 97.5 % quantile of Student's t, by degrees of freedom.
STUDENT = {2: 4.30, 3: 3.18, 4: 2.78, 5: 2.57, 6: 2.45, 7: 2.36, 8: 2.31, 9: 2.26, 10: 2.23,
           11: 2.20, 12: 2.18, 13: 2.16, 14: 2.14, 15: 2.13}


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", type=pathlib.Path, metavar="SCENE.xml")
    parser.add_argument("--samplers", default=",".join([*NAMES, "sobol"]))
    parser.add_argument("--spp", default="16,64,512", help="per pixel; 16,64,512 by default")
    parser.add_argument("--depths", default="2,8",
                        help="max_depth; 2 is direct light; 2,8 by default")
    parser.add_argument("--seeds", type=int, default=8, help="3 to 16; 8 by default")
    parser.add_argument("--resolution", default="64x64", metavar="WxH")
    parser.add_argument("--variant", default="llvm_ad_rgb", help="of Mitsuba")
    parser.add_argument("--set", action="append", default=[], metavar="PATH=VALUE",
                        help="for Lucerna only, as in `lucerna render`")
    parser.add_argument("--python", help="the interpreter that has Mitsuba; this one by default")
    program = pathlib.Path(__file__).resolve().parents[2] / "build/release/bin/lucerna"
    parser.add_argument("--lucerna", default=str(program))
    parser.add_argument("--json", type=pathlib.Path, help="writes all figures there, too")
    options = parser.parse_args()
    if not 3 <= options.seeds <= max(STUDENT) + 1:
        parser.error("--seeds must be from 3 to 16")
    options.size = [int(side) for side in options.resolution.split("x")]
    return options


class Mitsuba:
    def __init__(self, options):
        import mitsuba
        self.mi = mitsuba
        mitsuba.set_variant(options.variant)
        mitsuba.set_log_level(mitsuba.LogLevel.Error)
        self.size = options.size

    def load(self, path, depth, sampler):
        mi = self.mi
        config = mi.parser.ParserConfig(mi.variant())
        config.unused_properties = mi.LogLevel.Debug  # old scenes hold what it does not know
        mi.file_resolver().prepend(str(path.parent.resolve()))
        state = mi.parser.parse_string(config, changed_scene(path, sampler))
        mi.parser.transform_all(config, state)
        scene = mi.parser.instantiate(config, state)
        self.scene = scene[0] if isinstance(scene, list) else scene
        parameters = mi.traverse(self.scene)
        size = next(key for key in parameters.keys() if key.endswith("film.size"))
        parameters[size] = self.size
        parameters.update()
        self.integrator = mi.load_dict({"type": "path", "max_depth": depth})

    def samples(self, spp):
        """What its sampler makes of a sample count."""
        sampler = self.scene.sensors()[0].sampler()
        sampler.set_sample_count(spp)
        return sampler.sample_count()

    def render(self, spp, seed):
        import numpy
        image = self.mi.render(self.scene, integrator=self.integrator, spp=spp, seed=seed)
        return numpy.array(image)[..., :3].astype(float)


def changed_scene(path, sampler):
    """The text of a scene with another sampler, a box filter, and no integrator of its own."""
    tree = xml.parse(path)
    for integrator in tree.findall("integrator"):
        tree.getroot().remove(integrator)
    for sensor in tree.iter("sensor"):
        for old in sensor.findall("sampler"):
            sensor.remove(old)
        xml.SubElement(sensor, "sampler", type=sampler)
    for film in tree.iter("film"):
        for old in film.findall("rfilter"):
            film.remove(old)
        xml.SubElement(film, "rfilter", type="box")
    # Old scenes write <lookAt>, which Mitsuba 3 does not upgrade.
    return xml.tostring(tree.getroot(), encoding="unicode").replace("lookAt", "lookat")


class Lucerna:
    def __init__(self, options, folder):
        self.options = options
        self.output = f"{folder}/lucerna.exr"

    def load(self, path, depth, sampler):
        settings = ["integrator.type=path", f"integrator.max_depth={depth}",
                    "sensor.film.component_format=float32", "sensor.film.rfilter.type=box",
                    f"sensor.sampler.type={sampler}", *self.options.set]
        self.command = [self.options.lucerna, "render", str(path), "--quiet", "-o", self.output,
                        "--resolution", self.options.resolution]
        for setting in settings:
            self.command += ["--set", setting]

    def render(self, spp, seed):
        import mitsuba
        import numpy
        command = [*self.command, "--seed", str(seed),
                   "--set", f"sensor.sampler.sample_count={spp}"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(done.stderr)
        bitmap = mitsuba.Bitmap(self.output).convert(mitsuba.Bitmap.PixelFormat.RGB,
                                                     mitsuba.Struct.Type.Float32, False)
        return numpy.array(bitmap).astype(float)


def ratio_with_interval(ours, theirs, scale, trimmed):
    """Both are images [seed, row, column, channel]; `scale` is the ratio of their samples."""
    import numpy
    mean = numpy.concatenate([ours, theirs]).mean(axis=0)
    squares = mean**2 + 0.01 * mean.mean() ** 2

    def relative(images):
        return (images.var(axis=0, ddof=1) / squares).mean(axis=-1).ravel()
    sums = relative(ours) * scale + relative(theirs)
    keep = numpy.argsort(sums)[:len(sums) - (len(sums) // 50 if trimmed else 0)]

    def logarithm(a, b):
        return math.log(scale * relative(a)[keep].mean() / relative(b)[keep].mean())
    n = len(ours)
    # Seeds of the two are independent, so each is left out by itself.
    left = [[logarithm(numpy.delete(ours, i, axis=0), theirs) for i in range(n)],
            [logarithm(ours, numpy.delete(theirs, i, axis=0)) for i in range(n)]]
    error = math.sqrt(sum((n - 1) * numpy.var(part) for part in left))
    value = logarithm(ours, theirs)
    return [math.exp(value + k * STUDENT[n - 1] * error) for k in (0, -1, 1)]


def images_of(renderer, spp, seeds):
    import numpy
    return numpy.array([renderer.render(spp, seed) for seed in range(seeds)])


def compare(path, depth, options, mitsuba, lucerna):
    """Prints a row for each pair of samplers and sample count."""
    names = options.samplers.split(",")
    for asked in [int(spp) for spp in options.spp.split(",")]:
        sobol = None
        for name in [name for name in names if name != "sobol"]:
            mitsuba.load(path, depth, name)
            spp = mitsuba.samples(asked)
            theirs = images_of(mitsuba, spp, options.seeds)
            lucerna.load(path, depth, name)
            yield row(path, depth, name, name, spp, spp, theirs,
                      images_of(lucerna, spp, options.seeds))
            if "sobol" not in names:
                continue
            if sobol is None:
                lucerna.load(path, depth, "sobol")
                sobol = images_of(lucerna, asked, options.seeds)
            yield row(path, depth, "sobol", name, asked, spp, theirs, sobol)


def row(path, depth, ours, theirs, ours_spp, theirs_spp, their_images, our_images):
    ratio, trimmed = (ratio_with_interval(our_images, their_images, ours_spp / theirs_spp, trim)
                      for trim in (False, True))
    result = {"scene": path.parent.name or path.stem, "depth": depth, "lucerna": ours,
              "mitsuba": theirs, "spp": [ours_spp, theirs_spp], "ratio": ratio, "trimmed": trimmed,
              "brightness": our_images.mean() / their_images.mean() - 1}
    print(f"| {result['scene']} | {depth} | {ours} | {theirs} | {ours_spp} | {theirs_spp} | "
          f"{interval(ratio)} | {interval(trimmed)} | {100 * result['brightness']:+.1f} % |",
          flush=True)
    return result


def interval(values):
    return "{:.2f} [{:.2f}, {:.2f}]".format(*values)


def main():
    options = arguments()
    if options.python and pathlib.Path(options.python).absolute() != pathlib.Path(sys.executable):
        os.execv(options.python, [options.python, *sys.argv])
    mitsuba = Mitsuba(options)
    print("| scene | depth | Lucerna | Mitsuba | samples | samples | variance per sample |"
          " trimmed | mean |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        lucerna = Lucerna(options, folder)
        for path in options.scenes:
            for depth in [int(depth) for depth in options.depths.split(",")]:
                rows += compare(path, depth, options, mitsuba, lucerna)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
