"""MachinePart: meshes of a part of a machine by finish, placed by simple measures."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from assets.builders.kit.sketch import Point
from assets.builders.market.sculpt import Colour, Sculpt, rounded_box, surface
from mimics_app.contracts.arrays import F8
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.meshes.primitives import cylinder, tube
from mimics_app.world.files.gltf.writer import MeshPart

__all__ = ["ALUMINIUM", "ANTHRACITE", "BLACK", "BLUE", "CHROME", "WHITE", "MachinePart", "ring"]

WHITE: Colour = (0.80, 0.81, 0.82)
ANTHRACITE: Colour = (0.075, 0.080, 0.090)
BLACK: Colour = (0.022, 0.022, 0.025)
BLUE: Colour = (0.030, 0.180, 0.420)
ALUMINIUM: Colour = (0.60, 0.61, 0.63)
CHROME: Colour = (0.78, 0.79, 0.80)

_FACETS = 12
"""Facets around a disc."""


class MachinePart:
    """Meshes of one node of the model.

    Args:
        side: 1.0, or -1.0 to mirror everything to the person's right.
        scale: Factor on everything.
    """

    def __init__(self, side: float = 1.0, scale: float = 1.0) -> None:
        self._placing = np.diag([side * scale, scale, scale])
        self._sculpts: dict[str, Sculpt] = {}

    def parts(self) -> dict[str, MeshPart]:
        """Return the meshes by finish."""
        return {finish: sculpt.part() for finish, sculpt in self._sculpts.items()}

    def box(self, finish: str, colour: Colour, centre: Point, size: Point, radius: float = 0.004) -> None:
        """Add a box with rounded edges: its centre and its size [m]."""
        self._add(finish, colour, rounded_box(*size, radius, steps=1), np.eye(3), centre)

    def beam(
        self,
        finish: str,
        colour: Colour,
        first: Point,
        last: Point,
        section: tuple[float, float],
        radius: float = 0.006,
    ) -> None:
        """Add a box from one point to another, with a section across (along x or nearly, and the other way) [m]."""
        begin, end = np.array(first), np.array(last)
        length = float(np.linalg.norm(end - begin))
        mesh = rounded_box(section[0], length, section[1], radius, steps=1)
        self._add(finish, colour, mesh, _along(end - begin), 0.5 * (begin + end))

    def disc(
        self, finish: str, colour: Colour, first: Point, last: Point, radius: float, end_radius: float | None = None
    ) -> None:
        """Add a round solid with flat ends from one point to another, of a radius at each [m]."""
        begin, end = np.array(first), np.array(last)
        mesh = cylinder(radius, float(np.linalg.norm(end - begin)), top_radius=end_radius, segments=_FACETS)
        self._add(finish, colour, mesh, _along(end - begin), 0.5 * (begin + end))

    def pipe(self, finish: str, colour: Colour, points: Sequence[Point], radius: float, sides: int = 9) -> None:
        """Add a round bar along points, rounded where it bends: radius [m]."""
        line = _softened(np.array(points), 4.0 * radius)
        normals, binormals = _frames(line)
        mesh = tube(line, normals, binormals, np.full(len(line), radius), sides=sides)
        self._add(finish, colour, mesh, np.eye(3), (0.0, 0.0, 0.0))

    def band(self, finish: str, colour: Colour, lines: Sequence[F8], *, closed: bool = False) -> None:
        """Add a sheet through rows of points, [rows, n, 3], seen from outside, and 3 mm below it from inside.

        Rows go upwards and points counter-clockwise seen from above, or the band is inside out.
        """
        grid = np.array(lines)
        rows, columns = (np.arange(count, dtype=np.float64) for count in grid.shape[:2])

        def point(u: F8, v: F8, inset: float = 0.0) -> F8:
            across = np.gradient(grid, axis=1) if not closed else _around(grid)
            outward = np.cross(across, np.gradient(grid, axis=0))
            outward /= np.linalg.norm(outward, axis=2, keepdims=True)
            return (grid - inset * outward)[v.astype(int), u.astype(int)]

        self._add(finish, colour, surface(point, columns, rows), np.eye(3), (0.0, 0.0, 0.0))
        inside = surface(lambda u, v: point(u, v, 0.003), columns, rows, flip=True)
        self._add(finish, colour, inside, np.eye(3), (0.0, 0.0, 0.0))

    def _add(self, finish: str, colour: Colour, mesh: MeshData, turn: F8, centre: Sequence[float] | F8) -> None:
        sculpt = self._sculpts.setdefault(finish, Sculpt())
        sculpt.add(mesh, colour, self._placing @ np.asarray(centre), self._placing @ turn)


def _along(direction: F8) -> F8:
    """Return the rotation that takes +y into a direction, and keeps x nearly where it is."""
    up = direction / np.linalg.norm(direction)
    helper = np.array([1.0, 0.0, 0.0]) if abs(up[0]) < 0.9 else np.array([0.0, 0.0, -1.0])
    ahead = np.cross(helper, up)
    ahead /= np.linalg.norm(ahead)
    return np.stack([np.cross(up, ahead), up, ahead], axis=1)


def _frames(line: F8) -> tuple[F8, F8]:
    """Return normals and binormals of a line that turn no more than the line does, [n, 3] each."""
    along = np.gradient(line, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    normals = [np.cross(along[0], np.eye(3)[int(np.argmin(np.abs(along[0])))])]
    for direction in along:
        last = normals[-1] - (normals[-1] @ direction) * direction
        normals.append(last / np.linalg.norm(last))
    around = np.array(normals[1:])
    return around, np.cross(along, around)


def _around(grid: F8) -> F8:
    """Return differences along rows whose last point is the first one."""
    ring = grid[:, :-1]
    steps = 0.5 * (np.roll(ring, -1, axis=1) - np.roll(ring, 1, axis=1))
    return np.concatenate([steps, steps[:, :1]], axis=1)


def _softened(points: F8, reach: float) -> F8:
    """Return a line of points whose corners are arcs that begin up to a distance before them [m]."""
    line = [points[0]]
    for before, corner, after in zip(points, points[1:], points[2:], strict=False):
        sides = [other - corner for other in (before, after)]
        near = [min(reach, 0.45 * float(np.linalg.norm(side))) for side in sides]
        first, last = (corner + d * side / np.linalg.norm(side) for d, side in zip(near, sides, strict=True))
        shares = np.linspace(0.0, 1.0, 6).tolist()
        line += [(1 - s) ** 2 * first + 2 * s * (1 - s) * corner + s**2 * last for s in shares]
    return np.array([*line, points[-1]])


def ring(centre: Point, radii: Sequence[float], angles: F8) -> F8:
    """Return points around an upright axis, [n, 3]: radii [m] at even angles from +x to +z, at some angles [rad]."""
    turns = np.linspace(0.0, 2.0 * math.pi, len(radii) + 1)
    r = np.interp(np.mod(angles, 2.0 * math.pi), turns, [*radii, radii[0]])
    return np.stack(
        [centre[0] + r * np.cos(angles), np.full(len(angles), centre[1]), centre[2] + r * np.sin(angles)], 1
    )
