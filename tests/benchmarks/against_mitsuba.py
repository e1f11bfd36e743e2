#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Lucerna against Mitsuba 3 on the same scenes: speed, noise, and efficiency.

Each scene is rendered by both with the same integrator (`path` unless another is asked for), size,
depth, sampler and filter, in turn, with other seeds in each round. Only rendering is timed:
loading, building and compiling are not. Noise is what differs between seeds, so no reference is
needed:

    relMSE      mean over pixels and channels of variance / (mean² + 0.01 (mean of the image)²)
    efficiency  1 / (relMSE · seconds)
    trimmed     the same without the 0.1 % of pixels with the largest relative variance
    blocks      share of blocks of 16 × 16 pixels whose means differ by more than four standard
                deviations: where the pictures do not agree

Intervals are 95 %, by the jackknife over rounds, of the logarithms of ratios. Mitsuba is installed
from PyPI into a virtual environment of its own; its LLVM variants want libLLVM (Debian: libllvm19).
"""
import argparse
import dataclasses
import glob
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time
import venv

TESTED_LLVM = ("19", "20", "18", "17", "14")


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", metavar="SCENE[@WxH]",
                        help="XML files, or folders that hold one or folders of them")
    parser.add_argument("--variants", default="llvm_ad_rgb,scalar_rgb", help="of Mitsuba")
    parser.add_argument("--seconds", type=float, default=5, help="of each render; 5 by default")
    parser.add_argument("--rounds", type=int, default=4, help="at least 2; 4 by default")
    parser.add_argument("--integrator", default="path", choices=("path", "volpath", "volpathmis"))
    parser.add_argument("--depth", type=int, default=8, help="max_depth of both; 8 by default")
    parser.add_argument("--pixels", type=int, default=120000,
                        help="of pictures without a size of their own; 120000 by default")
    parser.add_argument("--set", action="append", default=[], metavar="PATH=VALUE",
                        help="for Lucerna only, as in `lucerna render`")
    parser.add_argument("--lucerna", default=str(repository() / "build/release/bin/lucerna"))
    parser.add_argument("--venv", type=pathlib.Path,
                        default=pathlib.Path.home() / ".cache/lucerna/mitsuba")
    parser.add_argument("--json", type=pathlib.Path, help="writes all figures there, too")
    parser.add_argument("--worker", metavar="VARIANT", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.rounds < 2:
        parser.error("--rounds must be at least 2: noise is what differs between them")
    return options


def repository():
    return pathlib.Path(__file__).resolve().parents[2]


# The virtual environment.

def enter_environment(folder):
    """Runs this script again by the Python of the environment, made first if need be."""
    python = folder / "bin/python"
    if pathlib.Path(sys.prefix).resolve() == folder.resolve():
        return
    if not python.exists():
        print(f"installing Mitsuba into {folder}", file=sys.stderr)
        venv.create(folder, with_pip=True)
        subprocess.run([python, "-m", "pip", "-q", "install", "mitsuba>=3.9", "numpy"], check=True)
    os.execv(python, [str(python), *sys.argv])


def find_llvm():
    """Versions 15 and 16 abort on some processors, so the system's default may not do."""
    for version in TESTED_LLVM:
        for path in glob.glob(f"/usr/lib/*/libLLVM*{version}*.so*"):
            return path
    return None


# The worker: renders in one variant of Mitsuba, told by lines of JSON.

