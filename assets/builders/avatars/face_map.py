"""The face as a flat map: directions from the centre of the head, and the points that become vertices."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assets.builders.avatars.face_shape import Head, lid_lines, over_eye
from assets.builders.avatars.fields import F8
from assets.builders.avatars.person import Face
from assets.builders.avatars.sheet import I8

__all__ = ["LID_LIFT", "LID_POINTS", "MOUTH_RISE", "FaceMap", "directions", "lay_map", "turns_of"]

LID_POINTS = 9
"""Vertices of a lid from one end to the other."""
MOUTH_RISE = 2.6
"""Height of the ends of the line of the lips over its middle [mm]: a mouth at ease."""
_LIP_POINTS = 6
"""Vertices of half a lip from the middle to the end."""

_LID_RINGS = ((0.0020, 0.0024, 0.0020), (0.0045, 0.0062, 0.0048), (0.0080, 0.0105, 0.0085))
"""Distance of the rings about the opening from it: beside, above, below [m]."""
LID_LIFT = 0.0013
"""Distance of the edges of the lids from the eyeball [m]."""
_LIP_RINGS = (0.40, 1.0, 1.75)
"""Rings about the mouth: shares of the distance from the line of the lips to the edge of the red."""
_TOP = 1.40
"""Largest elevation of the map; above it is the crown [rad]."""
_RADIUS = 0.095
"""Typical of the head, for distances on the map [m]."""
_TIE = 1e-10
"""Height [rad^2] by which points that lie on one circle are distinguished: far above rounding, far below any bend."""


@dataclass(frozen=True)
class FaceMap:
    """The left half of the head's map.

    Attributes:
        turns: Azimuth (0 ahead, positive left) and elevation of each point [rad], [n, 2].
        triangles: Counter-clockwise seen from outside, [m, 3].
        border: Points where the neck begins, from ahead to behind.
        top: Points about the crown, from ahead to behind.
        lids: Rings of points about the opening of the eye, the innermost first; each from the inner corner over the
            upper lid to the outer one and back along the lower.
        lips: Rings of points about the mouth, the innermost first; each from the middle of the upper lip by the end
            to the middle of the lower.
        eyes: Places of the innermost two rings of the lids [m], by point.
    """

    turns: F8
    triangles: I8
    border: I8
    top: I8
    lids: list[I8]
    lips: list[I8]
    eyes: dict[int, F8]


def directions(turns: F8) -> F8:
    """Return unit vectors [n, 3] of azimuths and elevations [n, 2]."""
    a, e = turns[:, 0], turns[:, 1]
    return np.stack([np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e)], axis=1)


def turns_of(offsets: F8) -> F8:
    """Return azimuths and elevations [n, 2] of vectors [n, 3]."""
    away = np.linalg.norm(offsets, axis=1)
    return np.stack([np.arctan2(offsets[:, 0], offsets[:, 2]), np.arcsin(offsets[:, 1] / away)], axis=1)


class _Points:
    """Points that are collected for the map."""

    def __init__(self) -> None:
        self.turns: list[F8] = []
        self.laid: list[F8] = []

    def add(self, turns: F8, laid: F8 | None = None) -> I8:
        """Points, and where they are laid for the triangles: lips touch, but their rings must not."""
        first = len(self.turns)
        self.turns.extend(turns)
        self.laid.extend(turns if laid is None else laid)
        return np.arange(first, first + len(turns))


def lay_map(head: Head, face: Face, neck_ring: F8) -> FaceMap:
    """Choose the points of the left half.

    Args:
        head: Its shape.
        face: Features.
        neck_ring: Places of the ring where the neck begins, from ahead over the left to behind [m], [k, 3].
    """
    points = _Points()
    rim = turns_of(neck_ring - head.middle)
    rim[0, 0], rim[-1, 0] = 0.0, math.pi
    border = points.add(rim)
    lids, eyes = _lid_points(points, head, face)
    lips = _lip_points(points, head, face)
    features = np.array(points.laid)
    _fill(points, head, features, rim, lids, lips)
    top = points.add(np.stack([np.linspace(0.0, math.pi, 8), np.full(8, _TOP)], axis=1))
    turns = np.array(points.turns)
    triangles = _triangulate(np.array(points.laid) * [0.85, 1.0])
    for ring in (border, lids[0], lips[0]):
        triangles = triangles[~np.isin(triangles, ring).all(axis=1)]
    return FaceMap(turns, triangles, border, top, lids, lips, eyes)


def _lid_points(points: _Points, head: Head, face: Face) -> tuple[list[I8], dict[int, F8]]:
    upper, lower = lid_lines(head, face, LID_POINTS)
    loop = np.vstack([upper, lower[-2:0:-1]])
    middle = np.array([0.0, 0.5 * (upper[LID_POINTS // 2, 1] + lower[LID_POINTS // 2, 1])])
    turn = np.arctan2((loop[:, 1] - middle[1]) / 0.005, (loop[:, 0] - middle[0]) / head.gape)
    rings: list[I8] = []
    eyes: dict[int, F8] = {}
    for number, (wide, high, low) in enumerate(((0.0, 0.0, 0.0), *_LID_RINGS)):
        rise = np.sin(turn)
        flat = loop + np.stack([wide * np.cos(turn), np.where(rise > 0.0, high, low) * rise], axis=1)
        places = over_eye(head.eyes[0], flat, 1, LID_LIFT)
        ring = points.add(turns_of(places - head.middle))
        rings.append(ring)
        if number == 0:
            eyes.update(zip(ring.tolist(), places, strict=True))
    return rings, eyes


def _lip_points(points: _Points, head: Head, face: Face) -> list[I8]:
    half = head.mouth / (head.size[0] * 1e-3)
    share = np.sin(0.5 * math.pi * np.linspace(0.0, 1.0, _LIP_POINTS))
    x = half * share
    line = -65.0 + MOUTH_RISE * share**2
    upper = 7.6 * face.lips * (1.0 - share**2.2) * (1.0 - 0.12 * np.exp(-((share / 0.16) ** 2)))
    lower = 9.2 * face.lips * (1.0 - share**2.4)
    rings = []
    for grow in (0.0, *_LIP_RINGS):
        gap, wide = 1.2, 1.0 + (0.06 * grow if grow <= 1.0 else 0.06 + 0.18 * (grow - 1.0))
        more = max(grow - 1.0, 0.0) * 6.0
        above = np.stack(
            [x * wide, line + gap * (1.0 - share**2) + upper * min(grow, 1.0) + more * (1.0 - share**3)], axis=1
        )
        below = np.stack(
            [x * wide, line - gap * (1.0 - share**2) - lower * min(grow, 1.0) - more * (1.0 - share**3)], axis=1
        )
        flat = np.vstack([above, below[-2::-1]])
        depth = 102.0 - 9.5 * (flat[:, 0] / half) ** 2
        places = np.stack([flat[:, 0], flat[:, 1], depth], axis=1) * head.size * 1e-3
        turns = turns_of(places)
        turns[[0, -1], 0] = 0.0
        rings.append(points.add(turns, _spread_lips(turns, grow, half)))
    return rings


def _spread_lips(turns: F8, grow: float, half: float) -> F8:
    """A ring of the lips drawn apart to half an ellipse about the mouth, azimuths and elevations."""
    t = np.linspace(0.0, math.pi, len(turns))
    wide = half + 2.0 * grow + 5.0 * max(grow - 1.0, 0.0)
    middle = np.array([0.0, turns[len(turns) // 2, 1]])
    return middle + np.stack([wide * np.sin(t), (1.6 + 6.5 * grow) * np.cos(t)], axis=1) * 1e-3 / 0.115


def _fill(points: _Points, head: Head, features: F8, rim: F8, lids: list[I8], lips: list[I8]) -> None:
    """Rows of points everywhere else: close together on the face, far apart under the hair."""
    kept = list(features)
    eye, mouth = features[lids[-1]], features[lips[-1]]
    eye_middle = eye.mean(axis=0)
    mouth_middle = np.array([0.0, 0.5 * (mouth[0, 1] + mouth[-1, 1])])
    elevation = -1.22
    while elevation < _TOP - 0.06:
        azimuth, row = 0.0, []
        while azimuth < math.pi:
            row.append(azimuth)
            azimuth += _spacing(azimuth, elevation) / max(_RADIUS * math.cos(elevation), 0.02)
        turns = np.array([*row, math.pi]) if math.pi - row[-1] > 0.08 else np.array([*row[:-1], math.pi])
        for turn in turns:
            point = np.array([turn, elevation])
            low = float(np.interp(turn, rim[:, 0], rim[:, 1])) + 0.085
            inside = _within(point, eye, eye_middle) or _within(point, mouth, mouth_middle)
            near = min(_apart(point, other) for other in kept)
            if elevation > low and not inside and near > 0.62 * _spacing(turn, elevation):
                points.add(point[None])
                kept.append(point)
        elevation += 0.92 * _spacing(0.35, elevation) / _RADIUS


def _spacing(azimuth: float, elevation: float) -> float:
    """Return the distance between points [m]."""
    nose = azimuth < 0.24 and -0.50 < elevation < 0.04
    face = azimuth < 0.85 and -1.05 < elevation < 0.30
    side = azimuth < 1.45 and elevation < 0.5
    return 0.0048 if nose else 0.0098 if face else 0.0160 if side else 0.0320


def _apart(one: F8, other: F8) -> float:
    level = math.cos(0.5 * (one[1] + other[1]))
    return _RADIUS * math.hypot((one[0] - other[0]) * level, one[1] - other[1])


def _within(point: F8, ring: F8, middle: F8) -> bool:
    """Return whether a point lies inside a ring, with a margin; half a ring counts as whole."""
    offset = (point - middle) / 1.10
    around = ring - middle
    if abs(middle[0]) < 1e-9:
        around = np.vstack([around, around[::-1] * [-1.0, 1.0]])
    turn = np.arctan2(around[:, 1], around[:, 0])
    order = np.argsort(turn)
    own = math.atan2(offset[1], offset[0])
    size = np.interp(own, turn[order], np.hypot(*around[order].T), period=2.0 * math.pi)
    return float(np.hypot(*offset)) < float(size)


def _triangulate(points: F8) -> I8:
    """Return the Delaunay triangles [m, 3] of points [n, 2], counter-clockwise, in the order of their newest points.

    They are the lower side of the convex hull of the points lifted to a paraboloid. Of points on one circle, of which a
    face has some, a newer one lies a little higher: its diagonal is then the same on every machine.
    """
    from scipy.spatial import ConvexHull

    flat = points - points.mean(axis=0)
    lifted = (flat**2).sum(axis=1) + _TIE * np.linspace(0.0, 1.0, len(flat))
    hull = ConvexHull(np.column_stack([flat, lifted]))
    corners = hull.simplices[hull.equations[:, 2] < 0.0]
    a, b, c = (flat[corners[:, i]] for i in range(3))
    (x, y), (u, v) = (b - a).T, (c - a).T
    corners = np.where((x * v < y * u)[:, None], corners[:, ::-1], corners)
    corners = np.take_along_axis(corners, (corners.argmax(axis=1)[:, None] + [1, 2, 0]) % 3, axis=1)
    result: I8 = corners[np.lexsort(corners.T[[1, 0, 2]])].astype(np.int64)
    return result
