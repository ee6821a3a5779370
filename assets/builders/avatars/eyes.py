"""Eyeballs, teeth and tongue."""

from __future__ import annotations

import math

import numpy as np

from assets.builders.avatars.face_mesh import welded_normals
from assets.builders.avatars.face_shape import EYE_RADIUS, Head
from assets.builders.avatars.fields import F8, step
from assets.builders.avatars.piece import Piece, joined
from assets.builders.avatars.sheet import I8, Sheet, triangles_of
from assets.builders.avatars.skeleton import Skeleton
from assets.builders.avatars.weights import rigid

__all__ = ["IRIS", "make_eyes", "make_mouth"]

IRIS = 0.0059
"""Radius of the coloured part of an eye [m]."""

_AROUND = 10
_RINGS = (0.0, 0.22, 0.50, 0.70, 1.05, 1.75)
"""Angles of an eyeball's rings from its front [rad]."""
_BULGE = 0.0009
"""Height of the cornea over the eyeball [m]."""


def make_eyes(head: Head, bones: Skeleton) -> Piece:
    """Return both eyeballs; the texture shows them from the front, 1.75 rad from its centre to its edge."""
    parts = []
    for eye, name in zip(head.eyes, ("leftEye", "rightEye"), strict=True):
        sheet, uvs = Sheet(), []
        turn = 2.0 * math.pi * np.arange(_AROUND) / _AROUND
        rim = None
        for angle in _RINGS[1:]:
            far = EYE_RADIUS + _BULGE * float(step(0.50, 0.0, np.array([angle]))[0])
            direction = np.stack(
                [np.sin(angle) * np.cos(turn), np.sin(angle) * np.sin(turn), np.full(_AROUND, np.cos(angle))], 1
            )
            ring = sheet.add(eye + far * direction)
            size = 0.5 * min(angle / 1.75, 1.0)
            uvs += [(0.5 + size * math.cos(t), 0.5 - size * math.sin(t)) for t in turn]
            if rim is None:
                sheet.cap(ring, eye + [0.0, 0.0, EYE_RADIUS + _BULGE])
                uvs.append((0.5, 0.5))
            else:
                sheet.join(ring, rim)
            rim = ring
        assert rim is not None
        sheet.close(rim, eye - [0.0, 0.0, EYE_RADIUS])
        uvs.append((0.5, 0.02))
        places = sheet.places()
        triangles = triangles_of(sheet.faces, places)
        hooded = step(0.55, 1.0, (places[:, 1] - eye[1]) / EYE_RADIUS * 1.6 + 0.25)
        shades = (1.0 - 0.55 * hooded)[:, None] * np.ones(3)
        parts.append(
            Piece(
                "eye",
                places,
                (places - eye) / np.linalg.norm(places - eye, axis=1)[:, None],
                np.array(uvs),
                triangles,
                rigid(bones, name, len(places)),
                shades,
            )
        )
    return joined(parts)


def make_mouth(head: Head, bones: Skeleton) -> Piece:
    """Two rows of teeth and a tongue; the lower ones go down with the jaw."""
    upper = _arch(head, -66.2, -57.0, 0.0, (0.86, 0.82, 0.72))
    lower = _arch(head, -76.5, -67.4, -2.2, (0.80, 0.76, 0.66))
    tongue = _tongue(head)
    angle = math.radians(14.0)
    hinge = head.mark(0.0, -18.0, 10.0)
    pieces = []
    for (places, triangles, colour), moves in ((upper, False), (lower, True), (tongue, True)):
        offset = places - hinge
        steps = np.zeros_like(places)
        if moves:
            steps[:, 1] = (math.cos(angle) - 1.0) * offset[:, 1] - math.sin(angle) * offset[:, 2]
            steps[:, 2] = math.sin(angle) * offset[:, 1] + (math.cos(angle) - 1.0) * offset[:, 2]
        shades = np.tile(colour, (len(places), 1)) * step(0.035, 0.002, head.stomion[2] - places[:, 2])[:, None]
        pieces.append(
            Piece("mouth", places, welded_normals(places, triangles), np.zeros((len(places), 2)), triangles,
                  rigid(bones, "head", len(places)), shades, {"jaw": steps})
        )  # fmt: skip
    return joined(pieces)


def _arch(head: Head, low: float, high: float, back: float, colour: tuple[float, float, float]) -> tuple[F8, I8, F8]:
    """A row of teeth: an arch with notches between the teeth on its biting edge."""
    sheet = Sheet()
    count = 11
    turn = np.linspace(-1.25, 1.25, count)
    middle = head.mark(0.0, 0.0, 66.0 + back)
    notch = 0.5 + 0.5 * np.cos(math.pi * np.arange(count))
    biting, root = (low, high) if back == 0.0 else (high, low)
    rows = []
    for radius, bite in ((1.0, False), (1.0, True), (0.80, True), (0.80, False)):
        x = 22.5 * radius * np.sin(turn) * head.size[0] * 1e-3
        z = 27.5 * radius * np.cos(turn) * 1e-3
        edge = biting + (0.7 * notch if back == 0.0 else -0.7 * notch)
        y = head.middle[1] + (edge if bite else np.full(count, root)) * head.size[1] * 1e-3
        rows.append(sheet.add(np.stack([x, y, middle[2] + z], axis=1)))
    outwards = back == 0.0
    for one, two in zip(rows, (*rows[1:], rows[0]), strict=True):
        sheet.join(one, two, ring=False, flip=outwards)
    for end in (0, -1):
        face = tuple(int(row[end]) for row in rows)
        sheet.faces.append(face if (end == 0) != outwards else face[::-1])
    places = sheet.places()
    return places, triangles_of(sheet.faces, places), np.array(colour)


def _tongue(head: Head) -> tuple[F8, I8, F8]:
    sheet = Sheet()
    turn = 2.0 * math.pi * np.arange(8) / 8
    rim = None
    for z, wide, thick in ((84.0, 9.0, 2.0), (76.0, 15.0, 4.0), (60.0, 17.0, 5.5), (50.0, 14.0, 5.0)):
        ring = sheet.add(np.array([head.mark(wide * math.cos(t), -73.0 + thick * math.sin(t), z) for t in turn]))
        if rim is None:
            sheet.cap(ring, head.mark(0.0, -73.0, 86.5))
        else:
            sheet.join(ring, rim)
        rim = ring
    assert rim is not None
    sheet.close(rim, head.mark(0.0, -73.0, 48.0))
    places = sheet.places()
    return places, triangles_of(sheet.faces, places), np.array([0.52, 0.20, 0.19])
