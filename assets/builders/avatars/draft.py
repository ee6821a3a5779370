"""Meshes with texture coordinates per face; vertices are doubled at the seams of the texture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from assets.builders.avatars.fields import F8, Field
from assets.builders.avatars.piece import Piece
from assets.builders.avatars.sheet import I8, corner_normals

__all__ = ["Draft", "openness"]

Uv = tuple[float, float]

_REACHES = (0.012, 0.035, 0.09)
"""Distances from the surface at which openness is sampled [m]."""


def openness(field: Field, places: F8, normals: F8, lift: float = 0.0) -> F8:
    """Return the share of the sky that each point sees, 0 to 1, [n]: distances along the normal (Evans 2006)."""
    hidden = np.zeros(len(places))
    for share, far in zip((0.34, 0.33, 0.33), _REACHES, strict=True):
        free = field.at(places + (far - lift) * normals) + lift
        hidden += share * np.clip(1.0 - free / far, 0.0, 1.0)
    return 1.0 - hidden


class Draft:
    """Vertices with weights, and faces with texture coordinates.

    Args:
        joints: Number of joints.
    """

    def __init__(self, joints: int) -> None:
        self._joints = joints
        self.corners: list[F8] = []
        self.weights: list[F8] = []
        self._faces: list[tuple[tuple[int, ...], tuple[Uv, ...]]] = []

    def add(self, places: F8, weights: F8) -> I8:
        """Add vertices [n, 3] with weights [n, joints]; return their indices."""
        first = len(self.corners)
        self.corners.extend(places)
        self.weights.extend(weights)
        return np.arange(first, first + len(places))

    def face(self, corners: Sequence[int], uvs: Sequence[Uv], *, flip: bool = False) -> None:
        """Add a triangle or quadrilateral, counter-clockwise seen from outside; flipped: clockwise."""
        own = tuple(int(corner) for corner in corners)
        self._faces.append((own[::-1], tuple(uvs)[::-1]) if flip else (own, tuple(uvs)))

    def band(self, one: I8, two: I8, u: Sequence[float], v: tuple[float, float], *, flip: bool = False) -> None:
        """Add faces between two closed rings; u has one value more than the rings have vertices."""
        count = len(one)
        for i in range(count):
            j = (i + 1) % count
            uvs = ((u[i], v[0]), (u[i + 1], v[0]), (u[i + 1], v[1]), (u[i], v[1]))
            self.face((one[i], one[j], two[j], two[i]), uvs, flip=flip)

    def lid(self, ring: I8, place: F8, uv: Uv, *, flip: bool = False) -> None:
        """Close a ring by a fan to a new vertex, which has the mean weights of the ring."""
        weights = np.mean([self.weights[i] for i in ring], axis=0)
        middle = int(self.add(place[None], weights[None])[0])
        count = len(ring)
        for i in range(count):
            self.face((ring[i], ring[(i + 1) % count], middle), (uv, uv, uv), flip=flip)

    def hem(self, ring: I8, inner: F8, middle: F8, *, flip: bool = False) -> None:
        """Turn a rim inwards to another ring and close that, where it is hidden.

        Args:
            ring: The rim; its faces lie on its left hand seen from outside (flipped: right).
            inner: Ends of the turned edge, one per vertex [m].
            middle: Vertex that closes it [m].
            flip: Whether the faces are reversed.
        """
        edge = self.add(inner, np.array([self.weights[i] for i in ring]))
        flat = [0.02] * (len(ring) + 1)
        self.band(edge, ring, flat, (0.02, 0.02), flip=flip)
        self.lid(edge, middle, (0.02, 0.02), flip=not flip)

    def finish(
        self,
        material: str,
        shade: F8 | None = None,
        dim: Field | None = None,
        lift: float = 0.0,
        normals: Mapping[int, F8] | None = None,
    ) -> Piece:
        """Return the surface as a piece.

        Args:
            material: Its name.
            shade: Factor on the colour of each vertex, [n, 3]; none: 1.
            dim: Distance field of the body that shades the surface; none: no shade.
            lift: Distance of the surface from that body [m].
            normals: Of vertices whose normal is given, [3] each, in place of the mean of their faces.
        """
        places, weights = np.array(self.corners), np.array(self.weights)
        known: dict[tuple[int, int, int], int] = {}
        rows: list[tuple[int, int, int]] = []
        for corners, uvs in self._faces:
            points = [
                known.setdefault((corner, round(uv[0] * 8192), round(uv[1] * 8192)), len(known))
                for corner, uv in zip(corners, uvs, strict=True)
            ]
            rows.append((points[0], points[1], points[2]))
            if len(points) == 4:
                rows.append((points[0], points[2], points[3]))
        keys = np.array(list(known), np.int64)
        own, triangles = keys[:, 0], np.array(rows, np.int64)
        found = corner_normals(places, own[triangles])
        for corner, normal in (normals or {}).items():
            found[corner] = normal
        shades = np.ones((len(places), 3)) if shade is None else shade
        if dim is not None:
            shades = shades * (0.30 + 0.70 * openness(dim, places, found, lift))[:, None]
        return Piece(material, places[own], found[own], keys[:, 1:] / 8192.0, triangles, weights[own], shades[own])