class MitsubaWorker:
    def __init__(self, variant):
        import mitsuba
        self.mi = mitsuba
        mitsuba.set_variant(variant)
        mitsuba.set_log_level(mitsuba.LogLevel.Error)

    def load(self, scene, width, height, integrator, depth):
        mi = self.mi
        config = mi.parser.ParserConfig(mi.variant())
        config.unused_properties = mi.LogLevel.Debug  # old scenes hold what it does not know
        # Old scenes write <lookAt>, which Mitsuba 3 does not upgrade.
        text = pathlib.Path(scene).read_text().replace("lookAt", "lookat")
        defines = {"integrator": integrator} if 'name="integrator"' in text else {}
        mi.file_resolver().prepend(str(pathlib.Path(scene).resolve().parent))
        state = mi.parser.parse_string(config, text, **defines)
        mi.parser.transform_all(config, state)
        self.scene = mi.parser.instantiate(config, state)
        if isinstance(self.scene, list):
            self.scene = self.scene[0]
        parameters = mi.traverse(self.scene)
        size = next(key for key in parameters.keys() if key.endswith("film.size"))
        full = parameters[size]
        if width:
            parameters[size] = [width, height]
            parameters.update()
        self.integrator = mi.load_dict({"type": integrator, "max_depth": depth})
        return {"width": int(full[0]), "height": int(full[1])}

    def render(self, spp, seed, output):
        import numpy
        start = time.perf_counter()
        image = numpy.array(self.mi.render(self.scene, integrator=self.integrator, spp=spp,
                                           seed=seed))
        seconds = time.perf_counter() - start
        numpy.save(output, image[..., :3])
        return {"seconds": seconds}

    def serve(self):
        for line in sys.stdin:
            command = json.loads(line)
            try:
                answer = getattr(self, command.pop("do"))(**command)
            except Exception as error:  # of any kind: the scene is then left out
                answer = {"error": str(error).strip().splitlines()[0]}
            print("answer " + json.dumps(answer), flush=True)


class SceneFailure(Exception):
    """A renderer cannot render the scene."""


class Mitsuba:
    """One variant, in a process of its own."""

    def __init__(self, variant, integrator):
        self.integrator = integrator
        environment = dict(os.environ)
        if variant.startswith("llvm") and "DRJIT_LIBLLVM_PATH" not in environment:
            if not (path := find_llvm()):
                sys.exit("no usable libLLVM was found; install libllvm19, or set "
                         "DRJIT_LIBLLVM_PATH, or give --variants scalar_rgb")
            environment["DRJIT_LIBLLVM_PATH"] = path
        self.name = variant
        self.process = subprocess.Popen(
            [sys.executable, __file__, "none", "--worker", variant, "--venv", sys.prefix],
            env=environment, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL)

    def ask(self, **command):
        self.process.stdin.write(json.dumps(command) + "\n")
        self.process.stdin.flush()
        for line in self.process.stdout:
            if line.startswith("answer "):
                answer = json.loads(line[len("answer "):])
                if "error" in answer:
                    raise SceneFailure(f"Mitsuba: {answer['error']}")
                return answer
        sys.exit(f"Mitsuba's {self.name} ended; another libLLVM may help (DRJIT_LIBLLVM_PATH)")

    def load(self, scene, size, depth):
        return self.ask(do="load", scene=str(scene), width=size[0], height=size[1],
                        integrator=self.integrator, depth=depth)

    def render(self, spp, seed, folder):
        output = f"{folder}/{self.name}.npy"
        seconds = self.ask(do="render", spp=spp, seed=seed, output=output)["seconds"]
        import numpy
        return seconds, numpy.load(output).astype(float)


class Lucerna:
    name = "lucerna"

    def __init__(self, options):
        self.program = options.lucerna
        self.settings = options.set
        self.integrator = options.integrator

    def load(self, scene, size, depth):
        self.command = [self.program, "render", str(scene), "--json", "--quiet",
                        "--set", f"integrator.type={self.integrator}",
                        "--set", f"integrator.max_depth={depth}",
                        "--set", "sensor.film.component_format=float32",
                        "--resolution", f"{size[0]}x{size[1]}"]
        for setting in self.settings:
            self.command += ["--set", setting]

    def render(self, spp, seed, folder):
        output = f"{folder}/lucerna.exr"
        done = subprocess.run([*self.command, "--spp", str(spp), "--seed", str(seed), "-o", output],
                              capture_output=True, text=True)
        if done.returncode != 0:
            errors = [line for line in done.stderr.splitlines() if "error" in line]
            raise SceneFailure(f"Lucerna: {(errors or ['it failed'])[0]}")
        return find_number(json.loads(done.stdout), "render"), read_exr(output)


