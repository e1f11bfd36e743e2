#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes street.xml: houses with lit windows, and lamps, along z. Metres, y up."""
import random
from pathlib import Path

lines = []
dice = random.Random(11)
lights = 0


def put(text):
    lines.append("    " + text)


def emission(radiance):
    global lights
    lights += 1
    values = ", ".join(f"{x:.4g}" for x in radiance)
    return ('<ref id="black"/><emitter type="area">'
            f'<rgb name="radiance" value="{values}"/></emitter>')


def box(low, high, bsdf):
    middle = [0.5 * (a + b) for a, b in zip(low, high)]
    half = [0.5 * (b - a) for a, b in zip(low, high)]
    put('<shape type="cube"><transform name="to_world">'
        f'<scale x="{half[0]:.4g}" y="{half[1]:.4g}" z="{half[2]:.4g}"/>'
        f'<translate x="{middle[0]:.4g}" y="{middle[1]:.4g}" z="{middle[2]:.4g}"/>'
        f'</transform><ref id="{bsdf}"/></shape>')


def window(x, y, z, side):
    """A lit one, a little in front of the wall; `side` -1: left of the street, facing right."""
    warmth = dice.uniform(0.45, 0.8)
    power = dice.choice((0.5, 1, 1, 2))
    put('<shape type="rectangle"><transform name="to_world">'
        f'<scale x="0.45" y="0.7"/><rotate y="1" angle="{-90 * side}"/>'
        f'<translate x="{x - 0.02 * side:.4g}" y="{y:.4g}" z="{z:.4g}"/></transform>'
        f'{emission((power, warmth * power, 0.6 * warmth * warmth * power))}</shape>')


def lamp(x, z, side):
    """A bulb that hangs over the street from an arm."""
    put(f'<shape type="cylinder"><point name="p0" x="{x}" y="0" z="{z}"/>'
        f'<point name="p1" x="{x}" y="5" z="{z}"/><float name="radius" value="0.06"/>'
        '<ref id="iron"/></shape>')
    bulb = x - 0.9 * side
    put(f'<shape type="cylinder"><point name="p0" x="{x}" y="5" z="{z}"/>'
        f'<point name="p1" x="{bulb}" y="5" z="{z}"/><float name="radius" value="0.04"/>'
        '<ref id="iron"/></shape>')
    put(f'<shape type="sphere"><point name="center" x="{bulb}" y="4.7" z="{z}"/>'
        f'<float name="radius" value="0.16"/>{emission((260, 150, 62))}</shape>')


def houses(side):
    z = -8.0
    while z < 110:
        width, height = dice.uniform(6, 10), dice.uniform(8, 15)
        front = side * dice.uniform(5.6, 6.2)
        low, high = sorted((front, side * 14))
        box((low, 0, z), (high, height, z + width), dice.choice(("plaster", "brick", "stone")))
        columns, floors = int(width / 1.9), int((height - 1) / 2.8)
        for i in range(columns):
            for j in range(floors):
                if dice.random() < 0.3:
                    window(front, 1.9 + 2.8 * j, z + (i + 0.5) * width / columns, side)
        z += width + (0 if dice.random() < 0.7 else 2.5)


for side in (-1, 1):
    houses(side)
for k in range(14):
    side = -1 if k % 2 == 0 else 1
    lamp(side * 4.2, 5 + 7.5 * k, side)
for side in (-1, 1):
    low, high = sorted((side * 4, side * 14))
    box((low, -1, -20), (high, 0.12, 130), "stone")

header = ('<?xml version="1.0" encoding="utf-8"?>\n'
          f'<!-- Written by make_scene.py: {lights} lights. -->\n<scene version="3.0.0">\n')
(Path(__file__).parent / "street.xml").write_text(header + "\n".join(lines) + "\n</scene>\n")
print(lights, "lights")
