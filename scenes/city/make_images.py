#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes dusk.hdr, the sky after sunset, and what is behind lit windows: home_*.hdr, office.hdr
and shop_*.hdr. Radiance in W/(m² sr)."""
import math
import random
from pathlib import Path


def mix(a, b, t):
    return [x + (y - x) * t for x, y in zip(a, b)]


def times(color, factor):
    return [factor * x for x in color]


def rgbe(color):
    """Ward 1991: a common exponent for three bytes."""
    largest = max(color)
    if largest < 1e-9:
        return bytes(4)
    mantissa, exponent = math.frexp(largest)
    scale = mantissa * 256 / largest
    return bytes([int(x * scale) for x in color] + [exponent + 128])


def write(name, width, height, color):
    """A Radiance picture; color(u, v) with u to the right and v upwards, 0 to 1."""
    pixels = bytearray()
    for y in range(height):
        for x in range(width):
            pixels += rgbe(color((x + 0.5) / width, 1 - (y + 0.5) / height))
    header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n"
    Path(__file__).with_name(name).write_bytes(header.encode() + pixels)


def dusk(u, v):
    """The glow is in the middle of the picture."""
    azimuth, elevation = 2 * math.pi * (u - 0.5), math.pi * (v - 0.5)
    if elevation < -0.2:
        return [0.004, 0.005, 0.008]
    height = max(0, math.sin(elevation))
    sky = mix([0.045, 0.055, 0.105], [0.005, 0.011, 0.04], height ** 0.4)
    towards = 0.5 + 0.5 * math.cos(azimuth)
    glow = math.exp(-height / 0.06) * (0.12 + 0.88 * towards ** 2)
    return [x + y * glow for x, y in zip(sky, [0.36, 0.13, 0.035])]


def home(color):
    """A casement with curtains; the lamp hangs from the ceiling."""
    def at(u, v):
        if min(u, 1 - u) < 0.05 or min(v, 1 - v) < 0.035 or abs(u - 0.5) < 0.025 or \
                abs(v - 0.68) < 0.018:
            return times(color, 0.25)
        light = 0.62 + 0.38 * v * v
        if abs(u - 0.5) > 0.27:
            light *= 0.78 + 0.08 * math.cos(70 * u)
        return times(color, light)
    return at


def office(color):
    """Ceiling lamps above, desks below."""
    def at(u, v):
        if min(u, 1 - u) < 0.04 or min(v, 1 - v) < 0.03:
            return times(color, 0.2)
        if 0.82 < v < 0.9 and abs(((3 * u) % 1) - 0.5) < 0.3:
            return times(color, 1.25)
        if v < 0.3 and 0.1 < u < 0.62:
            return times(color, 0.4)
        return times(color, 0.55 + 0.3 * v)
    return at


def shop(color, seed):
    """Shelves with goods between the frames of a shop window."""
    dice = random.Random(seed)
    goods = [[[0.25 + 0.75 * dice.random() for _ in range(3)] for _ in range(14)]
             for _ in range(4)]
    heights = [[0.3 + 0.6 * dice.random() for _ in range(14)] for _ in range(4)]

    def at(u, v):
        if min(u, 1 - u) < 0.015 or min(v, 1 - v) < 0.04 or abs(u - 0.7) < 0.012:
            return times(color, 0.2)
        if 0.7 < u < 0.98:  # the door: one looks into the shop
            return times(color, 0.6 + 0.5 * v)
        if v > 0.86:
            return times(color, 1.3)
        row, column = min(3, int(4 * v / 0.86)), int(20 * u)
        inside = (4 * v / 0.86) % 1
        if inside < 0.1:
            return times(color, 0.35)
        if inside < heights[row][column % 14] and 0.15 < (20 * u) % 1 < 0.85:
            return [0.75 * x * y for x, y in zip(color, goods[row][column % 14])]
        return times(color, 0.5 + 0.4 * v)
    return at


write("dusk.hdr", 128, 64, dusk)
for number, tone in enumerate(([1.6, 0.77, 0.26], [1.5, 1.02, 0.55], [0.36, 0.62, 1.25])):
    write(f"home_{number}.hdr", 24, 32, home(tone))
write("office.hdr", 32, 32, office([0.95, 1.0, 0.88]))
for number, tone in enumerate(([1.5, 1.0, 0.5], [1.05, 1.1, 1.05])):
    write(f"shop_{number}.hdr", 96, 40, shop(tone, number + 5))
