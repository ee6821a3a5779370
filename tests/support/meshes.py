"""Meshes that several tests touch."""

from __future__ import annotations

from typing import Any

import numpy as np


def extruded(outline: Any, width: float = 0.1) -> tuple[Any, Any]:
    """A closed prism along y over a counter-clockwise outline in (z, x), which need not be convex: fans at (0, 0)."""
    outline = np.asarray(outline, float)
    n = len(outline)
    points = np.array([[x, y, z] for y in (-width / 2, width / 2) for z, x in outline])
    faces = []
    for i in range(n):
        j = (i + 1) % n
        faces += [(i, j, n + j), (i, n + j, n + i)]
    for i in range(1, n - 1):
        faces += [(0, i + 1, i), (n, n + i, n + i + 1)]
    return points, np.array(faces)


GROOVE = extruded([(0.0, 0.0), (0.03, 0.03), (-0.03, 0.03), (-0.03, -0.03), (0.03, -0.03)])
"""A block with a right-angled groove along y, its bottom at the origin, open to +z."""


def ball(radius: float, corners: int) -> Any:
    """Points spread evenly over a sphere (Fibonacci's lattice) [m], shape [corners, 3]."""
    k = np.arange(corners) + 0.5
    y, turn = 1.0 - 2.0 * k / corners, np.pi * (1.0 + 5.0**0.5) * k
    across = np.sqrt(1.0 - y * y)
    return radius * np.stack([across * np.cos(turn), y, across * np.sin(turn)], axis=1)
