#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The water of the pool: a sum of waves over a rectangle, with its exact normals.

    ./make_meshes.py        writes meshes/water.ply
"""
import math
import random
import struct

HALF_WIDTH, HALF_LENGTH = 1.6, 2.0
COLUMNS, ROWS = 112, 140
WAVES = 14


def make_waves():
    """(wave vector x, z, phase, amplitude); short waves are lower: their curvature is what bends
    light, and it grows with the square of 1 / length."""
    choice = random.Random(11)
    waves = []
    for i in range(WAVES):
        length = 0.26 * 1.09 ** i
        angle = choice.uniform(0, 2 * math.pi)
        k = 2 * math.pi / length
        waves.append((k * math.cos(angle), k * math.sin(angle), choice.uniform(0, 2 * math.pi),
                      0.62 / k ** 2))
    return waves


def vertex(waves, x, z):
    height = slope_x = slope_z = 0.0
    for kx, kz, phase, amplitude in waves:
        angle = kx * x + kz * z + phase
        height += amplitude * math.sin(angle)
        slope_x += amplitude * kx * math.cos(angle)
        slope_z += amplitude * kz * math.cos(angle)
    length = math.sqrt(1 + slope_x ** 2 + slope_z ** 2)
    return x, height, z, -slope_x / length, 1 / length, -slope_z / length


def main():
    waves = make_waves()
    vertices = [vertex(waves, HALF_WIDTH * (2 * i / COLUMNS - 1), HALF_LENGTH * (2 * j / ROWS - 1))
                for j in range(ROWS + 1) for i in range(COLUMNS + 1)]
    corners = [j * (COLUMNS + 1) + i for j in range(ROWS) for i in range(COLUMNS)]
    with open("meshes/water.ply", "wb") as out:
        out.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
                   + "".join(f"property float {p}\n" for p in ("x", "y", "z", "nx", "ny", "nz"))
                   + f"element face {len(corners)}\n"
                   "property list uchar int vertex_indices\nend_header\n").encode())
        for v in vertices:
            out.write(struct.pack("<6f", *v))
        for a in corners:
            below = a + COLUMNS + 1
            out.write(struct.pack("<B4i", 4, a, below, below + 1, a + 1))


main()
