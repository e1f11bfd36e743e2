#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes hammered.png, the height of hammered metal, as a tile that repeats: 16 bit, grey.

Each blow leaves a bowl; the surface is the lowest of them, with rounded edges between.
"""
import math
import random
import struct
import zlib

SIZE = 128
BLOWS = 14


def height(x, y, blows):
    """In [0, 1], at a point of the unit square whose opposite sides are the same."""
    total = 0.0
    for bx, by, depth in blows:
        dx = abs(x - bx)
        dy = abs(y - by)
        d2 = min(dx, 1 - dx) ** 2 + min(dy, 1 - dy) ** 2
        total += math.exp(-40 * (d2 * 14 + depth))
    return -math.log(total) / 40


def main():
    generator = random.Random(5)
    blows = [(generator.random(), generator.random(), 0.1 * generator.random())
             for _ in range(BLOWS)]
    heights = [[height((i + 0.5) / SIZE, (j + 0.5) / SIZE, blows) for i in range(SIZE)]
               for j in range(SIZE)]
    low = min(map(min, heights))
    high = max(map(max, heights))
    rows = b"".join(
        b"\0" + b"".join(struct.pack(">H", round(65535 * (h - low) / (high - low))) for h in row)
        for row in heights)

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(
            ">I", zlib.crc32(name + data))

    with open("hammered.png", "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        file.write(chunk(b"IHDR", struct.pack(">IIBBBBB", SIZE, SIZE, 16, 0, 0, 0, 0)))
        file.write(chunk(b"IDAT", zlib.compress(rows, 9)))
        file.write(chunk(b"IEND", b""))


if __name__ == "__main__":
    main()
