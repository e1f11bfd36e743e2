#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes smoke.vol: the density of a plume that rises and breaks up, one byte for each voxel.

The noise is a sum of octaves of value noise (Perlin 1985) at points that noise has displaced
before, so that the smoke curls.
"""
import math
import struct
from pathlib import Path

NX, NY, NZ = 52, 104, 52


def lattice(i, j, k):
    """A number of [0, 1) for each point of the integer lattice."""
    h = (i * 374761393 + j * 668265263 + k * 2147483647 + 1013904223) & 0xffffffff
    h = ((h ^ (h >> 13)) * 1274126177) & 0xffffffff
    return ((h ^ (h >> 16)) & 0xffffff) / 0x1000000


def mix(a, b, t):
    return a + (b - a) * t


def smooth(t):
    return t * t * (3 - 2 * t)


def noise(x, y, z):
    i, j, k = math.floor(x), math.floor(y), math.floor(z)
    u, v, w = smooth(x - i), smooth(y - j), smooth(z - k)
    rows = [mix(lattice(i, j + b, k + c), lattice(i + 1, j + b, k + c), u)
            for c in (0, 1) for b in (0, 1)]
    return mix(mix(rows[0], rows[1], v), mix(rows[2], rows[3], v), w)


def octaves(x, y, z, count):
    total = weight = 0.0
    for octave in range(count):
        scale = 2.03 ** octave
        total += 0.55 ** octave * noise(scale * x, scale * y, scale * z)
        weight += 0.55 ** octave
    return total / weight


def density(x, y, z):
    """At a point of [-1, 1] × [0, 1] × [-1, 1]."""
    curl = 0.16 + 0.9 * y
    wx = x + curl * (octaves(2.2 * x, 5 * y, 2.2 * z + 9, 2) - 0.5)
    wz = z + curl * (octaves(2.2 * x + 31, 5 * y, 2.2 * z, 2) - 0.5)
    lean = 0.22 * math.sin(4.2 * y) * y
    radius = 0.1 + 0.5 * y ** 0.75
    distance = math.hypot(wx - lean, wz) / radius
    body = 1.25 - distance * distance
    detail = octaves(4.5 * wx / (0.6 + y), 10 * y - 3, 4.5 * wz / (0.6 + y), 4)
    value = body + 2.6 * (detail - 0.56) * (0.35 + y)
    ends = smooth(min(1, y / 0.03)) * smooth(max(0, min(1, (0.97 - y) / 0.35)))
    sides = smooth(max(0, min(1, (1 - max(abs(x), abs(z))) / 0.1)))
    return max(0.0, min(1.0, value)) * ends * sides * (1 - 0.55 * y)


def main():
    voxels = bytearray()
    for k in range(NZ):
        for j in range(NY):
            for i in range(NX):
                x, y, z = 2 * (i + 0.5) / NX - 1, (j + 0.5) / NY, 2 * (k + 0.5) / NZ - 1
                voxels.append(round(255 * density(x, y, z)))
    header = b"VOL\x03" + struct.pack("<5i6f", 3, NX, NY, NZ, 1, -1, 0, -1, 1, 4, 1)
    Path(__file__).with_name("smoke.vol").write_bytes(header + voxels)


if __name__ == "__main__":
    main()
