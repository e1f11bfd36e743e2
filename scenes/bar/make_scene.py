#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes things.xml: the rooms, the furniture and the lights of the bar. Metres, y up."""
import math
import random
from pathlib import Path

lines = []
dice = random.Random(4)
lights = 0


def put(text):
    lines.append("    " + text)


def surface(bsdf, radiance=None):
    if radiance is None:
        return f'<ref id="{bsdf}"/>'
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
        f"</transform>{surface(bsdf)}</shape>")


def sphere(center, radius, bsdf, radiance=None):
    x, y, z = center
    put(f'<shape type="sphere"><point name="center" x="{x:.4g}" y="{y:.4g}" z="{z:.4g}"/>'
        f'<float name="radius" value="{radius}"/>{surface(bsdf, radiance)}</shape>')


def cylinder(a, b, radius, bsdf, radiance=None):
    ends = "".join(f'<point name="{name}" x="{p[0]:.4g}" y="{p[1]:.4g}" z="{p[2]:.4g}"/>'
                   for name, p in (("p0", a), ("p1", b)))
    put(f'<shape type="cylinder">{ends}<float name="radius" value="{radius}"/>'
        f"{surface(bsdf, radiance)}</shape>")


def disk(center, radius, bsdf, up=True):
    x, y, z = center
    put('<shape type="disk"><transform name="to_world">'
        f'<scale value="{radius}"/><rotate x="1" angle="{-90 if up else 90}"/>'
        f'<translate x="{x:.4g}" y="{y:.4g}" z="{z:.4g}"/></transform>{surface(bsdf)}</shape>')


def drum(center, radius, height, bsdf):
    x, y, z = center
    cylinder((x, y, z), (x, y + height, z), radius, bsdf)
    disk((x, y + height, z), radius, bsdf)


def rooms():
    """One hall of 30 m x 24 m, divided by walls; the bar is in its middle."""
    box((-15, -0.2, -12), (15, 0, 12), "floor")
    box((-15, 3.2, -12), (15, 3.4, 12), "ceiling")
    for x in (-15.2, 15):
        box((x, 0, -12), (x + 0.2, 3.2, 12), "plaster")
    for z in (-12.2, 12):
        box((-15, 0, z), (15, 3.2, z + 0.2), "plaster")
    box((-15, 0, -4.2), (15, 3.2, -4), "brick")  # behind the bottles
    box((-15, 0, 4.6), (15, 3.2, 4.8), "plaster")  # behind the viewer
    # Walls to the left and right, with a door each.
    for x, door in ((-5.2, (0.2, 1.4)), (5, (-3.2, -2))):
        box((x, 0, -4), (x + 0.2, 3.2, door[0]), "brick" if x < 0 else "plaster")
        box((x, 0, door[1]), (x + 0.2, 3.2, 4.6), "brick" if x < 0 else "plaster")
        box((x, 2.15, door[0]), (x + 0.2, 3.2, door[1]), "brick" if x < 0 else "plaster")


def counter():
    box((-4.2, 0, -2.6), (1.9, 1.05, -2.05), "wood")
    box((-4.3, 1.05, -2.7), (2.0, 1.1, -1.9), "lacquer")
    box((1.35, 0, -4), (1.9, 1.05, -2.6), "wood")
    box((1.25, 1.05, -4), (2.0, 1.1, -2.7), "lacquer")
    for i in range(13):  # panels
        x = -4.1 + 0.46 * i
        box((x, 0.18, -2.05), (x + 0.36, 0.92, -2.02), "wood")
    cylinder((-4.2, 0.22, -1.85), (1.9, 0.22, -1.85), 0.025, "chrome")
    for i in range(7):  # stools
        x = -3.7 + 0.85 * i
        z = -1.35 + 0.08 * dice.uniform(-1, 1)
        drum((x, 0.72, z), 0.19, 0.07, "leather")
        cylinder((x, 0, z), (x, 0.72, z), 0.025, "chrome")
        drum((x, 0, z), 0.2, 0.015, "chrome")
    for i in range(3):  # taps
        x = -1.2 + 0.14 * i
        cylinder((x, 1.1, -2.45), (x, 1.42, -2.45), 0.02, "chrome")
        sphere((x, 1.45, -2.45), 0.032, ("red", "ivory", "green")[i])
    for x in (-3.5, -2.4, -0.2, 0.9):  # tumblers
        sphere((x, 1.16, -2.15), 0.055, "glass")


def bottles():
    for shelf in range(3):
        y = 1.15 + 0.5 * shelf
        box((-4.1, y - 0.03, -3.98), (1.1, y, -3.62), "lacquer")
        # A strip of light under the shelf's back edge.
        for k in range(4):
            x = -4 + 1.28 * k
            put('<shape type="rectangle"><transform name="to_world">'
                f'<scale x="0.6" y="0.012"/><translate x="{x + 0.6:.4g}" y="{y + 0.03:.4g}" '
                f'z="-3.96"/></transform>{surface("black", (80, 38, 12))}</shape>')
        x = -3.95
        while x < 1:
            radius, height = dice.uniform(0.032, 0.05), dice.uniform(0.17, 0.24)
            color = dice.choice(("bottle_green", "amber", "blue", "ivory", "red", "amber"))
            drum((x, y, -3.78), radius, height, color)
            cylinder((x, y + height, -3.78), (x, y + height + 0.09, -3.78), 0.014, color)
            sphere((x, y + height, -3.78), 0.55 * radius, color)
            x += dice.uniform(0.1, 0.17)