def find_number(figures, name):
    """The seconds of rendering, wherever the figures have them."""
    for key, value in figures.items():
        if isinstance(value, dict):
            if (found := find_number(value, name)) is not None:
                return found
        elif key in (name, f"{name}_seconds"):
            return value
    return None


def read_exr(path):
    import mitsuba
    import numpy
    if not mitsuba.variant():
        mitsuba.set_variant("scalar_rgb")
    bitmap = mitsuba.Bitmap(path).convert(mitsuba.Bitmap.PixelFormat.RGB,
                                          mitsuba.Struct.Type.Float32, False)
    return numpy.array(bitmap).astype(float)


# Measuring.

@dataclasses.dataclass
class Measurement:
    """All renders of one renderer at one sample count."""
    spp: int
    seconds: list
    images: list

    def samples_per_second(self):
        pixels = self.images[0].shape[0] * self.images[0].shape[1]
        return [pixels * self.spp / s for s in self.seconds]

    def relative_variances(self):
        """For each pixel: variance of one render over its squared mean."""
        import numpy
        images = numpy.array(self.images)
        mean = images.mean(axis=0)
        variance = images.var(axis=0, ddof=1)
        # The square of a noisy mean is too large by the variance of that mean.
        square = numpy.maximum(mean**2 - variance / len(images), 0)
        return (variance / (square + 0.01 * mean.mean() ** 2)).mean(axis=-1).ravel()

    def noise(self, trimmed):
        import numpy
        values = numpy.sort(self.relative_variances())
        return values[:len(values) - len(values) // 1000].mean() if trimmed else values.mean()

    def without(self, round_index):
        keep = [i for i in range(len(self.seconds)) if i != round_index]
        return Measurement(self.spp, [self.seconds[i] for i in keep],
                           [self.images[i] for i in keep])


def logarithmic_efficiency(m, trimmed):
    return -math.log(m.noise(trimmed) * sum(m.seconds) / len(m.seconds))


def ratio_with_interval(ours, theirs, logarithm):
    """exp of the difference, and its 95 % interval by the jackknife over rounds."""
    def difference(a, b):
        return logarithm(a) - logarithm(b)
    n = len(ours.seconds)
    value = difference(ours, theirs)
    if n < 3:
        return math.exp(value), float("nan"), float("nan")
    left = [difference(ours.without(i), theirs.without(i)) for i in range(n)]
    mean = sum(left) / n
    error = math.sqrt((n - 1) / n * sum((x - mean) ** 2 for x in left))
    quantile = {2: 4.30, 3: 3.18, 4: 2.78, 5: 2.57, 6: 2.45, 7: 2.36}.get(n - 1, 2.3)
    return tuple(math.exp(value + k * quantile * error) for k in (0, -1, 1))


def disagreement(ours, theirs):
    """Relative difference of the means, and the share of blocks that differ beyond noise."""
    import numpy
    def blocks(image):
        side, (height, width) = 16, image.shape[:2]
        cut = image[:height // side * side, :width // side * side].mean(axis=-1)
        return cut.reshape(height // side, side, width // side, side).mean(axis=(1, 3))
    a = numpy.array([blocks(i) for i in ours.images])
    b = numpy.array([blocks(i) for i in theirs.images])
    variance = a.var(axis=0, ddof=1) / len(a) + b.var(axis=0, ddof=1) / len(b)
    # Blocks in one row of the scale of their means share a variance: few rounds tell it badly.
    floor = numpy.median(variance)
    differs = abs(a.mean(axis=0) - b.mean(axis=0)) > 4 * numpy.sqrt(numpy.maximum(variance, floor))
    return a.mean() / b.mean() - 1, differs.mean()


def samples_for(renderer, seconds, folder):
    """The power of two whose render lasts about as long."""
    spp = 4
    renderer.render(spp, 0, folder)
    taken = renderer.render(spp, 1, folder)[0]
    return 2 ** max(2, round(math.log2(spp * seconds / max(taken, 1e-3))))


def measure(renderers, options, folder):
    counts = [samples_for(r, options.seconds, folder) for r in renderers]
    measurements = [Measurement(spp, [], []) for spp in counts]
    for renderer, m in zip(renderers, measurements):
        renderer.render(m.spp, 2, folder)  # compiles for this count
    for index in range(options.rounds):
        order = list(zip(renderers, measurements))
        for renderer, m in order if index % 2 == 0 else reversed(order):
            seconds, image = renderer.render(m.spp, 100 + index, folder)
            m.seconds.append(seconds)
            m.images.append(image)
    return measurements


# Scenes and tables.

def scene_files(names):
    for name in names:
        path, _, size = name.partition("@")
        path = pathlib.Path(path)
        size = tuple(int(x) for x in size.split("x")) if size else None
        if path.is_file():
            yield path, size
        else:
            found = sorted(path.glob("*.xml")) or sorted(path.glob("*/*.xml"))
            if not found:
                sys.exit(f"{path}: there is no scene")
            for file in found:
                yield file, size


def compare_scene(path, size, lucerna, mitsubas, options, folder):
    full = mitsubas[0].load(path, (0, 0), options.depth)
    if not size:
        scale = math.sqrt(options.pixels / (full["width"] * full["height"]))
        size = (round(full["width"] * scale), round(full["height"] * scale))
    for renderer in [lucerna, *mitsubas]:
        renderer.load(path, size, options.depth)
    ours, *others = measure([lucerna, *mitsubas], options, folder)
    rows = []
    for mitsuba, theirs in zip(mitsubas, others):
        speed = (math.exp(sum(math.log(x) for x in ours.samples_per_second()) / options.rounds) /
                 math.exp(sum(math.log(x) for x in theirs.samples_per_second()) / options.rounds))
        brightness, blocks = disagreement(ours, theirs)
        rows.append({
            "scene": f"{path.parent.name}/{path.stem} {size[0]}×{size[1]}",
            "variant": mitsuba.name,
            "spp": [ours.spp, theirs.spp],
            "speed": speed,
            "variance": ours.noise(False) * ours.spp / (theirs.noise(False) * theirs.spp),
            "efficiency": ratio_with_interval(
                ours, theirs, lambda m: logarithmic_efficiency(m, False)),
            "trimmed": ratio_with_interval(
                ours, theirs, lambda m: logarithmic_efficiency(m, True)),
            "brightness": brightness, "blocks": blocks})
    return rows


def table_row(row):
    def with_interval(values):
        return "{:.2f} [{:.2f}, {:.2f}]".format(*values)
    return (f"| {row['scene']} | {row['variant']} | {row['spp'][0]} / {row['spp'][1]} | "
            f"{row['speed']:.2f} | {row['variance']:.2f} | {with_interval(row['efficiency'])} | "
            f"{with_interval(row['trimmed'])} | {100 * row['brightness']:+.2f} % | "
            f"{100 * row['blocks']:.1f} % |")


def main():
    options = arguments()
    enter_environment(options.venv)
    if options.worker:
        return MitsubaWorker(options.worker).serve()
    lucerna = Lucerna(options)
    mitsubas = [Mitsuba(variant, options.integrator) for variant in options.variants.split(",")]
    print("Lucerna over Mitsuba:\n")
    print("| scene | variant | spp | samples/s | variance per sample | efficiency | trimmed "
          "| mean | blocks |\n|---|---|---|---|---|---|---|---|---|", flush=True)
    rows = []
    for path, size in scene_files(options.scenes):
        with tempfile.TemporaryDirectory() as folder:
            try:
                rows += compare_scene(path, size, lucerna, mitsubas, options, folder)
            except SceneFailure as failure:
                print(f"| {path.parent.name}/{path.stem} | {failure} |", flush=True)
                continue
        for row in rows[-len(mitsubas):]:
            print(table_row(row), flush=True)
    for mitsuba in mitsubas:
        for what in ("efficiency", "trimmed"):
            values = [math.log(r[what][0]) for r in rows if r["variant"] == mitsuba.name]
            if values:
                print(f"\ngeometric mean of {what} over {mitsuba.name}: "
                      f"{math.exp(sum(values) / len(values)):.2f}")
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
