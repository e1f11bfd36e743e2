#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Lucerna against Mitsuba 3 in participating media: `volpath` of both, by against_mitsuba.py.

Writes three scenes that both can read into a folder, and measures them there:

    fog_room   homogeneous fog in a closed room with a lamp, a matte and a rough metal ball
    smoke      scenes/smoke, its grid as floats
    fog_city   towers in fog with 5,000 lit windows and lamps, each a light of its own

All other options are those of against_mitsuba.py.
"""
import argparse
import pathlib
import random
import struct
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

SENSOR = """<scene version="3.0.0">
    <integrator type="volpath"/>
    <sensor type="perspective">
        <medium type="homogeneous">
            <float name="sigma_t" value="{sigma_t}"/>
            <rgb name="albedo" value="0.9, 0.9, 0.92"/>
            <phase type="hg"><float name="g" value="0.5"/></phase>
        </medium>
        <float name="fov" value="{fov}"/>
        <transform name="to_world"><lookat {view} up="0, 1, 0"/></transform>
        <sampler type="independent"><integer name="sample_count" value="64"/></sampler>
        <film type="hdrfilm">
            <integer name="width" value="{width}"/><integer name="height" value="{height}"/>
        </film>
    </sensor>
    <bsdf type="diffuse" id="wall"><rgb name="reflectance" value="0.6, 0.55, 0.5"/></bsdf>
    <bsdf type="diffuse" id="black"><rgb name="reflectance" value="0"/></bsdf>
"""


def box(middle, half, inside):
    return (f'<shape type="cube"><transform name="to_world"><scale x="{half[0]:.4g}" '
            f'y="{half[1]:.4g}" z="{half[2]:.4g}"/><translate x="{middle[0]:.4g}" '
            f'y="{middle[1]:.4g}" z="{middle[2]:.4g}"/></transform>{inside}</shape>\n')


def ball(middle, radius, inside):
    x, y, z = middle
    return (f'<shape type="sphere"><point name="center" x="{x}" y="{y}" z="{z}"/>'
            f'<float name="radius" value="{radius}"/>{inside}</shape>\n')


def lamp(size, steps, radiance):
    color = ", ".join(f"{x:.4g}" for x in radiance)
    return (f'<shape type="rectangle"><transform name="to_world"><scale x="{size[0]}" '
            f'y="{size[1]}"/>{steps}</transform><ref id="black"/><emitter type="area">'
            f'<rgb name="radiance" value="{color}"/></emitter></shape>\n')


def fog_room():
    view = 'origin="0, 0.2, 3.6" target="0, -0.1, 0"'
    text = SENSOR.format(sigma_t=0.15, fov=50, view=view, width=320, height=240)
    text += box((0, 0, 0), (3, 2, 4), '<boolean name="flip_normals" value="true"/><ref id="wall"/>')
    text += ball((-0.9, -1.2, 0), 0.8, '<ref id="wall"/>')
    text += ball((1, -1.3, 0.4), 0.7,
                 '<bsdf type="roughconductor"><float name="alpha" value="0.2"/></bsdf>')
    text += lamp((0.5, 0.5), '<rotate x="1" angle="90"/><translate y="1.98"/>', (20, 17, 14))
    return text + "</scene>\n"


def fog_city(lights):
    view = 'origin="0, 45, -130" target="0, 8, 0"'
    text = SENSOR.format(sigma_t=0.008, fov=40, view=view, width=320, height=200)
    text += ('<shape type="rectangle"><transform name="to_world"><scale value="400"/>'
             '<rotate x="1" angle="-90"/></transform><ref id="wall"/></shape>\n')
    dice = random.Random(5)
    towers = [(12.0 * (i % 15 - 7), dice.uniform(6, 30), 12.0 * (i // 15 - 7)) for i in range(225)]
    for x, height, z in towers:
        text += box((x, height / 2, z), (4, height / 2, 4), '<ref id="wall"/>')
    for _ in range(lights):
        x, height, z = dice.choice(towers)
        side = dice.randrange(4)
        along, up = dice.uniform(-3.5, 3.5), dice.uniform(1, height - 0.7)
        power = dice.choice((1, 2, 4, 12)) * dice.uniform(0.5, 1)
        warmth = dice.uniform(0.5, 0.9)
        text += lamp((0.35, 0.5), f'<translate x="{along:.4g}" z="4.02"/>'
                     f'<rotate y="1" angle="{90 * side}"/>'
                     f'<translate x="{x:.4g}" y="{up:.4g}" z="{z:.4g}"/>',
                     (power, warmth * power, warmth * warmth * power))
    return text + "</scene>\n"


def smoke(folder):
    scene, grid = ROOT / "scenes/smoke/scene.xml", ROOT / "scenes/smoke/smoke.vol"
    header, voxels = grid.read_bytes()[:48], grid.read_bytes()[48:]
    (folder / "smoke_float.vol").write_bytes(
        header[:4] + struct.pack("<i", 1) + header[8:] +
        struct.pack(f"<{len(voxels)}f", *(v / 255 for v in voxels)))
    return (scene.read_text().replace("smoke.vol", "smoke_float.vol")
            .replace('type="sobol"', 'type="independent"'))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("media_scenes"))
    parser.add_argument("--lights", type=int, default=5000, help="of the city")
    options, others = parser.parse_known_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    for name, text in (("fog_room", fog_room()), ("smoke", smoke(options.folder)),
                       ("fog_city", fog_city(options.lights))):
        (options.folder / f"{name}.xml").write_text(text)
    return subprocess.run([sys.executable, ROOT / "tests/benchmarks/against_mitsuba.py",
                           "--integrator", "volpath", *others,
                           f"{options.folder}/fog_room.xml@240x180",
                           f"{options.folder}/smoke.xml@200x280",
                           f"{options.folder}/fog_city.xml@240x150"]).returncode


if __name__ == "__main__":
    sys.exit(main())
