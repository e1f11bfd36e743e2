#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes dusk.hdr: the sky after sunset, brightest where the sun went down."""
import math
from pathlib import Path

WIDTH, HEIGHT = 128, 64


def mix(a, b, t):
    return [x + (y - x) * t for x, y in zip(a, b)]


def radiance(azimuth, elevation):
    """Radiance [W/(m² sr)] for angles in radians; the glow is at azimuth 0."""
    if elevation < 0:
        return [0.002, 0.003, 0.005]
    height = math.sin(elevation)
    sky = mix([0.030, 0.042, 0.085], [0.004, 0.007, 0.022], height ** 0.45)
    glow = math.exp(-height / 0.07) * (0.25 + 0.75 * max(0, math.cos(azimuth)) ** 3)
    return [x + y * glow for x, y in zip(sky, [0.22, 0.085, 0.03])]


def rgbe(color):
    """Ward 1991: a common exponent for three bytes."""
    largest = max(color)
    mantissa, exponent = math.frexp(largest)
    scale = mantissa * 256 / largest
    return bytes([int(x * scale) for x in color] + [exponent + 128])


def main():
    pixels = bytearray()
    for y in range(HEIGHT):
        for x in range(WIDTH):
            azimuth = 2 * math.pi * (x + 0.5) / WIDTH - math.pi
            pixels += rgbe(radiance(azimuth, math.pi * (0.5 - (y + 0.5) / HEIGHT)))
    header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {HEIGHT} +X {WIDTH}\n"
    Path(__file__).with_name("dusk.hdr").write_bytes(header.encode() + pixels)


main()
