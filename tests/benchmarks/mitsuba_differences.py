#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The numbers of docs/coming_from_mitsuba.md: small scenes, rendered by Mitsuba 3 and by Lucerna.

    PYTHON tests/benchmarks/mitsuba_differences.py [--lucerna PROGRAM] [NAME]…

PYTHON has the packages mitsuba (3.9.1), numpy and OpenEXR. For each name, lines with the numbers of
Mitsuba (scalar_rgb), and those of Lucerna; without names, all of them. Seeds are fixed.
"""
import argparse
import os
import struct
import subprocess
import tempfile
import zlib

import mitsuba as mi
import numpy
import OpenEXR

ROWS = {}


def row(function):
    """Registers a function that prints the numbers of one row, or of some, of the page."""
    ROWS[function.__name__] = function
    return function


def number(name, value):
    kind = "integer" if isinstance(value, int) else "float"
    return f'<{kind} name="{name}" value="{value}"/>'


def word(name, value):
    return f'<string name="{name}" value="{value}"/>'


def rgb(name, *values):
    return f'<rgb name="{name}" value="{", ".join(map(str, values))}"/>'


def bsdf(kind, inside=""):
    return f'<bsdf type="{kind}">{inside}</bsdf>'


def shape(kind, inside, to_world=""):
    return f'<shape type="{kind}"><transform name="to_world">{to_world}</transform>{inside}</shape>'


def constant(value=1):
    return f'<emitter type="constant">{rgb("radiance", value, value, value)}</emitter>'


def area(value=1):
    return bsdf("diffuse", rgb("reflectance", 0, 0, 0)) + \
        f'<emitter type="area">{rgb("radiance", value, value, value)}</emitter>'


def scene(content, integrator="path", inside="", camera="", side=32, half=0.5):
    """An orthographic view of 2 · half [m] from z = 5 downwards, or another camera."""
    if not camera:
        camera = ('<sensor type="orthographic"><transform name="to_world">'
                  f'<scale x="{half}" y="{half}"/>'
                  '<lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/></transform>')
    return (f'<scene version="3.0.0"><integrator type="{integrator}">{inside}</integrator>{camera}'
            f'<film type="hdrfilm">{number("width", side)}{number("height", side)}'
            f'{word("component_format", "float32")}<rfilter type="box"/></film></sensor>'
            f'{content}</scene>')


def look(origin, target, fov, up="0, 0, 1"):
    return (f'<sensor type="perspective">{number("fov", float(fov))}<transform name="to_world">'
            f'<lookat origin="{origin}" target="{target}" up="{up}"/></transform>')


class Programs:
    """Renders with both, in a folder that holds the files of the scenes."""

    def __init__(self, lucerna):
        self.lucerna = os.path.abspath(lucerna)

    def means(self, text, spp):
        """The mean colour of the picture, of Mitsuba and of Lucerna."""
        with open("scene.xml", "w", encoding="utf-8") as file:
            file.write(text)
        loaded = mi.load_file("scene.xml")
        theirs = numpy.array(mi.render(loaded, spp=spp, seed=1), dtype=float)
        ran = subprocess.run([self.lucerna, "render", "scene.xml", "--quiet", "--spp", str(spp),
                              "-o", "ours.exr"], capture_output=True, text=True)
        if ran.returncode != 0:
            raise SystemExit(ran.stderr)
        with OpenEXR.File("ours.exr") as file:
            channels = file.channels()
            name = next(n for n in ("RGBA", "RGB") if n in channels)
            ours = numpy.asarray(channels[name].pixels[..., :3], dtype=float)
        theirs = theirs.reshape(theirs.shape[0], theirs.shape[1], -1)[..., :3]
        return [picture.mean(axis=(0, 1)) for picture in (theirs, ours)]


def say(name, what, pair, digits=3):
    def text(value):
        return ", ".join(f"{v:.{digits}f}" for v in numpy.atleast_1d(value))
    print(f"{name}: {what}: Mitsuba {text(pair[0])}; Lucerna {text(pair[1])}", flush=True)


@row
def roughplastic(programs, name):
    for kind, alpha in [("roughplastic", a) for a in (0.1, 0.3, 0.5, 1.0)] + [("plastic", 0)]:
        inside = rgb("diffuse_reflectance", 1, 1, 1) + (number("alpha", alpha) if alpha else "")
        wall = shape("rectangle", bsdf(kind, inside))
        pair = programs.means(scene(wall + constant(), inside=number("max_depth", 64)), 1024)
        say(name, f"{kind} {alpha or ''}, white furnace", [p.mean() for p in pair], 2)


@row
def principledthin(programs, name):
    inside = (rgb("base_color", 0.7, 0.7, 0.7) + number("roughness", 0.5) +
              number("spec_trans", 1.0))
    ball = shape("sphere", f'<bsdf type="principledthin">{inside}</bsdf>')
    pair = programs.means(scene(ball + constant(), half=1.25), 4096)
    say(name, "a clear sphere in a white furnace, mean of the picture",
        [p.mean() for p in pair], 4)


@row
def sggx(programs, name):
    # Flakes that are turned about x and about z.
    turn_x, turn_z = 0.6, 0.9
    x = numpy.array([[1, 0, 0], [0, numpy.cos(turn_x), -numpy.sin(turn_x)],
                     [0, numpy.sin(turn_x), numpy.cos(turn_x)]])
    z = numpy.array([[numpy.cos(turn_z), -numpy.sin(turn_z), 0],
                     [numpy.sin(turn_z), numpy.cos(turn_z), 0], [0, 0, 1]])
    s = z @ x @ numpy.diag([0.03, 0.17, 0.28]) @ x.T @ z.T
    six = [s[0, 0], s[1, 1], s[2, 2], s[0, 1], s[0, 2], s[1, 2]]
    with open("s.vol", "wb") as file:
        file.write(b"VOL\x03" + struct.pack("<5i6f", 1, 2, 2, 2, 6, 0, 0, 0, 1, 1, 1) +
                   struct.pack("<6f", *six) * 8)
    place = ('<transform name="to_world"><translate x="-0.5" y="-0.5" z="-0.5"/>'
             '<scale value="2"/></transform>')
    medium = ('<medium type="heterogeneous" name="interior"><volume type="constvolume" '
              'name="sigma_t">' + number("value", 20.0) + '</volume>' + number("albedo", 1.0) +
              '<phase type="sggx"><volume type="gridvolume" name="S">' + word("filename", "s.vol") +
              place + '</volume></phase></medium>')
    ball = shape("sphere", bsdf("null") + medium)
    pair = programs.means(scene(ball + constant(), "volpath", number("max_depth", 256)), 256)
    say(name, "a ball that absorbs nothing, white furnace", [p.mean() for p in pair], 2)
    light = ('<emitter type="point"><point name="position" x="2" y="1" z="2"/>' +
             rgb("intensity", 1, 1, 1) + '</emitter>')
    pair = programs.means(scene(ball + light, "volpath", number("max_depth", 2)), 1024)
    say(name, "scattered once, from a point light", [p.mean() for p in pair], 5)


@row
def direct(programs, name):
    light = ('<emitter type="point"><point name="position" x="0" y="0" z="2"/>' +
             rgb("intensity", 1, 1, 1) + '</emitter>')
    for count in (1, 4):
        text = scene(shape("rectangle", bsdf("diffuse")) + light, "direct",
                     number("emitter_samples", count) + number("bsdf_samples", 0))
        say(name, f"a wall under a point light, {count} emitter_samples",
            [p.mean() for p in programs.means(text, 16)], 4)


@row
def depth(programs, name):
    camera = look("0, 0, 3", "0, 0, 0", 1, "0, 1, 0").replace(
        "<transform", number("near_clip", 1.0) + "<transform", 1)
    pair = programs.means(scene(shape("rectangle", ""), "depth", camera=camera, side=8), 16)
    say(name, "a wall at 3, near_clip 1", [p[0] for p in pair], 1)


@row
def concave(programs, name):
    with open("l.obj", "w", encoding="utf-8") as file:
        for x, y in [(2, 0), (2, 1), (0.5, 1), (0.5, 2), (0, 2), (0, 0)]:
            file.write(f"v {x} {y} 0\n")
        file.write("f 1 2 3 4 5 6\n")
    inside = word("filename", "l.obj") + area()
    wall = shape("obj", inside, '<translate x="-1" y="-1"/>')
    loaded = mi.load_string(scene(wall))
    say(name, "an L of area 2.5: Mitsuba's surface area; Lucerna's in the picture",
        [loaded.shapes()[0].surface_area(),
         4 * programs.means(scene(wall, half=1), 256)[1].mean()], 2)


@row
def rotate(programs, name):
    wall = shape("rectangle", area(), '<rotate x="2" angle="90"/><rotate x="1" angle="-90"/>')
    pair = programs.means(scene(wall, half=8, side=64), 64)
    say(name, "area of a square of 4, turned about (2, 0, 0) by 90 degrees and back",
        [256 * p.mean() for p in pair], 1)


@row
def mirrored(programs, name):
    pair = programs.means(scene(shape("sphere", area(), '<scale x="-1"/>')), 16)
    say(name, "a sphere that emits 1", [p.mean() for p in pair], 2)
    with open("wall.obj", "w", encoding="utf-8") as file:
        file.write("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n")
    mesh = shape("obj", word("filename", "wall.obj") + area(), '<scale x="-1"/>')
    pair = programs.means(scene(mesh), 16)
    say(name, "a mesh without normals that emits 1", [p.mean() for p in pair], 2)


def write_exr(path, array, **header):
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **header}
    OpenEXR.File(header, {"RGB": numpy.ascontiguousarray(array, dtype="float32")}).write(path)


def envmap(path, inside="", to_world=""):
    return (f'<emitter type="envmap">{word("filename", path)}{inside}'
            f'<transform name="to_world">{to_world}</transform></emitter>')


@row
def band(programs, name):
    for rows in (16, 256):
        picture = numpy.zeros((rows, 2 * rows, 3))
        picture[rows // 2 - 1:rows // 2 + 1] = 1
        write_exr("band.exr", picture)
        ball = shape("sphere", bsdf("diffuse", rgb("reflectance", 1, 1, 1)))
        light = envmap("band.exr")
        pair = programs.means(scene(ball + light, "direct", half=0.7), 1024)
        say(name, f"a ball under a bright band at the horizon of {rows} rows, per cent more",
            [100 * (pair[0].mean() / pair[1].mean() - 1), 0], 2)


@row
def scaled_map(programs, name):
    write_exr("noise.exr", numpy.random.default_rng(1).random((8, 16, 3))**4)
    ball = shape("sphere", bsdf("diffuse"))
    pair = [programs.means(scene(ball + envmap("noise.exr", "", to_world), half=0.7), 1024)
            for to_world in ("", '<scale value="5"/>')]
    say(name, "a ball under random texels, scaled by 5, per cent brighter",
        [100 * (b.mean() / a.mean() - 1) for a, b in zip(*pair)], 1)


@row
def picture_of_light(programs, name):
    write_exr("texels.exr", numpy.random.default_rng(3).random((8, 8, 3))**4)
    picture = ('<emitter type="area"><texture type="bitmap" name="radiance">' +
               word("filename", "texels.exr") +
               '</texture></emitter>')
    black = bsdf("diffuse", rgb("reflectance", 0, 0, 0))
    cube = shape("cube", black + picture, '<scale value="0.3"/><translate z="1"/>')
    floor = shape("rectangle", bsdf("diffuse"), '<scale value="4"/>')
    camera = look("0, 3, 1.5", "0, 0, 0", 15)
    result = []
    for lights, chance in ((1, 0), (0, 1)):
        inside = number("emitter_samples", lights) + number("bsdf_samples", chance)
        result.append(programs.means(scene(cube + floor, "direct", inside, camera), 4096))
    say(name, "the floor under a cube with a picture, light samples over chance",
        [result[0][i].mean() / result[1][i].mean() for i in (0, 1)], 3)


@row
def opacity(programs, name):
    inside = rgb("opacity", 0.2, 0.5, 0.9) + bsdf("diffuse", rgb("reflectance", 0, 0, 0))
    wall = shape("rectangle", bsdf("mask", inside))
    pair = programs.means(scene(wall + constant()), 4096)
    say(name, "opacity (0.2, 0.5, 0.9)", [1 - p.mean() for p in pair], 2)


@row
def bumped_null(programs, name):
    # The normal leans by 40 degrees towards +x.
    angle = numpy.radians(40)
    normal = numpy.array([numpy.sin(angle), 0, numpy.cos(angle)])
    write_exr("normal.exr", numpy.tile(normal * 0.5 + 0.5, (4, 4, 1)))
    bumps = ('<bsdf type="normalmap"><texture type="bitmap" name="normalmap">' +
             word("filename", "normal.exr") + '<boolean name="raw" value="true"/></texture>' +
             bsdf("null") + '</bsdf>')
    camera = look("2.5, 0, 4.33", "0, 0, 0", 5, "0, 1, 0")
    pair = programs.means(scene(shape("rectangle", bumps) + constant(), camera=camera), 256)
    say(name, "what lies behind, seen from 30 degrees", [p.mean() for p in pair], 4)


@row
def gamma(programs, name):
    def chunk(kind, data):
        return (struct.pack(">I", len(data)) + kind + data +
                struct.pack(">I", zlib.crc32(kind + data)))
    with open("grey.png", "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" +
                   chunk(b"IHDR", struct.pack(">2I5B", 1, 1, 8, 0, 0, 0, 0)) +
                   chunk(b"gAMA", struct.pack(">I", 100000)) +
                   chunk(b"IDAT", zlib.compress(b"\0\x80")) + chunk(b"IEND", b""))
    wall = shape("rectangle", bsdf("diffuse", '<texture type="bitmap" name="reflectance">' +
                                   word("filename", "grey.png") + '</texture>'))
    pair = programs.means(scene(wall + constant()), 256)
    say(name, "a linear grey of 0.5 in a PNG", [p.mean() for p in pair], 2)


@row
def primaries(programs, name):
    acescg = ((0.713, 0.293), (0.165, 0.830), (0.128, 0.044), (0.32168, 0.33767))
    write_exr("acescg.exr", numpy.full((2, 4, 3), (0.8, 0.2, 0.1)),
              chromaticities=tuple(v for xy in acescg for v in xy))
    pair = programs.means(scene(envmap("acescg.exr")), 16)
    say(name, "(0.8, 0.2, 0.1) of ACEScg", pair)


@row
def spectrum(programs, name):
    light = '<emitter type="constant"><spectrum name="radiance" value="1"/></emitter>'
    say(name, "an emitter of one number", programs.means(scene(light), 16))


def sunsky(elevation, inside):
    up, along = numpy.sin(numpy.radians(elevation)), numpy.cos(numpy.radians(elevation))
    return ('<emitter type="sunsky">' + inside +
            f'<vector name="sun_direction" x="{along}" y="0" z="{up}"/></emitter>')


@row
def sky(programs, name):
    camera = look("0, 0, 0", "0, 0, 1", 120, "0, 1, 0")
    for elevation in (5, 30, 60):
        light = sunsky(elevation, number("sun_scale", 0.0))
        pair = programs.means(scene(light, camera=camera), 64)
        say(name, f"the sky above, sun at {elevation} degrees, Lucerna / Mitsuba",
            [pair[1] * 0 + 1, pair[1] / pair[0]], 4)
        floor = shape("rectangle", bsdf("diffuse"))
        light = sunsky(elevation, number("sky_scale", 0.0))
        pair = programs.means(scene(floor + light), 1024)
        say(name, f"a floor in the sun at {elevation} degrees, Lucerna / Mitsuba",
            [pair[1] * 0 + 1, pair[1] / pair[0]], 4)


def ball_in_furnace(inside):
    return shape("sphere", inside) + constant()


@row
def blendbsdf(programs, name):
    for rough in ("roughplastic", "diffuse"):
        colour = "diffuse_reflectance" if rough == "roughplastic" else "reflectance"
        inside = rgb(colour, 0.5, 0.5, 0.5)
        parts = [bsdf("conductor"), bsdf(rough, inside)]
        both = [programs.means(scene(ball_in_furnace(b), half=0.7), 1024) for b in parts]
        mixed = programs.means(
            scene(ball_in_furnace(f'<bsdf type="blendbsdf">{number("weight", 0.5)}'
                                  f'{"".join(parts)}</bsdf>'), half=0.7), 1024)
        share = [mixed[i].mean() / (0.5 * (both[0][i] + both[1][i])).mean() for i in (0, 1)]
        say(name, f"half conductor, half {rough}, over the mean of both", share)


@row
def checkerboard(programs, name):
    board = (f'<texture type="checkerboard" name="NAME">{rgb("color0", 1, 1, 1)}'
             f'{rgb("color1", 0, 0, 0)}<transform name="to_uv"><scale x="0.5" y="0.5"/>'
             '</transform></texture>')  # the first square alone
    white, black = (bsdf("diffuse", rgb("reflectance", v, v, v)) for v in (1, 0))
    wall = shape("rectangle", bsdf("diffuse", board.replace("NAME", "reflectance")))
    say(name, "as reflectance", programs.means(scene(wall + constant()), 64))
    blend = bsdf("blendbsdf", board.replace("NAME", "weight") + black + white)
    wall = shape("rectangle", blend)
    say(name, "as weight of white", programs.means(scene(wall + constant()), 64))


@row
def volpath(programs, name):
    medium = (f'<medium type="homogeneous" name="interior">{rgb("sigma_t", 1, 0.2, 1)}'
              f'{number("scale", 10.0)}{rgb("albedo", 0.5, 0.5, 0.5)}</medium>')
    content = shape("sphere", bsdf("null") + medium) + constant()
    for kind in ("volpath", "volpathmis"):
        pair = programs.means(scene(content, kind, number("max_depth", 64), half=0.7), 512)
        say(name, kind, pair)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(ROWS))
    parser.add_argument("--lucerna", default="./lucerna")
    arguments = parser.parse_args()
    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    programs = Programs(arguments.lucerna)
    unknown = [name for name in arguments.names if name not in ROWS]
    if unknown:
        parser.error(f"there is no {unknown[0]}; there are: {', '.join(ROWS)}")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name in arguments.names or ROWS:
            ROWS[name](programs, name)


if __name__ == "__main__":
    main()
