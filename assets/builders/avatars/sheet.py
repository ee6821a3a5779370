"""A mesh under construction: vertices, triangles and quadrilaterals, normals and means over neighbours."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from assets.builders.avatars.fields import F8, Field, gradient
from mimics_app.contracts.arrays import I8

if TYPE_CHECKING:
    from scipy import sparse

__all__ = ["I8", "Sheet", "corner_normals", "near_means", "neighbour_means", "settle", "triangles_of"]


_SHORTEST = 1e-3
"""Shortest length that an edge counts for [m]."""


class Sheet:
    """Vertices that are added in rows, and faces between them, counter-clockwise seen from outside.

    Attributes:
        corners: Positions of the vertices [m].
        faces: Indices of three or four vertices.
    """

    def __init__(self) -> None:
        self.corners: list[F8] = []
        self.faces: list[tuple[int, ...]] = []

    def add(self, places: F8) -> I8:
        """Add vertices [n, 3]; return their indices [n]."""
        first = len(self.corners)
        self.corners.extend(places)
        return np.arange(first, first + len(places))

    def join(
        self, lower: Sequence[int] | I8, upper: Sequence[int] | I8, *, ring: bool = True, flip: bool = False
    ) -> None:
        """Add faces between two rows of equally many vertices; outwards is the direction of `lower` x upwards."""
        count = len(lower)
        for i in range(count if ring else count - 1):
            j = (i + 1) % count
            face = (int(lower[i]), int(lower[j]), int(upper[j]), int(upper[i]))
            self.faces.append(face[::-1] if flip else face)

    def grow(self, rim: Sequence[int] | I8, places: F8) -> I8:
        """Continue the surface over a closed rim by another ring of vertices [n, 3]; return their indices."""
        ring = self.add(places)
        first, second = int(rim[0]), int(rim[1])
        known = any((first, second) in zip(face, (*face[1:], face[0]), strict=True) for face in self.faces)
        self.join(rim, ring, flip=known)
        return ring

    def close(self, rim: Sequence[int] | I8, place: F8) -> int:
        """Continue the surface over a closed rim by a fan to one vertex; return its index."""
        first, second = int(rim[0]), int(rim[1])
        known = any((first, second) in zip(face, (*face[1:], face[0]), strict=True) for face in self.faces)
        return self.cap(rim, place, flip=known)

    def cap(self, ring: Sequence[int] | I8, place: F8, *, flip: bool = False) -> int:
        """Close a ring by a fan about a new vertex; return its index."""
        middle = int(self.add(place[None])[0])
        count = len(ring)
        for i in range(count):
            face = (int(ring[i]), int(ring[(i + 1) % count]), middle)
            self.faces.append(face[::-1] if flip else face)
        return middle

    def places(self) -> F8:
        """Return the positions of all vertices [n, 3]."""
        return np.array(self.corners)


def triangles_of(faces: Sequence[tuple[int, ...]], places: F8) -> I8:
    """Return faces as triangles [m, 3]; a quadrilateral is cut along its shorter diagonal."""
    rows: list[tuple[int, int, int]] = []
    for face in faces:
        if len(face) == 3:
            rows.append((face[0], face[1], face[2]))
            continue
        a, b, c, d = face
        if ((places[a] - places[c]) ** 2).sum() <= 1.0001 * ((places[b] - places[d]) ** 2).sum():
            rows += [(a, b, c), (a, c, d)]
        else:
            rows += [(a, b, d), (b, c, d)]
    return np.array(rows, np.int64).reshape(-1, 3)


def corner_normals(places: F8, triangles: I8) -> F8:
    """Return unit vertex normals, weighted by the angles of the triangles, [n, 3]."""
    total = np.zeros_like(places)
    for i in range(3):
        at, to, also = places[triangles[:, i]], places[triangles[:, (i + 1) % 3]], places[triangles[:, (i + 2) % 3]]
        one, two = to - at, also - at
        face = np.cross(one, two)
        size = np.linalg.norm(face, axis=1)
        angle = np.arctan2(size, (one * two).sum(axis=1))
        np.add.at(total, triangles[:, i], face * (angle / np.maximum(size, 1e-15))[:, None])
    unit: F8 = total / np.maximum(np.linalg.norm(total, axis=1), 1e-15)[:, None]
    return unit


def neighbour_means(count: int, faces: Sequence[tuple[int, ...]], values: F8) -> F8:
    """Return the mean over the neighbours of each vertex, [n, k]."""
    pairs = np.array([(f[i], f[(i + 1) % len(f)]) for f in faces for i in range(len(f))], np.int64)
    ends = np.unique(np.vstack([pairs, pairs[:, ::-1]]), axis=0)
    total, number = np.zeros((count, values.shape[1])), np.zeros(count)
    np.add.at(total, ends[:, 0], values[ends[:, 1]])
    np.add.at(number, ends[:, 0], 1.0)
    means: F8 = np.where(number[:, None] > 0.0, total / np.maximum(number, 1.0)[:, None], values)
    return means


def near_means(places: F8, faces: Sequence[Sequence[int]] | I8) -> sparse.csr_array:
    """Return the matrix of means over the neighbours of each vertex, weighted by the inverse length of the edge."""
    from scipy import sparse

    pairs = np.array([(f[i - 1], f[i]) for f in faces for i in range(len(f)) if f[i - 1] != f[i]], np.int64)
    one, two = np.unique(np.vstack([pairs, pairs[:, ::-1]]), axis=0).T
    near = 1.0 / np.maximum(np.linalg.norm(places[one] - places[two], axis=1), _SHORTEST)
    shares = near / np.bincount(one, near, minlength=len(places))[one]
    return sparse.csr_array((shares, (one, two)), shape=(len(places), len(places)))


def settle(places: F8, faces: Sequence[tuple[int, ...]], free: F8, field: Field, rounds: int) -> F8:
    """Smooth vertices and project them onto the surface of a field, several times.

    Args:
        places: Positions of the vertices [m], [n, 3].
        faces: Between them.
        free: Share of the mean of its neighbours that each takes over, 0 to 1, [n]; at 0 it does not move.
        field: Distance field of the surface.
        rounds: Number of repetitions.
    """
    places = places.copy()
    moving = free > 0.0
    for _ in range(rounds):
        means = neighbour_means(len(places), faces, places)
        places += 0.6 * free[:, None] * (means - places)
        at = places[moving]
        slope = gradient(field, at)
        steep = np.maximum((slope * slope).sum(axis=1), 0.15)
        away = np.clip(field.at(at) / steep, -0.03, 0.03)
        places[moving] = at - away[:, None] * slope
    return places
