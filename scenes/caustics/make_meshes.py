#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Turns profiles around the y axis: the ring and the glass of water of this scene.

    ./make_meshes.py        writes meshes/*.ply
"""
import math
import struct

SEGMENTS = 128


def lathe(name, strips):
    """strips: lists of (radius, height, normal's radius, normal's height), smooth within each."""
    vertices, faces = [], []
    for strip in strips:
        first = len(vertices)
        for r, y, nr, ny in strip:
            length = math.hypot(nr, ny)
            for s in range(SEGMENTS):
                a = 2 * math.pi * s / SEGMENTS
                c, z = math.cos(a), math.sin(a)
                vertices.append((r * c, y, r * z, nr * c / length, ny / length, nr * z / length))
        for k in range(len(strip) - 1):
            for s in range(SEGMENTS):
                t = (s + 1) % SEGMENTS
                a, b = first + k * SEGMENTS + s, first + k * SEGMENTS + t
                c, d = a + SEGMENTS, b + SEGMENTS
                if strip[k][0] > 0:
                    faces.append((a, c, b))
                if strip[k + 1][0] > 0:
                    faces.append((b, c, d))
    with open(f"meshes/{name}.ply", "wb") as out:
        out.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
                   + "".join(f"property float {p}\n" for p in ("x", "y", "z", "nx", "ny", "nz"))
                   + f"element face {len(faces)}\n"
                   "property list uchar int vertex_indices\nend_header\n").encode())
        for v in vertices:
            out.write(struct.pack("<6f", *v))
        for f in faces:
            out.write(struct.pack("<B3i", 3, *f))


def line(r0, y0, r1, y1, count, outside=1):
    """A straight piece; its normal is on the right-hand side of the way, or the other."""
    nr, ny = outside * (y1 - y0), -outside * (r1 - r0)
    return [(r0 + (r1 - r0) * i / count, y0 + (y1 - y0) * i / count, nr, ny)
            for i in range(count + 1)]


def arc(r, y, radius, start, end, count):
    angles = [math.radians(start + (end - start) * i / count) for i in range(count + 1)]
    return [(r + radius * math.cos(a), y + radius * math.sin(a), math.cos(a), math.sin(a))
            for a in angles]


def ring(inner=0.42, width=0.03, height=0.28, edge=0.02):
    r0, r1, y0, y1 = inner + edge, inner + width + edge, edge, height - edge
    lathe("ring", [
        arc(r1, y0, edge, -90, 0, 8), line(r1 + edge, y0, r1 + edge, y1, 1),
        arc(r1, y1, edge, 0, 90, 8), line(r1, y1 + edge, r0, y1 + edge, 1),
        arc(r0, y1, edge, 90, 180, 8), line(r0 - edge, y1, r0 - edge, y0, 1),
        arc(r0, y0, edge, 180, 270, 8), line(r0, y0 - edge, r1, y0 - edge, 1)])


def glass(bottom=0.3, top=0.38, height=0.95, wall=0.03, base=0.1, level=0.68, edge=0.02):
    def outer(y):
        return bottom + (top - bottom) * y / height

    def inner(y):
        return outer(y) - wall

    middle, half = outer(height) - wall / 2, wall / 2
    lathe("glass_air", [
        line(0, 0, bottom - edge, 0, 1), arc(bottom - edge, edge, edge, -90, 0, 8),
        line(outer(edge), edge, outer(height), height, 24), arc(middle, height, half, 0, 180, 12),
        line(inner(height), height, inner(level), level, 8)])
    lathe("glass_water", [
        line(inner(level), level, inner(base), base, 16), line(inner(base), base, 0, base, 1)])
    lathe("water_air", [line(inner(level), level, 0, level, 8)])


ring()
glass()
