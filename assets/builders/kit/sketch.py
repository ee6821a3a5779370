"""Meshes drawn face by face: quads, boxes and fans by material, with uvs in metres and baked shade."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from mimics_app.world.files.gltf.writer import MeshPart

__all__ = ["Point", "Sketch", "Uv"]

Point = tuple[float, float, float]
Uv = tuple[float, float]
Shade = float | Sequence[float]


@dataclass
class _Faces:
    positions: list[Point] = field(default_factory=list)
    normals: list[Point] = field(default_factory=list)
    uvs: list[Uv] = field(default_factory=list)
    shades: list[float] = field(default_factory=list)
    indices: list[int] = field(default_factory=list)


class Sketch:
    """Faces of an object by material name; vertices are counter-clockwise seen from outside [m]."""

    def __init__(self) -> None:
        self._faces: dict[str, _Faces] = {}

    @property
    def triangle_count(self) -> int:
        """Number of triangles of all materials."""
        return sum(len(faces.indices) for faces in self._faces.values()) // 3

    def fan(
        self,
        material: str,
        corners: Sequence[Point],
        uvs: Sequence[Uv],
        shade: Shade = 1.0,
        normals: Sequence[Point] | None = None,
    ) -> None:
        """Add a flat convex face as a fan of triangles about its first vertex.

        Args:
            material: Name of the material.
            corners: Three or more vertices [m].
            uvs: One per corner.
            shade: Factor on the colour of all vertices, or of each.
            normals: One per corner; default: the face's own.
        """
        faces = self._faces.setdefault(material, _Faces())
        first, count = len(faces.positions), len(corners)
        faces.positions += corners
        faces.normals += normals or [_unit_normal(*corners[:3])] * count
        faces.uvs += uvs
        faces.shades += [shade] * count if isinstance(shade, (int, float)) else shade
        for corner in range(1, count - 1):
            faces.indices += (first, first + corner, first + corner + 1)

    def strip(
        self,
        material: str,
        corners: Sequence[Point],
        uvs: Sequence[Uv],
        triangles: Iterable[tuple[int, int, int]],
        shade: Shade = 1.0,
    ) -> None:
        """Add faces that share vertices, and the normal of the first."""
        faces = self._faces.setdefault(material, _Faces())
        first, rows = len(faces.positions), list(triangles)
        faces.positions += corners
        faces.normals += [_unit_normal(*(corners[i] for i in rows[0]))] * len(corners)
        faces.uvs += uvs
        faces.shades += [shade] * len(corners) if isinstance(shade, (int, float)) else shade
        for a, b, c in rows:
            faces.indices += (first + a, first + b, first + c)

    def box(
        self,
        material: str,
        low: Point,
        high: Point,
        *,
        uv: Uv | None = None,
        per_metre: float = 1.0,
        shade: float = 1.0,
        under: float = 0.55,
        hidden: str = "",
    ) -> None:
        """Add an upright box.

        Args:
            material: Of all faces.
            low: Corner of the smallest coordinates [m].
            high: Corner of the largest coordinates [m].
            uv: Texture coordinates of its one colour; None: the texture repeats `per_metre` times a metre.
            per_metre: See `uv`.
            shade: Factor on the colour.
            under: Further factor on the face below, which sees little sky.
            hidden: Letters of faces that are left out: -x "w", +x "e", -y "d", +y "u", -z "n", +z "s".
        """
        (x0, y0, z0), (x1, y1, z1) = low, high
        sides: dict[str, list[Point]] = {
            "s": [(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)],
            "n": [(x1, y0, z0), (x0, y0, z0), (x0, y1, z0), (x1, y1, z0)],
            "e": [(x1, y0, z1), (x1, y0, z0), (x1, y1, z0), (x1, y1, z1)],
            "w": [(x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0)],
            "u": [(x0, y1, z1), (x1, y1, z1), (x1, y1, z0), (x0, y1, z0)],
            "d": [(x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)],
        }
        for side, corners in sides.items():
            if side not in hidden:
                uvs = [uv] * 4 if uv else _flat_uvs(corners, per_metre)
                self.fan(material, corners, uvs, shade * (under if side == "d" else 1.0))

    def sheet(
        self,
        material: str,
        corner: Point,
        along: Point,
        up: Point,
        steps: tuple[int, int],
        per_metre: float,
        shade: Callable[[Point], float],
    ) -> None:
        """Add a rectangle in pieces, so that its shade can vary; seen from along x up.

        Args:
            material: Name of the material.
            corner: First corner [m].
            along: First side [m].
            up: Second side [m].
            steps: Pieces along each side.
            per_metre: Repetitions of the texture per metre.
            shade: Factor on the colour at a point.
        """
        columns, rows = steps
        wide, high = (math.sqrt(sum(part * part for part in side)) for side in (along, up))
        corners: list[Point] = []
        uvs: list[Uv] = []
        for row in range(rows + 1):
            for column in range(columns + 1):
                s, t = column / columns, row / rows
                x, y, z = (c + s * a + t * u for c, a, u in zip(corner, along, up, strict=True))
                corners.append((x, y, z))
                uvs.append((s * wide * per_metre, -t * high * per_metre))
        triangles: list[tuple[int, int, int]] = []
        for row in range(rows):
            for column in range(columns):
                first = row * (columns + 1) + column
                above = first + columns + 1
                triangles += [(first, first + 1, above + 1), (first, above + 1, above)]
        self.strip(material, corners, uvs, triangles, [shade(point) for point in corners])

    def add(self, other: Sketch, place: Callable[[Point], Point], turn: Callable[[Point], Point] | None = None) -> None:
        """Add another sketch.

        Args:
            other: The sketch.
            place: Transformation of its points.
            turn: Transformation of its normals; default: none.
        """
        for material, faces in other._faces.items():
            mine = self._faces.setdefault(material, _Faces())
            first = len(mine.positions)
            mine.positions += [place(point) for point in faces.positions]
            mine.normals += [turn(normal) for normal in faces.normals] if turn else faces.normals
            mine.uvs += faces.uvs
            mine.shades += faces.shades
            mine.indices += [first + index for index in faces.indices]

    def parts(self) -> dict[str, MeshPart]:
        """Return the faces as arrays, positions rounded to 0.1 mm: sines differ between machines by less."""
        return {material: _to_part(faces) for material, faces in self._faces.items()}


def _unit_normal(a: Point, b: Point, c: Point) -> Point:
    """Return the normal of a counter-clockwise triangle.

    Raises:
        ValueError: its corners lie on a line.
    """
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    length = math.sqrt(x * x + y * y + z * z)
    if length < 1e-9:
        raise ValueError(f"no normal: {a}, {b} and {c} lie on a line")
    return x / length, y / length, z / length


def _flat_uvs(corners: Sequence[Point], per_metre: float) -> list[Uv]:
    """Return texture coordinates in metres: along and up a wall; along x and z on a floor."""
    normal = _unit_normal(*corners[:3])
    if abs(normal[1]) > 0.7:
        return [(x * per_metre, z * per_metre) for x, _, z in corners]
    if abs(normal[2]) > 0.7:
        return [(x * per_metre, -y * per_metre) for x, y, _ in corners]
    return [(z * per_metre, -y * per_metre) for _, y, z in corners]


def _to_part(faces: _Faces) -> MeshPart:
    shades = np.zeros((len(faces.shades), 4), np.uint8)
    shades[:, :3] = np.clip(np.rint(np.array(faces.shades) * 255.0), 0.0, 255.0)[:, None]
    shades[:, 3] = 255
    normals = np.round(np.array(faces.normals, np.float64), 4)
    lengths = np.sqrt(normals[:, 0] ** 2 + normals[:, 1] ** 2 + normals[:, 2] ** 2)
    return MeshPart(
        np.round(np.array(faces.positions, np.float64), 4).astype(np.float32),
        (normals / lengths[:, None]).astype(np.float32),
        np.round(np.array(faces.uvs, np.float64), 5).astype(np.float32),
        shades,
        np.array(faces.indices, np.uint32),
    )
