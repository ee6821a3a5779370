"""Skin of head and neck as triangles: lids that can close, lips that can open, and the morphs of the face."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assets.builders.avatars.cage import reach
from assets.builders.avatars.face_map import LID_LIFT, LID_POINTS, FaceMap, directions, lay_map
from assets.builders.avatars.face_shape import EYE_RADIUS, Head, lid_lines, over_eye
from assets.builders.avatars.fields import F8, step
from assets.builders.avatars.person import Person
from assets.builders.avatars.sheet import I8, Sheet, corner_normals

__all__ = ["FaceMesh", "face_uvs", "make_face", "welded_normals"]

_MM = 1e-3
_LAP = 5e-5
"""Overlap of closed lips [m]: through a slit between them teeth would be seen."""
_LOWEST, _HIGHEST = -1.36, 1.5708
"""Elevations at the lower and the upper edge of the texture of the head [rad]."""


@dataclass(frozen=True)
class FaceMesh:
    """The skin of a head.

    Attributes:
        places, normals: Of the vertices [m], [n, 3].
        turns: Azimuth and elevation of each about the centre of the head [rad], [n, 2].
        triangles: [m, 3].
        inside: Indices of the vertices inside the mouth.
        border: Vertices on the neck's ring, in its order about the neck.
        moves: Displacements of the face's morphs [m], [n, 3] each.
        outside: Number of the first vertices that lie outside of lids and lips.
    """

    places: F8
    normals: F8
    turns: F8
    triangles: I8
    inside: I8
    border: I8
    moves: dict[str, F8]
    outside: int


def face_uvs(turns: F8) -> F8:
    """Return texture coordinates of azimuths and elevations, [n, 2]; the front is half as large again as the mean."""
    share = turns[:, 0] / math.pi
    u = 0.5 + 0.5 * np.sign(share) * np.abs(share) * (1.5 - 0.5 * np.abs(share))
    return np.stack([u, (_HIGHEST - turns[:, 1]) / (_HIGHEST - _LOWEST)], axis=1)


def welded_normals(places: F8, triangles: I8) -> F8:
    """Return normals that are equal where vertices are doubled at seams of the texture, [n, 3]."""
    _, first, same = np.unique(np.round(places, 6), axis=0, return_index=True, return_inverse=True)
    one = same.reshape(-1)
    result: F8 = corner_normals(places[first], one[triangles])[one]
    return result


def make_face(person: Person, head: Head, neck_ring: F8) -> FaceMesh:
    """Return the skin of a person's head above the ring of the neck, [32, 3] from the front by the left."""
    half = neck_ring[: len(neck_ring) // 2 + 1]
    flat = lay_map(head, person.face, half)
    places = _half_places(flat, head, half)
    sheet = Sheet()
    left = sheet.add(places)
    doubled = np.abs(flat.turns[:, 0]) > 1e-6
    right = left.copy()
    right[doubled] = sheet.add(places[doubled] * [-1.0, 1.0, 1.0])
    for corner, place in zip(right[flat.border][1:-1], neck_ring[:16:-1], strict=True):
        sheet.corners[int(corner)] = place
    turns = [*flat.turns, *(flat.turns[doubled] * [-1.0, 1.0])]
    sheet.faces += [(int(a), int(b), int(c)) for a, b, c in left[flat.triangles]]
    sheet.faces += [(int(a), int(c), int(b)) for a, b, c in right[flat.triangles]]
    _crown(sheet, flat, left, right, head)
    lids = _line_lids(sheet, flat, left, right, head)
    first_inside = len(sheet.corners)
    lips = np.concatenate([left[flat.lips[0]], right[flat.lips[0]][-2:0:-1]])
    inside = _mouth_bag(sheet, lips, head)
    places = sheet.places()
    triangles = np.array(sheet.faces)[:, :3] if all(len(f) == 3 for f in sheet.faces) else _cut(sheet)
    more = places[len(turns) :] - head.middle
    extra = np.stack([np.arctan2(more[:, 0], more[:, 2]), np.arcsin(more[:, 1] / np.linalg.norm(more, axis=1))], axis=1)
    all_turns = np.vstack([np.array(turns), extra])
    ring = np.concatenate([left[flat.border], right[flat.border][-2:0:-1]])
    moves = {
        "blink": _blink(places, flat, head, person, left, right, lids),
        "smile": _smile(places, head, first_inside),
        "jaw": _jaw(places, head, lips, flat, left, right, first_inside),
        "brows": _brows(places, head),
    }
    return FaceMesh(places, welded_normals(places, triangles), all_turns, triangles, inside, ring, moves, len(turns))


def _cut(sheet: Sheet) -> I8:
    rows: list[tuple[int, ...]] = []
    for face in sheet.faces:
        rows += [face] if len(face) == 3 else [face[:3], (face[0], face[2], face[3])]
    return np.array(rows, np.int64)


def _half_places(flat: FaceMap, head: Head, half: F8) -> F8:
    places = reach(head.field, head.middle, directions(flat.turns), 0.2)
    places[flat.border] = half
    for point, place in flat.eyes.items():
        places[point] = place
    for ring in flat.lips:
        places[ring[[0, -1]], 0] = 0.0
    count = len(flat.lips[0])
    places[flat.lips[0], 2] -= 0.0008
    line = places[flat.lips[0], 1]
    middle = 0.5 * (line + line[::-1])
    places[flat.lips[0], 1] = middle + np.where(np.arange(count) < count // 2, -_LAP, _LAP)
    seam = np.abs(flat.turns[:, 0]) < 1e-6
    places[seam, 0] = 0.0
    return places


def _crown(sheet: Sheet, flat: FaceMap, left: I8, right: I8, head: Head) -> None:
    ring = np.concatenate([left[flat.top], right[flat.top][-2:0:-1]])
    top = reach(head.field, head.middle, np.array([[0.0, 1.0, 0.0]]), 0.2)[0]
    sheet.close(ring, top)


def _line_lids(sheet: Sheet, flat: FaceMap, left: I8, right: I8, head: Head) -> dict[int, I8]:
    """The edges of the lids have a thickness, and what lies in the corners of the eye is closed behind."""
    inner = {}
    for side, half, eye in ((1, left, head.eyes[0]), (-1, right, head.eyes[1])):
        rim = half[flat.lids[0]]
        edge = np.array([sheet.corners[i] for i in rim])
        towards = eye - edge
        far = np.linalg.norm(towards, axis=1)
        wet = edge + towards * (np.minimum(0.0016, np.maximum(far - EYE_RADIUS + 0.0004, 0.0008)) / far)[:, None]
        inner[side] = sheet.grow(rim, wet)
        sheet.close(inner[side], eye)
    return inner


def _mouth_bag(sheet: Sheet, lips: I8, head: Head) -> I8:
    rim = np.array([sheet.corners[i] for i in lips])
    above = np.sign(rim[:, 1] - head.stomion[1] + 0.0)
    above = np.where(
        np.arange(len(lips)) % len(lips) < 6, 1.0, np.where(np.arange(len(lips)) >= len(lips) - 5, 1.0, -1.0)
    )
    first = len(sheet.corners)
    for back, open_, wide in ((0.0050, 0.0020, 0.97), (0.0140, 0.0120, 0.98), (0.0360, 0.0130, 0.80)):
        arch = 1.0 - (rim[:, 0] / (1.02 * np.abs(rim[:, 0]).max())) ** 2
        ring = rim * [wide, 1.0, 1.0] + np.stack([0 * arch, above * open_ * arch, np.full(len(rim), -back)], axis=1)
        lips = sheet.grow(lips, ring)
    sheet.close(lips, head.stomion - [0.0, 0.0, 0.050])
    return np.arange(first, len(sheet.corners))


def _blink(places: F8, flat: FaceMap, head: Head, person: Person, left: I8, right: I8, inner: dict[int, I8]) -> F8:
    """The upper lid slides over the eyeball down to the lower one."""
    moves = np.zeros_like(places)
    _, lower = lid_lines(head, person.face, LID_POINTS)
    upper = slice(0, LID_POINTS)
    for side, half, eye in ((1, left, head.eyes[0]), (-1, right, head.eyes[1])):
        rim = half[flat.lids[0][upper]]
        shut = over_eye(eye, lower + [0.0, 0.0002], side, LID_LIFT + 0.0003)
        drop = shut[:, 1] - places[rim, 1]
        moves[rim] = shut - places[rim]
        moves[inner[side][upper]] = moves[rim]
        for ring, share in ((1, 0.84), (2, 0.34)):
            corners = half[flat.lids[ring][upper]]
            flat_now = (places[corners] - eye)[:, :2] * [side, 1.0]
            there = over_eye(eye, flat_now + np.stack([0 * drop, share * drop], axis=1), side, LID_LIFT + 0.0005)
            here = over_eye(eye, flat_now, side, LID_LIFT + 0.0005)
            moves[corners] = (there - here) * np.sin(math.pi * np.linspace(0.03, 0.97, LID_POINTS))[:, None] ** 0.3
    return moves


def _near(places: F8, place: F8, spread: float) -> F8:
    result: F8 = np.exp(-(((places - place) / spread) ** 2).sum(axis=1))[:, None]
    return result


def _smile(places: F8, head: Head, inside: int) -> F8:
    """Corners of the mouth out, up and back; cheeks rise; the lower lids a little."""
    total = np.zeros_like(places)
    half = head.mouth / (head.size[0] * _MM)
    for side in (1, -1):
        total += _near(places, head.mark(side * half, -65.0, 92.0), 0.013) * np.array([side * 5.0, 4.6, -3.0]) * _MM
        total += _near(places, head.mark(side * 12.0, -62.0, 98.0), 0.009) * np.array([side * 1.2, 1.0, -1.0]) * _MM
        total += _near(places, head.mark(side * 40.0, -34.0, 82.0), 0.015) * np.array([side * 1.6, 2.4, 1.8]) * _MM
        total += _near(places, head.mark(side * 31.0, -10.0, 87.0), 0.007) * np.array([0.0, 1.1, 0.3]) * _MM
    total[inside:] *= 0.9
    return total


def _jaw(places: F8, head: Head, lips: I8, flat: FaceMap, left: I8, right: I8, inside: int) -> F8:
    """The lower jaw turns 14 degrees about its hinge before the ears."""
    hinge = head.mark(0.0, -18.0, 10.0)
    offset = places - hinge
    angle = math.radians(14.0)
    turned = offset.copy()
    turned[:, 1] = math.cos(angle) * offset[:, 1] - math.sin(angle) * offset[:, 2]
    turned[:, 2] = math.sin(angle) * offset[:, 1] + math.cos(angle) * offset[:, 2]
    turned -= offset
    mm = (places - head.middle) / head.size / _MM
    line = -65.0 + 16.0 * step(26.0, 60.0, np.abs(mm[:, 0])) + 20.0 * step(80.0, 20.0, mm[:, 2])
    share = step(
        line + 2.0 + 20.0 * step(18.0, 36.0, np.abs(mm[:, 0])),
        line - 2.0 - 14.0 * step(18.0, 36.0, np.abs(mm[:, 0])),
        mm[:, 1],
    )
    share *= step(5.0, 45.0, mm[:, 2]) * step(-140.0, -108.0, mm[:, 1])
    lower, upper = [], []
    for half in (left, right):
        for ring in flat.lips[:3]:
            middle = len(ring) // 2
            upper.append(half[ring[:middle]])
            lower.append(half[ring[middle + 1 :]])
            share[half[ring[middle]]] = 0.30
    share[np.concatenate(upper)] = 0.0
    # the mouth opens as an oval: less towards its corners
    across = np.abs(places[:, 0]) / head.mouth
    oval = 0.30 + 0.70 * np.sqrt(np.clip(1.0 - across**2, 0.0, 1.0))
    low = np.concatenate(lower)
    share[low] = oval[low]
    share[inside:] = np.where(mm[inside:, 1] < -65.0, oval[inside:], 0.0) * step(30.0, 80.0, mm[inside:, 2])
    return share[:, None] * turned


def _brows(places: F8, head: Head) -> F8:
    total = np.zeros_like(places)
    for side in (1, -1):
        total += _near(places, head.mark(side * 20.0, 19.0, 97.0), 0.013) * np.array([0.0, 4.4, 0.3]) * _MM
        total += _near(places, head.mark(side * 42.0, 20.0, 88.0), 0.014) * np.array([0.0, 4.0, 0.4]) * _MM
    return total
