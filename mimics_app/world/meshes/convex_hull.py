"""Convex hull of points in space (quickhull)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8, I4

__all__ = ["convex_hull"]


_FLAT = 1e-7
"""Tolerance of coplanarity, as a share of the extent of all points."""


def convex_hull(points: F8) -> tuple[F8, I4]:
    """Return vertices and triangles of the convex hull (Barber, Dobkin & Huhdanpaa 1996, without merging faces).

    Args:
        points: [m], shape [n, 3], finite.

    Returns:
        (vertices [m], shape [k, 3]; indices, counter-clockwise from outside, shape [m, 3]).

    Raises:
        ValueError: all points lie in one plane.
    """
    points = np.unique(np.asarray(points, np.float64), axis=0)
    extent = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    hull = _Hull(points, _FLAT * extent)
    hull.grow()
    faces = np.array(hull.faces, np.int32)
    used, indices = np.unique(faces, return_inverse=True)
    return points[used], indices.reshape(-1, 3).astype(np.int32)


class _Hull:
    """Faces of the present hull, each with its plane and its set of outside points."""

    def __init__(self, points: F8, flat: float) -> None:
        self.points = points
        self.faces: list[tuple[int, int, int]] = []
        self._flat = flat
        self._normals: list[F8] = []
        self._offsets: list[float] = []
        self._outside: list[NDArray[np.int64]] = []
        self._start()

    def grow(self) -> None:
        """Add points until none is outside."""
        while True:
            waiting = next((i for i, outside in enumerate(self._outside) if len(outside)), None)
            if waiting is None:
                return
            outside = self._outside[waiting]
            heights = self.points[outside] @ self._normals[waiting] - self._offsets[waiting]
            self._add(int(outside[int(np.argmax(heights))]))

    def _start(self) -> None:
        """Create the initial tetrahedron of points far from each other."""
        points = self.points
        if len(points) < 4:
            raise ValueError(f"{len(points)} different points do not span a solid")
        a = int(np.argmin(points[:, 0]))
        b = int(np.argmax(np.linalg.norm(points - points[a], axis=1)))
        across = np.linalg.norm(np.cross(points - points[a], points[b] - points[a]), axis=1)
        c = int(np.argmax(across))
        normal = np.cross(points[b] - points[a], points[c] - points[a])
        heights = (points - points[a]) @ normal
        d = int(np.argmax(np.abs(heights)))
        if abs(heights[d]) <= self._flat * np.linalg.norm(normal):
            raise ValueError("all points lie in one plane")
        if heights[d] > 0.0:
            b, c = c, b
        rest = np.setdiff1d(np.arange(len(points)), [a, b, c, d])
        for face in ((a, b, c), (a, d, b), (b, d, c), (c, d, a)):
            self._append(face)
        self._assign(rest, range(4))

    def _append(self, face: tuple[int, int, int]) -> None:
        p, q, r = self.points[list(face)]
        normal = np.cross(q - p, r - p)
        normal /= np.linalg.norm(normal)
        self.faces.append(face)
        self._normals.append(normal)
        self._offsets.append(float(normal @ p))
        self._outside.append(np.zeros(0, np.int64))

    def _assign(self, indices: NDArray[np.int64], faces: range) -> None:
        """Assign each point to the first face that it is outside of."""
        for face in faces:
            heights = self.points[indices] @ self._normals[face] - self._offsets[face]
            self._outside[face] = indices[heights > self._flat]
            indices = indices[heights <= self._flat]

    def _add(self, apex: int) -> None:
        heights = np.stack(self._normals) @ self.points[apex] - np.array(self._offsets)
        visible = set(np.flatnonzero(heights > self._flat).tolist())
        edges = {(face[i], face[(i + 1) % 3]) for face in (self.faces[k] for k in visible) for i in range(3)}
        horizon = [edge for edge in edges if (edge[1], edge[0]) not in edges]
        orphans = np.setdiff1d(np.concatenate([self._outside[k] for k in sorted(visible)]), [apex])
        for name in ("faces", "_normals", "_offsets", "_outside"):
            setattr(self, name, [item for k, item in enumerate(getattr(self, name)) if k not in visible])
        first = len(self.faces)
        for start, end in horizon:
            self._append((start, end, apex))
        self._assign(orphans, range(first, len(self.faces)))