LETTERS = {  # strokes in a box of 1 x 2
    "L": [((0, 2), (0, 0)), ((0, 0), (1, 0))],
    "U": [((0, 2), (0, 0)), ((0, 0), (1, 0)), ((1, 0), (1, 2))],
    "C": [((1, 2), (0, 2)), ((0, 2), (0, 0)), ((0, 0), (1, 0))],
    "E": [((1, 2), (0, 2)), ((0, 2), (0, 0)), ((0, 0), (1, 0)), ((0, 1), (0.8, 1))],
    "R": [((0, 0), (0, 2)), ((0, 2), (1, 1.9)), ((1, 1.9), (1, 1.1)), ((1, 1.1), (0, 1)),
          ((0.35, 1.02), (1, 0))],
    "N": [((0, 0), (0, 2)), ((0, 2), (1, 0)), ((1, 0), (1, 2))],
    "A": [((0, 0), (0.5, 2)), ((0.5, 2), (1, 0)), ((0.2, 0.8), (0.8, 0.8))],
}


def neon():
    size, x = 0.2, -2.72
    for letter in "LUCERNA":
        for a, b in LETTERS[letter]:
            ends = [(x + size * p[0], 2.66 + size * p[1], -3.93) for p in (a, b)]
            cylinder(*ends, 0.011, "black", (46, 4.4, 19))
        x += 1.65 * size


def tables():
    for x, z in ((-3.7, 2.2), (-1.7, 1.2), (-3.3, 3.9), (0.9, 0.9)):
        drum((x, 0.7, z), 0.42, 0.035, "lacquer")
        cylinder((x, 0, z), (x, 0.7, z), 0.035, "chrome")
        drum((x, 0, z), 0.24, 0.02, "chrome")
        drum((x, 0.735, z), 0.04, 0.05, "ivory")  # a candle
        sphere((x, 0.81, z), 0.016, "black", (1500, 700, 190))
        for k in range(3):
            angle = 2.1 * k + x
            sx, sz = x + 0.72 * math.cos(angle), z + 0.72 * math.sin(angle)
            drum((sx, 0, sz), 0.19, 0.46, "leather")
    box((-5, 0, 1.7), (-4.45, 0.45, 4.5), "leather")
    box((-5, 0.45, 1.7), (-4.85, 1.05, 4.5), "leather")


def pendants():
    for i in range(6):
        x = -3.7 + 1.0 * i
        cylinder((x, 2.12, -2.3), (x, 3.2, -2.3), 0.006, "black")
        sphere((x, 2.0, -2.3), 0.055, "black", (170, 100, 38))
        drum((x, 2.07, -2.3), 0.05, 0.06, "brass")
    for start, end in (((-5, 2.9, -1), (5, 2.9, 3)), ((-5, 2.9, 3.2), (5, 2.9, -1.2))):
        for k in range(1, 24):  # strings of small lights
            t = k / 24
            p = [a + t * (b - a) for a, b in zip(start, end)]
            p[1] -= 1.5 * t * (1 - t) * 0.9
            sphere(p, 0.016, "black", (600, 350, 140))


def elsewhere():
    """Rooms that the bar does not see, but through its doors: each has lights of one colour."""
    colors = {"left": (26, 5, 60), "right": (6, 36, 60),
              "kitchen": (70, 80, 76), "hall": (70, 38, 12)}
    places = {"left": (-14.5, -5.7, -3.6, 4.2), "right": (5.7, 14.5, -3.6, 4.2),
              "kitchen": (-14.5, 14.5, -11.5, -4.8), "hall": (-14.5, 14.5, 5.2, 11.5)}
    for name, (x0, x1, z0, z1) in places.items():
        for _ in range(70):
            x, z = dice.uniform(x0, x1), dice.uniform(z0, z1)
            y = dice.uniform(2.0, 3.0)
            color = [c * dice.uniform(0.5, 2) for c in colors[name]]
            sphere((x, y, z), 0.045, "black", color)
        for _ in range(6):  # some furniture, too
            x, z = dice.uniform(x0, x1 - 1), dice.uniform(z0, z1 - 1)
            box((x, 0, z), (x + 0.9, dice.uniform(0.5, 1.9), z + 0.9), "plaster")


for part in (rooms, counter, bottles, neon, tables, pendants, elsewhere):
    put(f"<!-- {part.__name__} -->")
    part()
text = '<?xml version="1.0" encoding="utf-8"?>\n<!-- Written by make_scene.py. -->\n'
text += '<scene version="3.0.0">\n' + "\n".join(lines) + "\n</scene>\n"
Path(__file__).with_name("things.xml").write_text(text)
print(lights, "lights")
