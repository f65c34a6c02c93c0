#!/usr/bin/env python3
"""Writes a model of small things on a large ground, which tests/regression/models.md measures.

    tools/lab/scripts/yard.py yard.obj
"""
import math
import sys

vertices, triangles = [], []


def box(x, y, z, width, height, depth):
    """A box whose bottom has its middle at (x, y, z)."""
    first = len(vertices)
    for i in range(8):
        vertices.append((x + (width if i & 1 else -width) / 2, y + (height if i & 2 else 0),
                         z + (depth if i & 4 else -depth) / 2))
    for a, b, c, d in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)):
        triangles.append((first + a, first + b, first + c))
        triangles.append((first + a, first + c, first + d))


def table(x, z):
    box(x, 0.7, z, 1.2, 0.05, 0.8)
    for i in (-1, 1):
        for j in (-1, 1):
            box(x + 0.55 * i, 0, z + 0.35 * j, 0.05, 0.7, 0.05)


def fence(x, z, rods):
    for i in range(rods):
        box(x + 0.25 * i, 0, z, 0.03, 1.1, 0.03)
    box(x + 0.25 * (rods - 1) / 2, 1.0, z, 0.25 * rods, 0.05, 0.05)


def ring(x, y, z, radius, thickness, around=32, across=12):
    first = len(vertices)
    for i in range(around):
        for j in range(across):
            a, b = 2 * math.pi * i / around, 2 * math.pi * j / across
            out = radius + thickness * math.cos(b)
            vertices.append((x + out * math.cos(a), y + out * math.sin(a), z + thickness * math.sin(b)))
    for i in range(around):
        for j in range(across):
            here, there = first + i * across, first + (i + 1) % around * across
            after = (j + 1) % across
            triangles.append((here + j, there + j, there + after))
            triangles.append((here + j, there + after, here + after))


vertices += [(-150, 0, -150), (-150, 0, 150), (150, 0, 150), (150, 0, -150)]
triangles += [(0, 1, 2), (0, 2, 3)]
table(20, -35)
fence(18, -37, 16)
ring(22.5, 0.6, -35, 0.45, 0.12)
table(-40, 50)
fence(-42, 48, 8)
with open(sys.argv[1], 'w') as out:
    for vertex in vertices:
        out.write('v %.6f %.6f %.6f\n' % vertex)
    for triangle in triangles:
        out.write('f %d %d %d\n' % tuple(i + 1 for i in triangle))
